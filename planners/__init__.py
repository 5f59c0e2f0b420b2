"""Belief, motion and capture models, cost heuristics, path search, coordination."""

from maps import ConformanceError
from planners.baselines import Random, Stationary
from planners.beam import Beam
from planners.belief import advance, point_belief, uniform_belief
from planners.capture import CaptureError, CaptureModel, SameCell
from planners.conformance import check_cost, check_policy
from planners.costs import COSTS, Cost, CostError, Hops, find_cost, register_cost
from planners.coupled import Coupled
from planners.edgelist import read_edge_list, unit_problem
from planners.evaluation import Prediction, lower_bounds, predict
from planners.evidence import (
    EvidenceError,
    elsewhere,
    measured_range,
    merge_evaders,
    observe,
    region_belief,
    reported_sighting,
)
from planners.graph import GraphError, SearchGraph
from planners.horizon import BestResponse, BranchAndBound, Sequential
from planners.lookahead import Decoupled
from planners.motion import (
    AreaSpeedDegree,
    DwellTime,
    GivenMotion,
    MotionError,
    MotionModel,
    StationaryMotion,
    UniformMotion,
    check_transition,
    fit_motion,
)
from planners.parts import MotionInParts, cut_cells
from planners.policy import Decision, Planner, Policy, PursuerState, SearchProblem, SearchState
from planners.refining import Refined
from planners.registry import PLANNERS, PlannerEntry, make_planner, parse_method, register_planner
from planners.roads import CHECKPOINTS, Roads
from planners.rollout import Rollout
from planners.sight import LineOfSight, OwnCell, SightMap
from planners.space import StateSpace
from planners.team import PlannerError
from planners.walks import TooLargeError

__all__ = [
    "CHECKPOINTS",
    "COSTS",
    "PLANNERS",
    "AreaSpeedDegree",
    "Beam",
    "BestResponse",
    "BranchAndBound",
    "CaptureError",
    "CaptureModel",
    "ConformanceError",
    "Cost",
    "CostError",
    "Coupled",
    "Decision",
    "Decoupled",
    "DwellTime",
    "EvidenceError",
    "GivenMotion",
    "GraphError",
    "Hops",
    "LineOfSight",
    "MotionError",
    "MotionInParts",
    "MotionModel",
    "OwnCell",
    "Planner",
    "PlannerEntry",
    "PlannerError",
    "Policy",
    "Prediction",
    "PursuerState",
    "Random",
    "Refined",
    "Roads",
    "Rollout",
    "SameCell",
    "SearchGraph",
    "SearchProblem",
    "SearchState",
    "Sequential",
    "SightMap",
    "StateSpace",
    "Stationary",
    "StationaryMotion",
    "TooLargeError",
    "UniformMotion",
    "advance",
    "check_cost",
    "check_policy",
    "check_transition",
    "cut_cells",
    "elsewhere",
    "find_cost",
    "fit_motion",
    "lower_bounds",
    "make_planner",
    "measured_range",
    "merge_evaders",
    "observe",
    "parse_method",
    "point_belief",
    "predict",
    "read_edge_list",
    "region_belief",
    "register_cost",
    "register_planner",
    "reported_sighting",
    "uniform_belief",
    "unit_problem",
]

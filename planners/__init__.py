"""Belief, motion and capture models, cost heuristics, path search, coordination."""

from planners.baselines import Random, Stationary
from planners.belief import advance, point_belief, uniform_belief
from planners.capture import CaptureError, CaptureModel, SameCell
from planners.conformance import ConformanceError, check_policy
from planners.costs import COSTS, Cost, CostError, Hops, find_cost
from planners.graph import GraphError, SearchGraph
from planners.lookahead import Decoupled, PlannerError
from planners.motion import (
    AreaSpeedDegree,
    MotionError,
    MotionModel,
    StationaryMotion,
    UniformMotion,
    check_transition,
)
from planners.policy import Decision, Planner, Policy, PursuerState, SearchProblem, SearchState
from planners.registry import PLANNERS, PlannerEntry, make_planner

__all__ = [
    "COSTS",
    "PLANNERS",
    "AreaSpeedDegree",
    "CaptureError",
    "CaptureModel",
    "ConformanceError",
    "Cost",
    "CostError",
    "Decision",
    "Decoupled",
    "GraphError",
    "Hops",
    "MotionError",
    "MotionModel",
    "Planner",
    "PlannerEntry",
    "PlannerError",
    "Policy",
    "PursuerState",
    "Random",
    "SameCell",
    "SearchGraph",
    "SearchProblem",
    "SearchState",
    "Stationary",
    "StationaryMotion",
    "UniformMotion",
    "advance",
    "check_policy",
    "check_transition",
    "find_cost",
    "make_planner",
    "point_belief",
    "uniform_belief",
]

"""What several tests share."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

from discretize import CellMap, convex_cells
from geomsim import Episode, Team, run_episode
from maps import read_plan

# The same examples on every machine, so that a failure is a change's doing; HYPOTHESIS_PROFILE=explore tries new ones.
settings.register_profile("repeat", derandomize=True, deadline=None)
settings.register_profile("explore", print_blob=True, deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeat"))

SHARED = Path(__file__).resolve().parents[2] / "shared"


@pytest.fixture(scope="session", autouse=True)
def kept(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep what is kept on disk away from the user's own folder."""
    os.environ["GEOMSIM_CACHE"] = str(tmp_path_factory.mktemp("kept"))


@pytest.fixture(scope="session")
def floorplans() -> Path:
    """Floor plans that are not part of the project."""
    if not (SHARED / "floorplans").is_dir():
        pytest.skip("no shared floor plans beside the project")
    return SHARED / "floorplans"


@pytest.fixture(scope="session")
def house() -> CellMap:
    return convex_cells(read_plan("house"))


@pytest.fixture(scope="session")
def office() -> CellMap:
    return convex_cells(read_plan("office"))


@pytest.fixture(scope="session")
def pursuit(house: CellMap) -> Episode:
    """A captured evader in the house."""
    return run_episode(house.plan, house, Team(pursuers=2), seed=1, capture="cell")

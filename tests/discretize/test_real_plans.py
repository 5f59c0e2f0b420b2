"""Bundled plans and plans that nobody here drew."""

import pytest

from discretize import check_cells, convex_cells
from maps import bundled_names, read_plan

HOUSE = ((1, 4), (1, 8), (2, 8), (2, 9), (3, 4), (4, 5), (4, 6), (4, 9), (5, 7), (6, 7))
"""Which cells the dispersion matrix printed in the paper joins."""

FOREIGN = (
    "ros/aws_small_warehouse.yaml",
    "ros/giraff_EX4.yaml",
    "ros/nav2_depot.yaml",
    "ros/strands_g4s_y2.yaml",
)


def test_house_is_the_graph_of_the_paper(house):
    report = check_cells(house)
    assert report.edges == HOUSE
    assert report.problems == ()


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_plans_are_sound(name):
    plan = read_plan(name)
    report = check_cells(convex_cells(plan))
    assert report.problems == ()
    assert report.blocked_doors == ()
    assert report.free_components == report.graph_components == 1
    assert report.pockets == ()


@pytest.mark.parametrize("file", FOREIGN)
@pytest.mark.parametrize("radius", [0.2, 0.35])
@pytest.mark.parametrize("method", ["exact", "rooms"])
def test_robot_maps_are_sound(floorplans, file, radius, method):
    report = check_cells(convex_cells(read_plan(floorplans / file), method=method, radius=radius))
    assert report.problems == ()
    if method == "exact":
        assert report.convexity >= 1 - 1e-12


@pytest.mark.slow
@pytest.mark.parametrize(("method", "least", "most"), [("exact", 300, 5000), ("rooms", 50, 200)])
def test_the_largest_robot_map_is_sound(floorplans, method, least, most):
    report = check_cells(convex_cells(read_plan(floorplans / "ros/willow_full_0.05.yaml"), method=method))
    assert report.problems == ()
    assert least < report.cells < most

"""Where a team's robots stand at the start."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.placement import placed_robots
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Laser, Team

HALL = FloorPlan(name="hall", bounds=Bounds(max=(20.0, 10.0)))


def _positions(plan: FloorPlan, team: Team) -> np.ndarray:
    return np.array([robot.start_pose[:2] for robot in placed_robots(plan, team)])


def test_four_robots_stand_in_a_square_around_the_start_front_row_first() -> None:
    positions = _positions(HALL, Team(count=4, start=(5.0, 5.0, 0.0), spacing_m=1.0))
    np.testing.assert_allclose(positions, [[5.5, 5.5], [5.5, 4.5], [4.5, 5.5], [4.5, 4.5]])


def test_formation_turns_with_the_heading() -> None:
    robots = placed_robots(HALL, Team(count=4, start=(5.0, 5.0, math.pi / 2), spacing_m=1.0))
    expected = [[4.5, 5.5], [5.5, 5.5], [4.5, 4.5], [5.5, 4.5]]
    np.testing.assert_allclose([robot.start_pose[:2] for robot in robots], expected, atol=1e-12)
    assert {robot.start_pose[2] for robot in robots} == {math.pi / 2}


def test_one_robot_stands_at_the_start() -> None:
    assert placed_robots(HALL, Team(count=1, start=(5.0, 5.0, 0.3)))[0].start_pose == (5.0, 5.0, 0.3)


def test_robots_of_a_team_have_what_the_team_says() -> None:
    team = Team(count=2, start=(5.0, 5.0, 0.0), radius_m=0.3, laser=Laser(beams=9))
    assert [(robot.radius_m, robot.laser.beams) for robot in placed_robots(HALL, team)] == [(0.3, 9)] * 2


def test_formation_leaves_out_places_in_walls() -> None:
    plan = HALL.model_copy(update={"walls": (Wall(name="w", start=(5.5, 0.0), end=(5.5, 10.0)),)})
    team = Team(count=12, start=(4.5, 5.0, 0.0))
    positions = _positions(plan, team)
    assert np.all(positions[:, 0] < 5.4 - team.radius_m)
    assert len(np.unique(positions, axis=0)) == 12


def test_formation_does_not_reach_through_a_closed_door() -> None:
    walls = (
        Wall(name="lower", start=(5.5, 0.0), end=(5.5, 4.5)),
        Wall(name="upper", start=(5.5, 5.5), end=(5.5, 10.0)),
    )
    door = Door(name="gate", start=(5.5, 4.5), end=(5.5, 5.5), closed=True)
    team = Team(count=40, start=(4.5, 5.0, 0.0))
    shut = HALL.model_copy(update={"walls": walls, "doors": (door,)})
    opened = shut.model_copy(update={"doors": (door.model_copy(update={"closed": False}),)})
    assert np.all(_positions(shut, team)[:, 0] < 5.5)
    assert np.any(_positions(opened, team)[:, 0] > 5.5)


def test_start_poses_come_first_and_the_rest_stands_in_formation() -> None:
    team = Team(count=3, start_poses=((5.0, 5.0, 0.0), (7.0, 5.0, 1.0)))
    poses = [robot.start_pose for robot in placed_robots(HALL, team)]
    assert poses[:2] == [(5.0, 5.0, 0.0), (7.0, 5.0, 1.0)]
    distances_m = [math.dist(poses[2][:2], pose[:2]) for pose in poses[:2]]
    assert min(distances_m) > 2 * team.radius_m


def test_more_start_poses_than_robots_are_left_unused() -> None:
    team = Team(count=1, start_poses=((5.0, 5.0, 0.0), (7.0, 5.0, 1.0)))
    assert [robot.start_pose for robot in placed_robots(HALL, team)] == [(5.0, 5.0, 0.0)]


@pytest.mark.parametrize("count", [3, 30, 300, 1000])
def test_large_team_fits_into_the_garage_clear_of_walls_and_each_other(count: int) -> None:
    scenario = load("garage_sar", [f"robots.count={count}"])
    positions = np.array([robot.start_pose[:2] for robot in scenario.placed_robots()])
    assert np.min(shapely.distance(obstacles(scenario.plan), shapely.points(positions))) >= scenario.robots.radius_m
    apart = np.linalg.norm(positions[:, None] - positions[None], axis=2) + np.eye(count) * 1e3
    assert apart.min() >= scenario.robots.spacing_m - 1e-9


def test_formation_is_the_same_each_time() -> None:
    team = Team(count=40, start=(5.0, 5.0, 0.7))
    assert placed_robots(HALL, team) == placed_robots(HALL, team)


def test_team_without_room_is_refused_with_count_and_place() -> None:
    closet = FloorPlan(name="closet", bounds=Bounds(max=(2.0, 2.0)))
    with pytest.raises(PlacementError) as raised:
        placed_robots(closet, Team(count=9, start=(1.0, 1.0, 0.0)))
    assert str(raised.value) == "robots.count: 9 robots 0.8 m apart find no room around [1, 1], only 4 of them"


def test_plan_of_the_largest_size_has_room() -> None:
    field = FloorPlan(name="field", bounds=Bounds(max=(1000.0, 1000.0)))
    assert len(placed_robots(field, Team(count=100, start=(500.0, 500.0, 0.0)))) == 100


def test_spiral_of_theodorus_puts_the_kth_robot_at_the_root_of_k_and_one_step_from_the_last() -> None:
    positions = _positions(
        FloorPlan(name="field", bounds=Bounds(max=(40.0, 40.0))),
        Team(count=40, start=(20.0, 20.0, 0.0), spacing_m=1.5, formation="spiral"),
    )
    offsets = positions - (20.0, 20.0)
    np.testing.assert_allclose(np.hypot(*offsets.T), 1.5 * np.sqrt(np.arange(40)))
    np.testing.assert_allclose(np.hypot(*np.diff(positions, axis=0).T), 1.5)
    np.testing.assert_allclose(offsets[:3], [[0.0, 0.0], [1.5, 0.0], [1.5, 1.5]], atol=1e-12)
    apart = np.hypot(*(positions[:, None] - positions[None, :]).transpose(2, 0, 1)) + 9.0 * np.eye(40)
    assert apart.min() > 1.5 - 1e-9


def test_spiral_turns_with_the_heading_and_leaves_out_places_in_walls() -> None:
    team = Team(count=3, start=(10.0, 5.0, math.pi / 2), spacing_m=1.0, formation="spiral")
    np.testing.assert_allclose(_positions(HALL, team), [[10.0, 5.0], [10.0, 6.0], [9.0, 6.0]], atol=1e-12)
    walled = FloorPlan(name="walled", bounds=HALL.bounds, walls=(Wall(name="w", start=(9.0, 6.0), end=(11.0, 6.0)),))
    positions = _positions(walled, team)
    assert obstacles(walled).distance(shapely.Point(positions[1])) > 0.2
    assert np.hypot(*(positions[1] - (10.0, 5.0))) > 1.4


def test_spiral_without_room_is_refused_with_count_and_place() -> None:
    team = Team(count=30, start=(1.0, 1.0, 0.0), spacing_m=1.0, formation="spiral")
    closet = FloorPlan(name="closet", bounds=Bounds(max=(2.0, 2.0)))
    with pytest.raises(PlacementError, match=r"robots.count: 30 robots 1 m apart find no room around \[1, 1\], only"):
        placed_robots(closet, team)

"""Where a team's robots stand at the start."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.scenario import Scenario, load
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run, Team
from robotteamsim.setup import resolve

HALL = FloorPlan(name="hall", bounds=Bounds(max=(20.0, 10.0)))


ROOM = """\
name: room
plan:
  name: room
  bounds: {min: [0, 0], max: [10, 8]}
robots: {count: 2, start: [3, 3, 0]}
mission:
  victims:
    - {name: ann, position: [2, 2]}
    - {name: bob, position: [4, 4]}
"""


@pytest.fixture
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(ROOM, encoding="utf-8")
    return "room.yaml"


def _placed(plan: FloorPlan, team: Team, seed: int = 1) -> tuple[PlacedRobot, ...]:
    return resolve(Scenario(name="team", plan=plan, robots=team, run=Run(seed=seed))).robots


def _positions(plan: FloorPlan, team: Team) -> np.ndarray:
    return np.array([robot.start_pose[:2] for robot in _placed(plan, team)])


def test_four_robots_form_a_square_around_the_start_front_row_first() -> None:
    positions = _positions(HALL, Team(count=4, start=(5.0, 5.0, 0.0), spacing_m=1.0))
    np.testing.assert_allclose(positions, [[5.5, 5.5], [5.5, 4.5], [4.5, 5.5], [4.5, 4.5]])


def test_formation_turns_with_the_heading() -> None:
    robots = _placed(HALL, Team(count=4, start=(5.0, 5.0, math.pi / 2), spacing_m=1.0))
    expected = [[4.5, 5.5], [5.5, 5.5], [4.5, 4.5], [5.5, 4.5]]
    np.testing.assert_allclose([robot.start_pose[:2] for robot in robots], expected, atol=1e-12)
    assert {robot.start_pose[2] for robot in robots} == {math.pi / 2}


def test_one_robot_is_placed_at_the_start() -> None:
    assert _placed(HALL, Team(count=1, start=(5.0, 5.0, 0.3)))[0].start_pose == (5.0, 5.0, 0.3)


def test_robots_of_a_team_have_the_keys_of_the_team() -> None:
    team = Team(count=2, start=(5.0, 5.0, 0.0), radius_m=0.3, laser=Laser(beams=9))
    assert [(robot.radius_m, robot.laser.beams) for robot in _placed(HALL, team)] == [(0.3, 9)] * 2


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


def test_start_poses_come_first_and_other_robots_form_up() -> None:
    team = Team(count=3, start_poses=((5.0, 5.0, 0.0), (7.0, 5.0, 1.0)))
    poses = [robot.start_pose for robot in _placed(HALL, team)]
    assert poses[:2] == [(5.0, 5.0, 0.0), (7.0, 5.0, 1.0)]
    distances_m = [math.dist(poses[2][:2], pose[:2]) for pose in poses[:2]]
    assert min(distances_m) > 2 * team.radius_m


def test_more_start_poses_than_robots_are_left_unused() -> None:
    team = Team(count=1, start_poses=((5.0, 5.0, 0.0), (7.0, 5.0, 1.0)))
    assert [robot.start_pose for robot in _placed(HALL, team)] == [(5.0, 5.0, 0.0)]


@pytest.mark.parametrize("count", [3, 30, 300, 1000])
def test_large_team_fits_into_the_garage_clear_of_walls_and_each_other(count: int) -> None:
    scenario = load("garage_sar", [f"robots.count={count}"])
    positions = np.array([robot.start_pose[:2] for robot in resolve(scenario).robots])
    assert np.min(shapely.distance(obstacles(scenario.plan), shapely.points(positions))) >= scenario.robots.radius_m
    apart = np.linalg.norm(positions[:, None] - positions[None], axis=2) + np.eye(count) * 1e3
    assert apart.min() >= scenario.robots.spacing_m - 1e-9


def test_random_poses_depend_on_the_seed_and_are_apart_in_the_floor_that_the_start_reaches() -> None:
    wall = Wall(name="w", start=(5.5, 0.0), end=(5.5, 10.0))
    plan = HALL.model_copy(update={"walls": (wall,)})
    found = {}
    for seed, count in ((1, 12), (1, 12), (1, 5), (2, 12)):
        team = Team(count=count, start=(4.5, 5.0, 0.0), formation="random")
        poses = [robot.start_pose for robot in _placed(plan, team, seed)]
        assert found.setdefault((seed, count), poses) == poses
        at = np.array(poses)[:, :2]
        assert at[:, 0].max() < 5.5 - 0.2
        apart_m = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
        assert apart_m[~np.eye(count, dtype=bool)].min() >= team.spacing_m
    assert found[1, 5] == found[1, 12][:5] != found[2, 12][:5]


def test_random_poses_are_spread_uniformly() -> None:
    team = Team(count=20, start=(5.0, 5.0, 0.0), formation="random", spacing_m=0.4)
    counts = np.zeros(4)
    for seed in range(50):
        poses = np.array([robot.start_pose for robot in _placed(HALL, team, seed)])
        counts += np.histogram(poses[:, 0], bins=4, range=(0.25, HALL.bounds.max[0] - 0.25))[0]
    # 1000 robots in four equal parts: 250 in each, standard deviation 14.
    assert np.abs(counts - 250.0).max() < 55.0


def test_random_team_without_room_is_rejected_with_count_and_place() -> None:
    closet = FloorPlan(name="closet", bounds=Bounds(max=(2.0, 2.0)))
    with pytest.raises(PlacementError, match=r"robots.count: 90 robots 0.8 m apart do not fit around \[1, 1\]"):
        _placed(closet, Team(count=90, start=(1.0, 1.0, 0.0), formation="random"))


def test_team_without_room_is_rejected_with_count_and_place() -> None:
    closet = FloorPlan(name="closet", bounds=Bounds(max=(2.0, 2.0)))
    with pytest.raises(PlacementError) as raised:
        _placed(closet, Team(count=9, start=(1.0, 1.0, 0.0)))
    assert str(raised.value) == "robots.count: 9 robots 0.8 m apart do not fit around [1, 1]; there is room for 4"


@pytest.mark.slow
def test_plan_of_the_largest_size_has_room() -> None:
    field = FloorPlan(name="field", bounds=Bounds(max=(1000.0, 1000.0)))
    assert len(_placed(field, Team(count=100, start=(500.0, 500.0, 0.0)))) == 100


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


def test_spiral_without_room_is_rejected_with_count_and_place() -> None:
    team = Team(count=30, start=(1.0, 1.0, 0.0), spacing_m=1.0, formation="spiral")
    closet = FloorPlan(name="closet", bounds=Bounds(max=(2.0, 2.0)))
    with pytest.raises(
        PlacementError, match=r"robots.count: 30 robots 1 m apart do not fit around \[1, 1\]; there is room for"
    ):
        _placed(closet, team)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("robots.start=[30, 3, 0]", "robots.start: [30, 3] lies outside the plan, [0, 0] .. [10, 8]"),
        ("robots={start: [30, 3, 0]}", "robots.start: [30, 3] lies outside the plan, [0, 0] .. [10, 8]"),
        ("robots.count=500", "robots.count: 500 robots 0.8 m apart do not fit around [3, 3]; there is room for 108"),
        (
            "mission.victims.1.position=[4, 9]",
            "mission.victims.1.position: [4, 9] lies outside the plan, [0, 0] .. [10, 8]",
        ),
        (
            "objects=[{name: crate, kind: barrel, radius_m: 0.5, pose: [20, 2, 0]}]",
            "objects.0.pose: [20, 2]: barrel 'crate' lies outside the plan, [0, 0] .. [10, 8]",
        ),
        (
            "schedule=[{at_s: 60, remove: 1}, {at_s: 90, spawn: 1, pose: [-5, 2, 0]}]",
            "schedule.1.pose: [-5, 2]: robot 1 lies outside the plan, [0, 0] .. [10, 8]",
        ),
    ],
)
def test_bad_place_that_was_set_is_a_placement_error_of_set(room: str, override: str, message: str) -> None:
    with pytest.raises(PlacementError) as raised:
        resolve(load(room, [override]))
    assert str(raised.value) == f"--set: {message}"


def test_bad_place_in_the_file_is_not_blamed_on_an_override(room: str) -> None:
    schedule = "schedule: [{at_s: 60, remove: 1}, {at_s: 90, spawn: 1, pose: [-5, 2, 0]}]\n"
    Path(room).write_text(ROOM + schedule, encoding="utf-8")
    with pytest.raises(PlacementError, match=r"^room.yaml: schedule.1.pose: \[-5, 2\]: robot 1 lies outside the plan"):
        resolve(load(room, ["schedule.0.at_s=50", "robots.count=3"]))
    with pytest.raises(PlacementError, match=r"^--set: schedule.1.pose: \[-6, 2\]: robot 1 lies outside the plan"):
        resolve(load(room, ["schedule.1.pose=[-6, 2, 0]"]))

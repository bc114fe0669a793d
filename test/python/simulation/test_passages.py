"""Robots that go from level to level."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import Decision
from robotteamsim.mission.sensed import Sensed
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.levels import Level, Passage
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Simulation

LIFT = Passage(name="lift", stops=((2.0, 2.0), (22.0, 2.0), (42.0, 2.0)), wait_s=2.0, speed_mps=1.0)
STAIRS = Passage(name="stairs", kind="stairs", stops=((8.0, 8.0), (28.0, 8.0)))


def make_plan(passages: Sequence[Passage] = (LIFT, STAIRS)) -> FloorPlan:
    """Return three empty levels of 10 x 10 m, 3 m above one another."""
    walls, levels = [], []
    for k in range(3):
        x, corners = 20.0 * k, [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
        levels.append(
            Level(
                name=f"L{k}", bounds=Bounds(min=(x - 1, -1.0), max=(x + 11, 11.0)), origin=(x, 0.0), elevation_m=3.0 * k
            )
        )
        for i in range(4):
            (x0, y0), (x1, y1) = corners[i], corners[(i + 1) % 4]
            walls.append(Wall(name=f"wall_{k}_{i}", start=(x0 + x, y0), end=(x1 + x, y1)))
    bounds = Bounds(min=(-1.0, -1.0), max=(51.0, 11.0))
    return FloorPlan(name="tower", bounds=bounds, walls=walls, levels=levels, passages=tuple(passages))


def make_scenario(plan: FloorPlan | None = None, **keys: object) -> Scenario:
    robots = {"count": 2, "start_poses": [[3.5, 2.0, math.pi], [6.0, 6.0, 0.0]]}
    data = {"name": "tower", "plan": (plan or make_plan()).model_dump(by_alias=True), "robots": robots, **keys}
    return from_mapping(data, "tower")


class Driven:
    """Controllers of two robots that have goals; the first one drives straight ahead to the stop of the lift."""

    faults = ("", "")

    def __init__(self, goals: dict[int, tuple[float, float]]) -> None:
        self._goals = goals

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        ahead = 2.1 < sensed.observation(0).robot.true_pose.x_m < 15.0
        return tuple(Decision(Twist(0.5 if ahead and i == 0 else 0.0), goal_m=self._goals.get(i)) for i in range(2))


def driven(goals: dict[int, tuple[float, float]], **keys: object) -> Simulation:
    return Simulation(make_scenario(**keys), controllers=Driven(goals))


def level_of(simulation: Simulation, robot_id: int) -> int:
    return int((simulation.world.poses()[robot_id].x_m + 1.0) // 20.0)


def steps_until(simulation: Simulation, level: int, most: int = 400) -> int:
    """Return after how many steps robot 0 is on a level."""
    for number in range(1, most):
        simulation.step()
        if level_of(simulation, 0) == level:
            return number
    raise AssertionError(f"robot 0 is not on level {level} after {most} steps")


@pytest.mark.parametrize(("goal", "level", "rise_m"), [((25.0, 7.0), 1, 3.0), ((45.0, 7.0), 2, 6.0)])
def test_a_lift_takes_a_robot_to_the_level_of_its_goal_in_its_time(
    goal: tuple[float, float], level: int, rise_m: float
) -> None:
    simulation = driven({0: goal})
    at_stop = next(
        k for k in range(1, 200) if simulation.step() and math.dist(simulation.world.positions_m()[0], (2, 2)) <= 0.5
    )
    assert at_stop < 100
    steps = steps_until(simulation, level)
    assert steps * simulation.world.step_ns * 1e-9 == pytest.approx(2.0 + rise_m / 1.0, abs=0.11)
    x, y = simulation.world.positions_m()[0]
    assert math.dist((x, y), (20.0 * level + 2.0, 2.0)) <= LIFT.radius_m


def test_nobody_is_taken_whose_goal_is_on_its_own_level_or_who_has_none() -> None:
    for goals in ({0: (5.0, 5.0)}, {}):
        simulation = driven(goals)
        for _ in range(200):
            simulation.step()
        assert level_of(simulation, 0) == 0


def test_a_robot_is_taken_where_it_is_told_to() -> None:
    simulation = driven({})
    simulation.take_passage(0, "L2")
    assert steps_until(simulation, 2) > 50


def test_stairs_take_no_robots() -> None:
    stairs = Passage(name="stairs", kind="stairs", stops=((2.0, 2.0), (22.0, 2.0)))
    simulation = driven({0: (25.0, 7.0)}, plan=make_plan([stairs]))
    with pytest.raises(ValueError, match="there is no passage to level 'L1'; expected none"):
        simulation.take_passage(0, "L1")
    for _ in range(200):
        simulation.step()
    assert level_of(simulation, 0) == 0


def test_whoever_stands_at_a_stop_is_passed_by() -> None:
    simulation = driven({0: (25.0, 7.0)})
    simulation.world.set_pose(1, Pose(22.0, 2.0, 0.0))
    steps_until(simulation, 1)
    assert 0.4 <= math.dist(*simulation.world.positions_m()) <= 2.0 * LIFT.radius_m


def test_a_robot_that_is_removed_on_its_way_comes_back_where_it_started() -> None:
    simulation = driven({0: (25.0, 7.0)})
    while not simulation.passages._trips:
        simulation.step()
    simulation.remove_robot(0)
    simulation.step()
    simulation.spawn_robot(0)
    simulation.step()
    assert level_of(simulation, 0) == 0
    assert steps_until(simulation, 1) > 20


def test_a_robot_with_odometry_knows_where_a_lift_has_taken_it() -> None:
    """The team explores areas on all levels by odometry without drift, and ends where the truth is."""
    areas = [{"name": f"a{k}", "center": [20.0 * k + 7.0, 5.0], "radius_m": 1.0} for k in range(3)]
    odometry = {"alpha1": 0.0, "alpha2": 0.0, "alpha3": 0.0, "alpha4": 0.0}
    robots = {"count": 2, "start_poses": [[3.5, 2.0, 0.0], [6.0, 6.0, 0.0]], "odometry": odometry}
    missions = []
    for localisation in ("ground_truth", "odometry"):
        scenario = make_scenario(
            robots=robots,
            control={"algorithm": "search", "localisation": localisation},
            mission={"time_limit_s": 300.0, "areas": areas},
        )
        missions.append(Simulation(scenario).run())
    assert [mission.areas_explored for mission in missions] == [3, 3]


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ((0, "L9"), "there is no passage to level 'L9'; expected L0 or L1 or L2$"),
        ((0, "L0"), "robot 0 is on level L0 already"),
        ((7, "L1"), "robot 7 is not there"),
    ],
)
def test_orders_that_cannot_be_followed_are_refused(arguments: tuple, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        driven({}).take_passage(*arguments)


def test_scheduled_passage_equals_a_call_after_the_same_steps() -> None:
    """The passage of robot 1, which is removed before, is skipped."""
    schedule = [{"at_s": 1.0, "take_passage": 0, "level": "L2"}, {"at_s": 2.0, "take_passage": 1, "level": "L2"}]
    scheduled, called = driven({}, schedule=schedule), driven({})
    for number in range(120):
        if number == 10:
            called.take_passage(0, "L2")
        if number == 20:
            scheduled.remove_robot(1)
            called.remove_robot(1)
        poses = [simulation.step().state.true_pose for simulation in (scheduled, called)]
        np.testing.assert_array_equal(*poses)
    assert level_of(scheduled, 0) == 2


def test_robot_that_another_world_moves_is_not_taken() -> None:
    simulation = driven({0: (25.0, 7.0)})
    simulation.passages.elsewhere = (0,)
    for _ in range(200):
        simulation.step()
    assert level_of(simulation, 0) == 0
    with pytest.raises(ValueError, match="robot 0 is moved by another world"):
        simulation.take_passage(0, "L1")


def test_a_plan_without_passages_takes_nobody() -> None:
    with pytest.raises(ValueError, match="the plan has no passages"):
        driven({}, plan=make_plan([])).take_passage(0, "L1")

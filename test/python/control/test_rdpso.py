"""The swarm in the hall: updates, bests, exclusion, and what moves the robots."""

from __future__ import annotations

import itertools
import json
import math

import numpy as np
import pytest

from robotteamsim.control import make_controller
from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.rdpso.team import Best, RdpsoUpdate, parse_update
from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.controllers.swarms import RdpsoControl, SocialExclusion, Swarms
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading
from robotteamsim.setup import resolve
from robotteamsim.swarm import SwarmState

AREA = (16.0, 5.0)
RUNNING = Task(running=True, epoch=1, area_center_m=AREA, area_radius_m=2.0)


def observation(
    step: int, x: float = 3.0, y: float = 4.0, voice: VoiceReading | None = None, odometry: Pose | None = None
):
    """Return what robot 0 perceives in an empty place, at step * 0.1 s."""
    reading = RobotReading(
        ground_truth=PoseReading.from_pose(Pose(x, y, 0.0)),
        twist=Twist(),
        odometry=OdometryReading(PoseReading.from_pose(odometry or Pose(0.0, 0.0, 0.0)), Twist()),
        ranges_m=np.full(181, 5.0, dtype=np.float32),
        in_contact=False,
    )
    return Observation(0, step * 100_000_000, reading, voice or VoiceReading(0.0, False, (x, y), 0.0))


def heard(level_db: float, x: float, y: float) -> VoiceReading:
    return VoiceReading(level_db, True, (x, y), level_db)


def update(robot_id: int, iteration: int, **changes: object) -> Message:
    fields: dict[str, object] = {
        "robot_id": robot_id,
        "iteration": iteration,
        "epoch": 1,
        "position": (3.0, 6.0),
        "loudest": None,
        "local_best": Best(-10.0, (5.0, 6.0)),
        "known_best": None,
        "swarm_id": 0,
        "swarm": SwarmState(),
    }
    return Message(robot_id, EVERYBODY, RdpsoUpdate(**(fields | changes)).to_json())


def drive(controller: RdpsoController, *inputs: tuple[Observation, list[Message], Task]) -> list[Decision]:
    return [controller.step(perceived, inbox, task) for perceived, inbox, task in inputs]


def sent(decision: Decision) -> RdpsoUpdate:
    (message,) = decision.outbox
    parsed = parse_update(message.payload)
    assert parsed is not None
    return parsed


def nearest_m(hall, place: tuple[float, float], seconds: float) -> float:
    """Return how near any robot of a team came to a place within a time."""
    nearest = math.inf
    for _ in range(round(10 * seconds)):
        hall.step()
        nearest = min(nearest, *(math.dist((pose.x_m, pose.y_m), place) for pose in hall.world.poses()))
    return nearest


@pytest.fixture
def robot(hall_scenario) -> RdpsoController:
    return make_controller(0, resolve(hall_scenario()))


def test_robot_sends_an_update_to_everybody_once_per_iteration(robot):
    decisions = drive(robot, *((observation(step), [], RUNNING) for step in range(1, 31)))
    assert [step for step, decision in enumerate(decisions, 1) if decision.outbox] == [1, 10, 20, 30]
    (message,) = decisions[0].outbox
    assert (message.sender, message.receiver) == (0, EVERYBODY)
    assert json.loads(message.payload)["iteration"] == 0
    assert sent(decisions[9]).iteration == 1


def test_local_best_without_a_voice_is_the_free_cell_around_nearest_to_the_area(robot):
    (decision,) = drive(robot, (observation(1, 3.0, 5.0), [], RUNNING))
    best = sent(decision).local_best
    assert math.dist(best.position, (4.5, 5.0)) < 0.15
    assert best.value == pytest.approx(-math.dist(best.position, AREA), abs=0.1)
    assert (decision.local_best, decision.local_best_m) == (best.value, best.position)


def test_voice_is_better_than_any_distance(robot):
    near_area = observation(1, *AREA, voice=heard(0.5, 15.0, 5.0))
    assert sent(drive(robot, (near_area, [], RUNNING))[0]).local_best == Best(0.5, (15.0, 5.0))


def test_robot_goes_to_the_best_of_its_teammate(robot):
    better = update(1, 0, local_best=Best(30.0, (3.0, 9.0)))
    decisions = drive(robot, (observation(1), [], RUNNING), (observation(2), [better], RUNNING))
    d_x, d_y = decisions[1].goal_m[0] - 3.0, decisions[1].goal_m[1] - 4.0
    assert d_y > 0.0
    assert decisions[1].twist != Twist()
    assert sent(drive(robot, (observation(10), [], RUNNING))[0]).known_best == Best(30.0, (3.0, 9.0))
    assert math.hypot(d_x, d_y) <= 0.58 + 1e-9


def test_best_of_another_epoch_is_not_comparable(robot):
    stale = update(1, 0, epoch=0, local_best=Best(30.0, (3.0, 9.0)))
    drive(robot, (observation(1), [], RUNNING), (observation(2), [stale], RUNNING))
    assert not sent(drive(robot, (observation(10), [], RUNNING))[0]).known_best.is_voice


def test_best_is_remembered_until_the_epoch_changes(robot):
    better = update(1, 0, local_best=Best(30.0, (3.0, 9.0)))
    drive(robot, (observation(1), [], RUNNING), (observation(2), [better], RUNNING))
    assert sent(drive(robot, (observation(10), [], RUNNING))[0]).known_best == Best(30.0, (3.0, 9.0))
    next_task = Task(running=True, epoch=2, area_center_m=AREA, area_radius_m=2.0)
    assert sent(drive(robot, (observation(20), [], next_task))[0]).known_best is None


def test_memory_survives_a_pause(robot):
    better = update(1, 0, local_best=Best(30.0, (3.0, 9.0)))
    drive(robot, (observation(1), [], RUNNING), (observation(2), [better], RUNNING))
    paused = Task(running=False, epoch=1, area_center_m=AREA)
    decisions = drive(robot, *((observation(step), [], paused) for step in range(3, 60)))
    assert all(decision.twist == Twist() and not decision.outbox for decision in decisions)
    assert sent(drive(robot, (observation(60), [], RUNNING))[0]).known_best == Best(30.0, (3.0, 9.0))


def test_voice_that_goes_on_where_a_robot_was_is_given_up(robot):
    loudest = heard(12.0, 3.2, 4.0)
    decisions = drive(robot, (observation(1, voice=loudest), [], RUNNING), (observation(2), [], RUNNING))
    # The robot stands 0.2 m from the cell: she would have been saved.
    assert not sent(decisions[0]).local_best.is_voice
    assert decisions[1].goal_m[0] > 3.0


def test_malformed_messages_of_others_do_no_harm(robot):
    nonsense = [Message(1, EVERYBODY, text) for text in ("", "hello", "[]", '{"robot": 1}', '{"robot": "x"}', "3")]
    decisions = drive(robot, (observation(1), nonsense, RUNNING), (observation(2), nonsense, RUNNING))
    assert decisions[1].goal_m is not None


def test_pose_by_odometry_is_the_start_and_the_driven_path(hall_scenario):
    scenario = hall_scenario(
        robots=(PlacedRobot(start_pose=(3.0, 4.0, math.pi / 2)),), control=RdpsoControl(localisation="odometry")
    )
    robot = make_controller(0, resolve(scenario))
    (decision,) = drive(robot, (observation(1, 9.0, 9.0, odometry=Pose(2.0, 1.0, 0.0)), [], RUNNING))
    assert sent(decision).position == pytest.approx((2.0, 6.0))


def test_robot_that_does_not_exist_is_rejected(hall_scenario):
    with pytest.raises(ScenarioError, match="hall: there is no robot 2, only 0 to 1"):
        make_controller(2, resolve(hall_scenario()))


def test_team_comes_to_the_area(team, hall_scenario):
    hall = team(hall_scenario())
    assert nearest_m(hall, AREA, 60.0) < 2.0


@pytest.mark.slow
def test_team_comes_within_a_metre_of_a_voice(team, hall_scenario):
    victim = (9.0, 8.0)
    hall = team(hall_scenario())

    def hear(position: tuple[float, float]) -> VoiceReading:
        """The loudest of 0.25 m cells within 1.5 m, as the voice sensor has it; audible within 7 m."""
        cells = [
            ((i + 0.5) * 0.25, (j + 0.5) * 0.25)
            for i in range(80)
            for j in range(40)
            if math.dist(((i + 0.5) * 0.25, (j + 0.5) * 0.25), position) < 1.5
        ]
        best = min(cells, key=lambda cell: math.dist(cell, victim))
        level_db = 60.0 - 8.0 * math.dist(best, victim)
        return heard(level_db, *best) if level_db > 4.0 else VoiceReading(0.0, False, position, 0.0)

    hall.hear = hear
    assert nearest_m(hall, victim, 60.0) < 1.0


def three(hall_scenario, **sections):
    robots = tuple(PlacedRobot(start_pose=(3.0, y, 0.0)) for y in (4.0, 5.0, 6.0))
    return hall_scenario(robots=robots, **sections)


PRINTED = RdpsoControl(exclusion=SocialExclusion(while_approaching=True, min_robots=0), swarms=Swarms(min=0))
"""Exclusion as printed."""


@pytest.mark.parametrize(("control", "counts"), [(PRINTED, [1, 2, 3]), (RdpsoControl(), [1, 2])])
def test_all_robots_agree_on_the_excluded_ones(team, hall_scenario, control, counts):
    # Nothing can improve when the best is at the robots' feet.
    mission = Mission(areas=(Area(name="here", center=(3.5, 5.0)),))
    hall = team(three(hall_scenario, mission=mission, control=control))
    history = []
    for _ in range(600):
        decisions = hall.step()
        history.append(tuple(decision.excluded for decision in decisions))
        # Each update contains its sender's copy of the swarm's memory.
        updates = [parse_update(m.payload) for decision in decisions for m in decision.outbox]
        assert len({update.swarm for update in updates}) <= 1
    changes = [now for before, now in itertools.pairwise(history) if before != now]
    assert [sum(excluded) for excluded in changes] == counts


def test_excluded_robots_wander_and_keep_sending_updates(team, hall_scenario):
    mission = Mission(areas=(Area(name="here", center=(3.5, 5.0)),))
    hall = team(three(hall_scenario, mission=mission, control=PRINTED))
    hall.run(45.0)
    assert all(decision.excluded for decision in hall.decisions)
    before = [(pose.x_m, pose.y_m) for pose in hall.world.poses()]
    num_updates = 0
    for _ in range(100):
        num_updates += sum(len(decision.outbox) for decision in hall.step())
    after = [(pose.x_m, pose.y_m) for pose in hall.world.poses()]
    assert num_updates == 30
    assert all(math.dist(a, b) > 0.5 for a, b in zip(before, after, strict=True))


def test_excluded_robot_is_called_back_when_the_swarm_improves(team, hall_scenario):
    mission = Mission(areas=(Area(name="here", center=(3.5, 5.0)),))
    hall = team(three(hall_scenario, mission=mission))
    while not any(decision.excluded for decision in hall.step()):
        pass
    hall.new_epoch(area_center_m=AREA)
    for _ in range(300):
        if not any(decision.excluded for decision in hall.step()):
            break
    assert not any(decision.excluded for decision in hall.decisions)


@pytest.mark.parametrize(("control", "num_excluded"), [(PRINTED, 2), (RdpsoControl(), 0)])
def test_robots_on_their_way_to_a_voice_are_excluded_only_as_printed(team, hall_scenario, control, num_excluded):
    # A voice at the far end of the hall is heard only where robot 0 starts.
    hall = team(three(hall_scenario, control=control))
    hall.hear = lambda position: VoiceReading(30.0, math.dist(position, (3.0, 4.0)) < 0.1, (18.0, 5.0), 30.0)
    hall.run(30.0)
    assert sum(decision.excluded for decision in hall.decisions) == num_excluded


def test_nobody_is_excluded_when_exclusion_is_off(team, hall_scenario):
    mission = Mission(areas=(Area(name="here", center=(3.5, 5.0)),))
    control = RdpsoControl(exclusion=SocialExclusion(enabled=False))
    hall = team(three(hall_scenario, mission=mission, control=control))
    hall.run(45.0)
    assert not any(decision.excluded for decision in hall.decisions)


@pytest.mark.parametrize("memory", ["published", "grunwald_letnikov"])
def test_team_comes_to_the_area_with_either_memory(team, hall_scenario, memory):
    hall = team(hall_scenario(control=RdpsoControl(memory=memory, memory_terms=3)))
    assert nearest_m(hall, AREA, 60.0) < 2.0


def test_iteration_may_be_as_short_as_a_step(team, hall_scenario):
    hall = team(hall_scenario(control=RdpsoControl(iteration_s=0.1)))
    hall.run(30.0)
    assert max(pose.x_m for pose in hall.world.poses()) > 4.0

"""Missions in which robots leave and come."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.geometry import Pose
from robotteamsim.scenario import load
from robotteamsim.scenario.controllers import ALGORITHMS
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation, StepRecord

FAILS = "schedule=[{at_s: 5, remove: 1}]"
LIMIT = "mission.time_limit_s=20"


def garage(*overrides: str) -> Simulation:
    return Simulation(load("garage_sar", ["run.seed=7", *overrides]))


def steps(simulation: Simulation, count: int) -> list[StepRecord]:
    return [simulation.step() for _ in range(count)]


def kinds(records: list[StepRecord]) -> list[str]:
    return [event.kind for record in records for event in record.events if event.kind.startswith("robot_")]


def test_robot_that_fails_is_out_of_everything_and_the_others_go_on():
    simulation = garage(FAILS)
    records = steps(simulation, 100)
    before, after = records[49], records[50]
    assert (before.present.tolist(), after.present.tolist()) == ([True] * 3, [True, False, True])
    assert kinds(records) == ["robot_removed"]
    assert np.isnan(after.state.true_pose[1]).all()
    assert not after.voices[1].heard
    assert (after.inboxes[1], after.decisions[1].outbox) == ((), ())
    assert after.network.hop_count[1].tolist() == [-1, -1, -1]
    assert after.network.fiedler_value == 2.0
    assert not any(message.sender == 1 for record in records[50:] for box in record.inboxes for message in box)
    assert records[-1].mission.state == "running"
    moved_m = np.abs(records[-1].readings[0].ground_truth.x_m - after.readings[0].ground_truth.x_m)
    assert moved_m > 0.1


@pytest.mark.slow
def test_schedule_and_calls_at_the_same_step_are_the_same_to_the_bit():
    scheduled = garage(FAILS, LIMIT).run()
    called = garage()
    steps(called, 50)
    called.remove_robot(1)
    records = steps(called, 30)
    again = steps(garage(FAILS), 80)[50:]
    for one, other in zip(records, again, strict=True):
        assert np.array_equal(one.state.true_pose, other.state.true_pose, equal_nan=True)
    assert scheduled.trajectory_hash == garage(FAILS, LIMIT).run().trajectory_hash
    assert scheduled.trajectory_hash != garage(LIMIT).run().trajectory_hash


def test_robot_that_comes_again_starts_from_scratch():
    simulation = garage()
    steps(simulation, 50)
    first, first_controller = simulation.controllers.guards[1], simulation.controllers.guards[1].controller
    simulation.remove_robot(1)
    steps(simulation, 3)
    simulation.spawn_robot(1, Pose(6.0, 5.0, 1.0))
    record = simulation.step()
    reading = record.readings[1]
    assert reading.ground_truth.pose == Pose(6.0, 5.0, pytest.approx(1.0))
    assert (reading.odometry.pose.x_m, reading.odometry.pose.y_m, reading.odometry.pose_covariance) == (
        0.0,
        0.0,
        (0.0,) * 6,
    )
    assert record.present.all()
    assert simulation.controllers.guards[1] is not first
    assert simulation.controllers.guards[1].controller is not first_controller
    assert kinds(steps(simulation, 50)) == []
    assert simulation.world.poses()[1] != Pose(6.0, 5.0, 1.0)


def test_command_from_before_is_none_after():
    simulation = garage()
    steps(simulation, 60)
    assert simulation.world.twists()[1].linear_x_mps > 0.1
    simulation.remove_robot(1)
    simulation.spawn_robot(1, Pose(6.0, 5.0, 1.0))
    simulation.step()
    assert simulation.world.poses()[1] == Pose(6.0, 5.0, 1.0)


def drift(away_steps: int) -> list[tuple[float, ...]]:
    """Return the odometry of a robot that went and came after so many steps, step by step."""
    simulation = garage("control.algorithm=random_walk")
    steps(simulation, 20)
    simulation.remove_robot(1)
    steps(simulation, away_steps)
    for robot_id in (0, 2):
        simulation.remove_robot(robot_id)
    simulation.spawn_robot(1, Pose(6.0, 5.0, 1.0))
    return [record.readings[1].odometry.pose for record in steps(simulation, 100)]


def test_record_shows_what_is_changed_while_no_step_is_made():
    simulation = garage("robots.count=3")
    record = simulation.step()
    simulation.remove_robot(1)
    simulation.remove_robot(2)
    simulation.spawn_robot(1, Pose(6.0, 5.0, 1.0))
    simulation.set_noise_db(25.0)
    seen = simulation.look(record)
    assert seen.present.tolist() == [True, True, False]
    assert (seen.readings[1].true_pose.x_m, seen.readings[1].true_pose.y_m) == (6.0, 5.0)
    assert seen.readings[0].true_pose == record.readings[0].true_pose
    assert (seen.noise_db, record.noise_db) == (25.0, simulation.scenario.voice.noise_db)
    assert record.present.tolist() == [True, True, True]


def test_random_numbers_of_a_spawned_robot_do_not_depend_on_time():
    assert drift(1) == drift(80)


def first_goals(arrivals: int) -> list[tuple[float, float] | None]:
    """Return where robot 1, alone, goes first each time that it comes to the same place."""
    simulation, goals = garage("control.algorithm=random_walk"), []
    simulation.mission.start()
    simulation.step()
    for robot_id in (0, 2):
        simulation.remove_robot(robot_id)
    for _ in range(arrivals):
        simulation.remove_robot(1)
        simulation.spawn_robot(1, Pose(6.0, 5.0, 1.0))
        goals.append(simulation.step().decisions[1].goal_m)
    return goals


def test_controller_draws_other_numbers_each_time_that_its_robot_comes():
    goals = first_goals(3)
    assert len(set(goals)) == 3
    assert None not in goals
    assert goals == first_goals(3)


def test_reserve_comes_by_schedule():
    simulation = garage("robots.count=4", "robots.reserve=1", "schedule=[{at_s: 2, spawn: 3}]")
    records = steps(simulation, 30)
    assert records[19].present.tolist() == [True, True, True, False]
    assert records[20].present.all()
    assert tuple(simulation.world.arrivals) == (1, 1, 1, 1)
    assert kinds(records) == ["robot_spawned"]


def test_robot_that_is_removed_while_it_waits_for_room_does_not_come():
    pose = list(resolve(load("garage_sar")).robots[0].start_pose)
    spawn = f"{{at_s: 0, spawn: 3, pose: {pose}}}"
    came = [
        steps(garage("robots.count=4", "robots.reserve=1", f"schedule=[{events}]"), 100)[-1].present[3]
        for events in (spawn, f"{spawn}, {{at_s: 0.3, remove: 3}}")
    ]
    assert came == [True, False]


def test_mission_fails_when_the_last_robot_does():
    schedule = "schedule=[{at_s: 3, remove: 0}, {at_s: 4, remove: 1}, {at_s: 5, remove: 2}]"
    result = garage(schedule).run()
    assert (result.end, result.steps) == ("none_left", 51)
    assert all(math.isfinite(robot.distance_m) for robot in result.robots)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_every_controller_goes_on_without_a_teammate_and_with_a_new_one(algorithm: str):
    schedule = "schedule=[{at_s: 3, remove: 1}, {at_s: 6, spawn: 1}]"
    known = f"control.map={ALGORITHMS[algorithm].maps[0]}"
    records = steps(garage(f"control.algorithm={algorithm}", known, schedule), 120)
    assert not any(decision.fault for decision in records[-1].decisions)
    assert records[-1].present.all()
    if algorithm != "relay":  # a team of relays alone has nobody to connect, and stands still
        assert records[-1].readings[1].ground_truth != records[61].readings[1].ground_truth


def test_robot_that_leaves_and_comes_back_at_once_has_lost_its_messages():
    simulation = garage()
    records = steps(simulation, 100)
    sent = next(i for i, record in enumerate(records) if record.decisions[1].outbox)
    again = garage()
    record = steps(again, sent + 1)[-1]
    assert record.decisions[1].outbox
    again.remove_robot(1)
    again.spawn_robot(1)
    assert not [message for inbox in again.step().inboxes for message in inbox if message.sender == 1]


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "at_s", "lost"), [(504, 35.6, 1), (506, 56.9, 1)])
def test_others_of_a_swarm_explore_all_areas_after_a_robot_is_lost(seed, at_s, lost):
    # Before, the place where it was last heard pushed them away until all were excluded.
    keys = [f"run.seed={seed}", f"schedule=[{{at_s: {at_s}, remove: {lost}}}]"]
    result = Simulation(load("garage_sar", keys)).run()
    assert (result.end, result.areas_explored) == ("areas_explored", 5)

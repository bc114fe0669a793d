#!/usr/bin/env python3
"""Compares a mission in lockstep with the same mission run without ROS, and with itself after a reset."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import math
from io import BytesIO
from typing import Any

import rostest
from compared import STEP_NS, ComparedMission, Log
from listening import Topic, pause, place_m
from nav_msgs.msg import Odometry
from robotteamsim.msg import SensorWorld
from robotteamsim.srv import ResetSeed
from sensor_msgs.msg import LaserScan

from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation, StepRecord

SEED, OTHER_SEED = 7, 8
STEPS = 300
ROBOTS = range(3)


def stamp_ns(message: Any) -> int:
    return message.header.stamp.to_nsec()


def bits(message: Any) -> bytes:
    """Return a message as it travels, but for the number that its publisher has counted up to."""
    message.header.seq = 0
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def runs_of(topic: Topic) -> list[list[Any]]:
    """Return the messages of each run, which begins where stamps jump back."""
    runs: list[list[Any]] = [[]]
    for message in topic.messages:
        if runs[-1] and stamp_ns(message) <= stamp_ns(runs[-1][-1]):
            runs.append([])
        runs[-1].append(message)
    return [[message for message in run if stamp_ns(message) <= STEPS * STEP_NS] for run in runs]


def headless(seed: int) -> Result:
    return Simulation(load("garage_sar", ["mission.time_limit_s=30", f"run.seed={seed}"])).run()


def sensor_world_of(record: StepRecord) -> list[tuple[Any, ...]]:
    center_m = record.mission.task.area_center_m
    assert center_m is not None
    return [
        (
            decision.local_best_m or (0.0, 0.0),
            decision.local_best,
            [round(math.dist((pose.x_m, pose.y_m), victim.position), 9) for victim in record.victims],
            round(math.dist((pose.x_m, pose.y_m), center_m), 9),
        )
        for decision, pose in zip(record.decisions, (one.ground_truth for one in record.readings), strict=True)
    ]


class LockstepTest(ComparedMission):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.odometry = [Topic(f"/robot_{i}/odom", Odometry) for i in ROBOTS]
        cls.scans = [Topic(f"/robot_{i}/base_scan", LaserScan) for i in ROBOTS]
        cls.worlds = Topic("/sensor_world", SensorWorld)
        cls.first = cls.document_at_end()["result"]
        cls.again = cls.document_after("/simulation/reset")["result"]
        cls.other = cls.document_after("/simulation/reset_seed", ResetSeed, seed=OTHER_SEED)["result"]
        pause(*cls.odometry, *cls.scans)

    def test_mission_has_the_same_bits_as_without_ros(self) -> None:
        expected = headless(SEED)
        self.assertEqual(self.first["trajectory_hash"], expected.trajectory_hash)
        self.assertEqual((self.first["steps"], self.first["end"]), (expected.steps, "time_limit"))
        self.assertEqual((self.first["seed"], self.first["scenario"]), (SEED, "garage_sar"))
        self.assertEqual(
            [robot["distance_m"] for robot in self.first["robots"]], [r.distance_m for r in expected.robots]
        )

    def test_sensor_world_of_every_step_is_that_without_ros(self) -> None:
        found = {
            stamp_ns(world): [
                (
                    (robot.local_best.x, robot.local_best.y),
                    robot.value,
                    [round(away_m, 9) for away_m in robot.victim_distances_m],
                    round(robot.area_distance_m, 9),
                )
                for robot in world.robots
            ]
            for world in runs_of(self.worlds)[1]
        }
        expected = Log("garage_sar", self.settings, worlds=sensor_world_of).kept["worlds"]
        self.assert_values(found, expected, STEPS)

    def test_reset_begins_the_same_run_again(self) -> None:
        self.assertEqual(self.again["trajectory_hash"], self.first["trajectory_hash"])
        for topic in (*self.odometry, *self.scans):
            first, again, other = ({stamp_ns(message): bits(message) for message in run} for run in runs_of(topic))
            self.assertEqual({stamp: again[stamp] for stamp in first}, first)
            self.assertNotEqual({stamp: other[stamp] for stamp in first}, first)

    def test_reset_leaves_no_odometry(self) -> None:
        for topic in self.odometry:
            for run in runs_of(topic)[1:]:
                self.assertEqual((stamp_ns(run[0]), place_m(run[0])), (STEP_NS, (0.0, 0.0)))
                self.assertNotEqual(place_m(run[-1]), (0.0, 0.0))

    def test_reset_with_another_seed_begins_the_run_of_that_seed_in_every_node(self) -> None:
        self.assertNotEqual(self.other["trajectory_hash"], self.first["trajectory_hash"])
        self.assertEqual(self.other["trajectory_hash"], headless(OTHER_SEED).trajectory_hash)
        self.assertEqual(self.other["seed"], OTHER_SEED)

    def test_subscriber_gets_the_scan_of_every_step(self) -> None:
        wanted = [STEP_NS * step for step in range(1, STEPS + 1)]
        for topic in self.scans:
            first, *others = ([stamp_ns(message) for message in run] for run in runs_of(topic))
            # The world may have taken its first step before there was a subscriber.
            self.assertEqual(first, wanted[-len(first) :])
            self.assertGreater(len(first), 1)
            self.assertEqual(others, [wanted, wanted])


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "lockstep", LockstepTest)

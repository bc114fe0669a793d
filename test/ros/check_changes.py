#!/usr/bin/env python3
"""Changes doors, robots, victims and noise in a mission in lockstep, by schedule and by service.

The mission is the same as without ROS, and a reset repeats it without what the services did.
"""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions report the values

from __future__ import annotations

from typing import Any

import numpy as np
import rostest
from compared import STEP_NS, ComparedMission, Log, by_stamp
from geometry_msgs.msg import Pose2D
from listening import Topic, call, catch_up, pause, place_m
from nav_msgs.msg import Odometry
from robotteamsim.msg import Doors, FloatMap, Robots, Victims
from robotteamsim.srv import GetRadioMap, RemoveRobot, SetDoor, SpawnRobot, Step
from std_srvs.srv import Trigger

from robotteamsim.geometry import Pose
from robotteamsim.simulation import Simulation, StepRecord

AWAY_STEPS = 10
"""Steps from the removal of robot 1 to its coming again."""
THERE = Pose2D(10.0, 3.0, 0.5)


def doors_of(record: StepRecord) -> list[tuple[str, bool, float, str]]:
    return [(name, door.closed, door.opening, door.motion) for name, door in record.doors.items()]


def victims_of(record: StepRecord) -> list[tuple[str, float, float, str]]:
    states = zip(record.victims, record.mission.victims, strict=True)
    return [(victim.name, *victim.position, state) for victim, state in states]


def voice_map_of(record: StepRecord) -> bytes | None:
    return None if record.voice_map is None else record.voice_map.values.tobytes()


class ChangesTest(ComparedMission):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.doors, cls.robots = Topic("/world/doors", Doors), Topic("/world/robots", Robots)
        cls.odometry = [Topic(f"/robot_{i}/odom", Odometry) for i in range(4)]
        cls.victims, cls.maps = Topic("/mission/victims", Victims), Topic("/voice_map/values", FloatMap)
        cls.status.wait_for_count(5)
        cls.step_index = pause().to_nsec() // STEP_NS
        cls.change()
        call("/simulation/resume", Trigger)
        cls.first = cls.document_at_end()
        catch_up(cls.doors, cls.robots, cls.odometry[1])
        cls.topics = (cls.doors, cls.robots, cls.odometry[1], cls.victims, cls.maps)
        cls.of_first = [by_stamp(topic.messages) for topic in cls.topics]
        cls.begin = [len(topic.messages) for topic in cls.topics]
        cls.second = cls.document_after("/simulation/reset")
        cls.changed = Log(
            "garage_sar",
            cls.settings,
            cls.as_changed,
            doors=doors_of,
            present=lambda record: [*map(record.is_there, range(4))],
        )
        cls.plain = Log("garage_sar", cls.settings, victims=victims_of, maps=voice_map_of)

    @classmethod
    def change(cls) -> None:
        """Do in ROS what `as_changed` does without it, and what is rejected."""
        cls.rejected = [
            (
                call("/simulation/set_door", SetDoor, name="no_such_door", closed=True),
                "unknown door 'no_such_door'; known: plant_door, stair_door",
            ),
            (call("/simulation/remove_robot", RemoveRobot, robot_id=4), "robot_id must be in 0..3, got 4"),
            (call("/simulation/remove_robot", RemoveRobot, robot_id=3), "robot_3 is not present; it cannot be removed"),
            (
                call("/simulation/spawn_robot", SpawnRobot, robot_id=1, at_start=True),
                "robot_1 is already present; it cannot be spawned",
            ),
            (
                call("/simulation/spawn_robot", SpawnRobot, robot_id=3, pose=Pose2D(10.0, 0.2, 0.0)),
                "robot_3: pose (10.00, 0.20) is inside wall 'south'; expected 0.2 m of clearance",
            ),
            (
                call("/simulation/spawn_robot", SpawnRobot, robot_id=3, pose=Pose2D(float("nan"), 3.0, 0.0)),
                "robot_3: pose must be finite",
            ),
            (call("/simulation/get_radio_map", GetRadioMap, robot_id=3), "robot_id: 3; the robot is not present"),
        ]
        assert call("/simulation/set_door", SetDoor, name="stair_door", closed=False).success
        assert call("/simulation/remove_robot", RemoveRobot, robot_id=1).success
        assert call("/simulation/spawn_robot", SpawnRobot, robot_id=3, at_start=True).success
        assert call("/simulation/step", Step, steps=AWAY_STEPS).success
        assert call("/simulation/spawn_robot", SpawnRobot, robot_id=1, pose=THERE).success
        assert call("/simulation/remove_robot", RemoveRobot, robot_id=2).success
        assert call("/simulation/spawn_robot", SpawnRobot, robot_id=2, at_start=True).success

    @classmethod
    def as_changed(cls, simulation: Simulation, step_index: int) -> None:
        if step_index == cls.step_index:
            simulation.set_door("stair_door", False)
            simulation.remove_robot(1)
            simulation.spawn_robot(3)
        if step_index == cls.step_index + AWAY_STEPS:
            simulation.spawn_robot(1, Pose(THERE.x, THERE.y, THERE.theta))
            simulation.remove_robot(2)
            simulation.spawn_robot(2)

    def of_second(self, topic: Topic) -> dict[int, Any]:
        return by_stamp(topic.messages[self.begin[self.topics.index(topic)] :])

    def test_mission_has_the_same_bits_and_events_as_without_ros(self) -> None:
        self.assert_as_expected(self.first, self.changed)
        expected = {
            "background noise is 12 dB",
            "background noise is 20 dB",
            "door plant_door is closed",
            "door stair_door is opened",
            "robot 0 is removed",
            "robot 0 is spawned",
            "robot 1 is removed",
            "robot 1 is spawned",
            "robot 3 is spawned",
            "victim victim_1 calls at (6.0, 5.0)",
            "victim eve calls at (10.0, 3.0)",
        }
        self.assertLessEqual(expected, {event["detail"] for event in self.first["events"]})

    def test_reset_repeats_the_schedule_without_the_services(self) -> None:
        self.assert_as_expected(self.second, self.plain)

    def test_reset_puts_back_robots_and_doors(self) -> None:
        robots, doors = self.of_second(self.robots)[STEP_NS], self.of_second(self.doors)[STEP_NS]
        self.assertEqual((list(robots.present), list(robots.arrivals)), ([1, 1, 1, 0], [1, 1, 1, 0]))
        self.assertEqual([(door.closed, door.opening) for door in doors.doors], [(False, 1.0), (True, 0.0)])

    def test_doors_of_every_step_are_those_without_ros(self) -> None:
        found = {
            stamp_ns: [(door.name, door.closed, door.opening, door.motion) for door in message.doors]
            for stamp_ns, message in self.of_first[0].items()
        }
        self.assert_values(found, self.changed.kept["doors"], 100)
        self.assertTrue(any(0.0 < doors[0][2] < 1.0 for doors in found.values()))

    def test_robots_present_in_every_step_are_those_without_ros(self) -> None:
        found = {stamp_ns: [bool(there) for there in message.present] for stamp_ns, message in self.of_first[1].items()}
        self.assert_values(found, self.changed.kept["present"], 100)

    def test_topics_of_an_absent_robot_are_silent_and_odometry_restarts(self) -> None:
        away = range(self.step_index + 1, self.step_index + AWAY_STEPS + 1)
        found = {stamp_ns // STEP_NS: message for stamp_ns, message in self.of_first[2].items()}
        self.assertFalse(set(away) & set(found))
        self.assertEqual(place_m(found[away[-1] + 1]), (0.0, 0.0))
        self.assertNotEqual(place_m(found[away[0] - 1]), (0.0, 0.0))

    def test_victims_are_where_they_are_without_ros(self) -> None:
        found = {
            stamp_ns: [(v.name, v.position.x, v.position.y, v.state) for v in message.victims]
            for stamp_ns, message in self.of_second(self.victims).items()
        }
        self.assert_values(found, self.plain.kept["victims"], 10)

    def test_voice_maps_change_in_the_same_steps_to_the_same_values(self) -> None:
        found = {
            stamp_ns: np.array(message.data, dtype=np.float32).tobytes()
            for stamp_ns, message in self.of_second(self.maps).items()
        }
        self.assert_values(found, self.plain.kept["maps"], 10)
        last_ns = max(self.plain.kept["maps"])
        self.assertLessEqual({ns for ns in found if 0 < ns <= last_ns}, set(self.plain.kept["maps"]))

    def test_invalid_input_is_rejected_with_the_reason(self) -> None:
        for answer, reason in self.rejected:
            self.assertFalse(answer.success)
            self.assertIn(reason, answer.message)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "changes", ChangesTest)

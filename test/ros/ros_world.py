"""A world behind ROS with the members of `robotteamsim.world.contract` that the tests of that contract use.

Commands and changes go out by topics and services; readings are the messages with the stamp of the last step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import Pose2D
from geometry_msgs.msg import Twist as TwistMessage
from listening import TIMEOUT_S, Topic, send
from nav_msgs.msg import Odometry
from robotteamsim.msg import Contact, Doors, Robots
from robotteamsim.srv import RemoveRobot, SetDoor, SetPose, SpawnRobot
from sensor_msgs.msg import LaserScan

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.world.doors import DoorState, DoorStates

STOP = Twist()


class RosWorld:
    """A world in another process, which takes a step whenever it is allowed to."""

    def __init__(self, scenario: Scenario, advance: Callable[[int], None], *, has_presence: bool) -> None:
        """Wait until the world is there.

        Args: advance: lets the world take its next step, which ends at a time [ns].
              has_presence: whether it publishes /world/robots.
        """
        self.plan, self.num_robots = scenario.plan, len(scenario.robots)
        self.step_ns, self.step_index = scenario.run.step_ns, 0
        self._advance = advance
        names = [f"/robot_{robot_id}/" for robot_id in range(self.num_robots)]
        self._truths = [Topic(f"{name}base_pose_ground_truth", Odometry) for name in names]
        self._contacts = [Topic(f"{name}contact", Contact) for name in names]
        self._scans = [Topic(f"{name}base_scan", LaserScan) for name in names]
        self._doors = Topic("/world/doors", Doors)
        self._robots = Topic("/world/robots", Robots) if has_presence else None
        self._set_door = "/simulation/set_door" if has_presence else "/world/set_door"
        self._commands = [
            rospy.Publisher(f"{name}cmd_vel", TwistMessage, queue_size=10, tcp_nodelay=True) for name in names
        ]
        self._states = DoorStates.at_start(scenario.plan)
        self._has_changed = False
        self._wait_for_connections()

    def close(self) -> None:
        """Forget the topics, so that those of the next world have no message of this one."""
        for topic in self._topics:
            topic.unsubscribe()
        for publisher in self._commands:
            publisher.unregister()

    @property
    def sim_time_ns(self) -> int:
        """Time of the last step."""
        return self.step_index * self.step_ns

    def step(self, twists: Sequence[Twist]) -> None:
        """Send the commands and let the world take a step."""
        for publisher, twist in zip(self._commands, twists, strict=True):
            message = TwistMessage()
            message.linear.x, message.linear.y = twist.linear_x_mps, twist.linear_y_mps
            message.angular.z = twist.angular_z_radps
            send(publisher, message)
        self.advance()

    def advance(self) -> None:
        """Let the world take a step without new commands."""
        self.step_index += 1
        self._has_changed = False
        self._advance(self.sim_time_ns)
        for robot_id in self._present_ids():
            self._now(self._truths[robot_id])

    @property
    def present(self) -> np.ndarray:
        return np.array(list(self._presence().present), dtype=bool)

    @property
    def arrivals(self) -> tuple[int, ...]:
        return tuple(self._presence().arrivals)

    def poses(self) -> list[Pose]:
        def pose(robot_id: int) -> Pose:
            found = self._read(self._truths[robot_id]).pose.pose
            return Pose(found.position.x, found.position.y, 2.0 * math.atan2(found.orientation.z, found.orientation.w))

        self._settle()
        ids = self._present_ids()
        return [pose(i) if i in ids else Pose(math.nan, math.nan, math.nan) for i in range(self.num_robots)]

    def positions_m(self) -> np.ndarray:
        return np.array([(pose.x_m, pose.y_m) for pose in self.poses()])

    def twists(self) -> list[Twist]:
        twists = [self._read(topic).twist.twist for topic in self._truths]
        return [Twist(twist.linear.x, twist.linear.y, twist.angular.z) for twist in twists]

    def in_contact(self) -> list[bool]:
        return [self._read(topic).in_contact for topic in self._contacts]

    def contact_angles_rad(self) -> dict[int, tuple[float, ...]]:
        angles = [tuple(self._read(topic).angles_rad) for topic in self._contacts]
        return {robot_id: found for robot_id, found in enumerate(angles) if found}

    def door_states(self) -> DoorStates:
        found = {door.name: DoorState(door.closed, door.opening, door.motion) for door in self._read(self._doors).doors}
        if found != dict(self._states):
            self._states = DoorStates(found, self._states.version + 1)
        return self._states

    def readings(self) -> list[SimpleNamespace]:
        """Return the scans of all robots; those of absent ones are empty."""
        self._settle()
        ids = self._present_ids()
        scans = [self._read(topic).ranges if i in ids else () for i, topic in enumerate(self._scans)]
        return [SimpleNamespace(ranges_m=np.array(ranges, dtype=np.float32)) for ranges in scans]

    def set_door(self, name: str, closed: bool) -> None:
        self._change(self._set_door, SetDoor, name=name, closed=closed)

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        self._change("/simulation/set_pose", SetPose, robot_id=robot_id, pose=Pose2D(pose.x_m, pose.y_m, pose.yaw_rad))

    def remove_robot(self, robot_id: int) -> None:
        self._change("/simulation/remove_robot", RemoveRobot, robot_id=robot_id)

    def spawn_robot(self, robot_id: int, pose: Pose) -> None:
        place = Pose2D(pose.x_m, pose.y_m, pose.yaw_rad)
        self._change("/simulation/spawn_robot", SpawnRobot, robot_id=robot_id, at_start=False, pose=place)

    @property
    def _topics(self) -> tuple[Topic, ...]:
        of_team = (self._doors,) if self._robots is None else (self._doors, self._robots)
        return (*self._truths, *self._contacts, *self._scans, *of_team)

    def _wait_for_connections(self) -> None:
        for topic in self._topics:
            assert topic.is_connected(TIMEOUT_S), f"nobody publishes {topic.name}"

    def _change(self, service: str, service_class: type, /, **fields: Any) -> None:
        """Call a service. Raises: ValueError: with its message, if it refuses."""
        rospy.wait_for_service(service, timeout=TIMEOUT_S)
        answer = rospy.ServiceProxy(service, service_class)(**fields)
        if not answer.success:
            raise ValueError(answer.message)
        self._has_changed = True

    def _settle(self) -> None:
        """Take a step if something has changed since the last one: only then can its readings be there."""
        if self._has_changed or self.step_index == 0:
            self.step([STOP] * self.num_robots)

    def _read(self, topic: Topic) -> Any:
        self._settle()
        return self._now(topic)

    def _now(self, topic: Topic) -> Any:
        """Return the message of a topic in the last step, as soon as it has come."""
        time_ns = self.sim_time_ns
        return topic.wait_for_after(0, lambda message: message.header.stamp.to_nsec() == time_ns, f"time {time_ns} ns")

    def _presence(self) -> Any:
        assert self._robots is not None, "this world does not publish who is present"
        return self._read(self._robots)

    def _present_ids(self) -> list[int]:
        if self._robots is None:
            return list(range(self.num_robots))
        return [robot_id for robot_id, present in enumerate(self._now(self._robots).present) if present]

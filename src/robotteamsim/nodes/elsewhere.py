"""Robots that another world moves, such as Gazebo or the real one: their poses and readings come by topic."""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import PoseReading
from robotteamsim.message_parts import robot_name
from robotteamsim.nodes.inputs import RobotInputs
from robotteamsim.nodes.node import Node
from robotteamsim.nodes.settings import Settings
from robotteamsim.nodes.steps import REPORT_TIMEOUT_S
from robotteamsim.nodes.tf_pose import TfPose
from robotteamsim.nodes.transforms import Transforms
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.sensing.robots import Sensors
from robotteamsim.world.contract import AnyWorld

STALE_NS = 10**9
"""A message that is older than the last one by less than this is late; by more, time has jumped back."""
CHECK_PERIOD_S = 1.0
"""Interval of checks for missing transforms during a wait [s, wall]."""

logger = logging.getLogger(__name__)


class _Robot:
    """The topics and the newest pose of one robot."""

    def __init__(self, node: Node, settings: Settings, robot_id: int, transforms: Transforms | None) -> None:
        self.inputs = RobotInputs(node, settings, robot_id)
        self.values: dict[str, Any] = {}
        timeout_s = settings.scenario.control.tf_timeout_s
        self._timeout_ns = round(timeout_s * 1e9)
        self.tf = None if transforms is None else TfPose(transforms.newest, robot_name(robot_id), timeout_s)
        self.pace = (self.inputs.truth if self.tf is None else self.inputs.odometry).topic
        """The topic that each step waits for."""
        self.pace_ns = self.truth_ns = 0
        self._lost = ""

    def forget(self) -> None:
        """Forget everything, because time has jumped back."""
        self.values.clear()
        self.pace_ns = self.truth_ns = 0
        self._lost = ""
        if self.tf is not None:
            self.tf.restart()

    def locate(self, stamp_ns: int) -> bool:
        """Look the pose up in a step; return whether it is known. The pose of a lost robot is its last one."""
        if self.tf is None:
            return True
        if stamp_ns - self.truth_ns >= self._timeout_ns:
            self.values.pop(self.inputs.truth.topic, None)
        lost = "" if self.has_truth else self.tf.follow(stamp_ns)
        if lost and not self._lost and self.tf.newest is not None:
            logger.warning("%s; using its last position", lost)
        self._lost = lost
        return self.has_truth or self.tf.newest is not None

    @property
    def has_truth(self) -> bool:
        """Whether the ground truth is published; if it is, tf is not used here."""
        return self.inputs.truth.topic in self.values

    def reading(self) -> RobotReading:
        """Return the newest reading."""
        pose: PoseReading | None = None if self.has_truth or self.tf is None else self.tf.newest
        return self.inputs.reading(self.values, pose)


class RobotsElsewhere:
    """The robots of the setting `elsewhere`: where they are, and what they sense."""

    def __init__(self, node: Node, settings: Settings) -> None:
        """Subscribe."""
        self._step_ns = settings.step_ns
        self._has_time = settings.is_another_world
        self._transforms = Transforms(node) if settings.by_tf else None
        self._robots = {i: _Robot(node, settings, i, self._transforms) for i in settings.elsewhere}
        self._changed = threading.Condition()
        self._closed = False
        self._due_ns = 0
        """Stamp of the next step; half a step less is enough, so that jitter of the messages skips no step."""
        self._last_ns: int | None = None
        self.skipped_steps = 0
        """Number of the other world's steps that came too fast to be taken."""
        self.has_jumped_back = False
        """Whether the other world's time has jumped back."""
        for robot in self._robots.values():
            inputs = robot.inputs
            for one in (inputs.odometry, inputs.truth, inputs.scan, inputs.contact, *inputs.additional):
                one.listen(partial(self._receive, robot))

    def close(self) -> None:
        """End all waits; also from a signal handler, because the lock is reentrant."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def wait(self, is_present: Callable[[int], bool]) -> int | None:
        """Wait for the other world's next step and return its stamp [ns]; None if closed, or its time has jumped back.

        Args: is_present: whether a robot is present; each step needs a message of all that are. Without robots, steps
              follow each other in wall time.
        """
        begin_s, reported = time.monotonic(), False
        while True:
            with self._changed:
                robots = [robot for robot_id, robot in self._robots.items() if is_present(robot_id)]
                while not (self._is_due(robots) or self.has_jumped_back or self._closed):
                    is_news = self._changed.wait(CHECK_PERIOD_S if robots else self._step_ns / 1e9)
                    robots = [robot for robot_id, robot in self._robots.items() if is_present(robot_id)]
                    if not robots and not is_news:
                        break
                if self._closed or self.has_jumped_back:
                    return None
                stamp_ns = max((robot.pace_ns for robot in robots), default=self._due_ns)
                is_late = stamp_ns - self._due_ns >= self._step_ns // 2
                self._due_ns = (stamp_ns if is_late else self._due_ns) + self._step_ns
                located = [robot.locate(stamp_ns) for robot in robots]
                if all(located):
                    self._count_skipped(stamp_ns)
                    return stamp_ns
            if not reported and time.monotonic() - begin_s > REPORT_TIMEOUT_S:
                reported = True
                logger.warning("%s", _unlocated(robots))

    def restart(self) -> None:
        """Restart with the other world's next step."""
        with self._changed:
            self._due_ns, self.has_jumped_back = 0, False
            self._last_ns, self.skipped_steps = None, 0
            if self._transforms is not None:
                self._transforms.clear()
            for robot in self._robots.values():
                robot.forget()

    def _count_skipped(self, stamp_ns: int) -> None:
        if self._last_ns is not None:
            self.skipped_steps += max(0, (stamp_ns - self._last_ns + self._step_ns // 2) // self._step_ns - 1)
        self._last_ns = stamp_ns

    def follow(self, world: AnyWorld, stamp_ns: int | None) -> None:
        """Put the bodies where they are in the other world.

        Args: stamp_ns: of the other world's step; None if time is that of this world.
        """
        if stamp_ns is not None:
            world.sim_time_ns = stamp_ns - self._step_ns
        for robot_id, reading in self.readings().items():
            # Where there is no room in this world, or if the robot is absent, the body stays where it was.
            with contextlib.suppress(PlacementError, ValueError):
                world.set_pose(robot_id, reading.true_pose)

    def readings(self) -> dict[int, RobotReading]:
        """Return the newest readings, by id of the robots that have some."""
        with self._changed:
            return {i: robot.reading() for i, robot in self._robots.items() if self._is_known(robot)}

    def _is_known(self, robot: _Robot) -> bool:
        inputs = robot.inputs
        needed = [inputs.odometry.topic] + ([inputs.truth.topic] if robot.tf is None else [])
        return all(topic in robot.values for topic in needed) and (robot.tf is None or robot.locate(robot.pace_ns))

    def _is_due(self, robots: Sequence[_Robot]) -> bool:
        stamps = [robot.pace_ns for robot in robots]
        is_due = max(stamps, default=0) >= self._due_ns - self._step_ns // 2
        return is_due and all(stamp_ns > max(0, self._due_ns - 2 * self._step_ns) for stamp_ns in stamps)

    def _receive(self, robot: _Robot, topic: str, stamp_ns: int, value: Any) -> None:
        with self._changed:
            if topic == robot.pace:
                if stamp_ns < robot.pace_ns:
                    if robot.pace_ns - stamp_ns < STALE_NS:
                        return
                    self.has_jumped_back = self._has_time
                robot.pace_ns = stamp_ns
                self._changed.notify_all()
            if topic == robot.inputs.truth.topic:
                robot.truth_ns = stamp_ns
            robot.values[topic] = value


def _unlocated(robots: Sequence[_Robot]) -> str:
    missing = [robot.tf for robot in robots if robot.tf is not None and robot.tf.newest is None]
    names = ", ".join(tf.name for tf in missing)
    reason = missing[0].reason.strip() if missing else ""
    return (
        f"/tf: waited {REPORT_TIMEOUT_S:g} s for {names}; expected a localisation node such as amcl to publish "
        f"map -> odom and the robot odom -> base_link ({reason})"
    )


class SensorsElsewhere:
    """The sensors of a team of which some robots are in another world."""

    def __init__(self, sensors: Sensors, robots: RobotsElsewhere, world: AnyWorld) -> None:
        """Args: sensors: of the robots in this world.  world: says who is present."""
        self._sensors = sensors
        self._robots = robots
        self._world = world

    def read(self) -> _core.state.State:
        """As for all sensors: the pose of an absent robot is NaN, wherever it lies in the other world."""
        state = self._sensors.read()
        for robot_id, reading in self._robots.readings().items():
            if self._world.present[robot_id]:
                state.put_reading(robot_id, reading)
        return state

"""The robots present, as published by the world."""

from collections.abc import Mapping

import numpy as np

from robotteamsim.msg import Robots
from robotteamsim.recording.ros_messages import MISHAPS
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.topics import Input
from robotteamsim.world.contract import Mishap

ROBOTS = "/world/robots"
PRESENCE = Input(Channel(ROBOTS, has_presence=True), Robots)
"""The input with the robots present; if the world does not publish it, all are."""


class Presence:
    """The robots present according to the last message of the world."""

    def __init__(self) -> None:
        self.present: np.ndarray | None = None
        """Whether each robot is present, bool, shape (n,); None if all are. The same object until that changes."""
        self.arrivals: tuple[int, ...] | None = None
        """Number of arrivals of each robot; None if not published yet."""
        self.mishaps: Mapping[int, Mishap] = {}
        """Robots that cannot go on, by id, and why."""
        self.loads: Mapping[int, str] = {}
        """Names of the objects that robots hold, by the robots' ids."""
        self.failed: frozenset[int] = frozenset()
        """Ids of the absent robots that have failed by heat."""

    def follow(self, step: Step) -> None:
        """Update from the message of a step."""
        message = step.latest(ROBOTS)
        if message is None:
            return
        present = np.array(list(message.present), dtype=bool)
        if present.all():
            self.present = None
        elif self.present is None or not np.array_equal(present, self.present):
            self.present = present
        self.arrivals = tuple(message.arrivals)
        found = enumerate(MISHAPS[number] for number in message.mishaps)
        self.mishaps = {robot_id: mishap for robot_id, mishap in found if mishap is not None}
        self.loads = {robot_id: name for robot_id, name in enumerate(message.loads) if name}
        if message.failed_by_heat or self.failed:
            self.failed = frozenset(i for i, has_failed in enumerate(message.failed_by_heat) if has_failed)

    def is_present(self, robot_id: int) -> bool:
        """Whether a robot is present."""
        return self.present is None or bool(self.present[robot_id])

"""Which robots are present, as the world reports it."""

import numpy as np

from robotteamsim.msg import Robots
from robotteamsim.ros.transport.synchronizer import Channel, Step
from robotteamsim.ros.transport.topics import Input

ROBOTS = "/world/robots"
PRESENCE = Input(Channel(ROBOTS, has_presence=True), Robots)
"""Which robots are present; in a world that does not report it, all are."""


class Presence:
    """Which robots are present, by the world's last report."""

    def __init__(self) -> None:
        self.present: np.ndarray | None = None
        """Whether each robot is present, bool, shape (n,); None: all are. The same object until that changes."""
        self.arrivals: tuple[int, ...] | None = None
        """How often each has arrived; None: not reported so far."""

    def follow(self, step: Step) -> None:
        """Take in the report of a step."""
        message = step.latest(ROBOTS)
        if message is None:
            return
        present = np.array(list(message.present), dtype=bool)
        if present.all():
            self.present = None
        elif self.present is None or not np.array_equal(present, self.present):
            self.present = present
        self.arrivals = tuple(message.arrivals)

    def is_present(self, robot_id: int) -> bool:
        """Whether a robot is present."""
        return self.present is None or bool(self.present[robot_id])

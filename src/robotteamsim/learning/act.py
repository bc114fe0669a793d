"""What the policy of one robot decides, as an action."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.spaces import Box, Discrete, Space

from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import EVERYBODY, Decision, Message
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.observe import Said
from robotteamsim.scenario.drives import CarDrive, OmniDrive
from robotteamsim.setup import Setup


class Act:
    """Continuous actions, float32 within [-1, 1]: speed / max_speed_mps, turn / max_turn_radps, and what is said.

    An omnidirectional robot has the speed to the left, too, after that ahead. Each decision sends a message with the
    robot's position and these numbers to everybody; it travels over the simulated network, and can be lost.
    A subclass replaces `space` and `twist`.
    """

    space: Space[Any]

    def __init__(self, setup: Setup, robot_id: int, said: int = 0) -> None:
        """Args: said: how many numbers each message has."""
        self.robot_id, self.said = robot_id, said
        self.drive = setup.robots[robot_id].drive
        self._moves = 3 if isinstance(self.drive, OmniDrive) else 2
        self.space = Box(-1.0, 1.0, (self._moves + said,), np.float32)

    def twist(self, action: Any) -> Twist:
        """Return the command of an action."""
        ahead, *left, turn = (float(number) for number in action[: self._moves])
        speed = self.drive.max_speed_mps
        return Twist(ahead * speed, left[0] * speed if left else 0.0, turn * self.drive.max_turn_radps)

    def words(self, action: Any) -> tuple[float, ...]:
        """Return the numbers that an action says."""
        return tuple(float(number) for number in action[self._moves :]) if self.said else ()

    def info(self) -> dict[str, Any]:
        """Return the `info` of an agent: what it may know that is not in its observation."""
        return {}

    def decision(self, action: Any, pose: Pose) -> Decision:
        """Return the decision of an action; nothing is clipped. Raises: LearningError: it is not of the space."""
        self.check(action)
        said = Said((pose.x_m, pose.y_m), self.words(action))
        return Decision(self.twist(action), (Message(self.robot_id, EVERYBODY, said.to_payload()),))

    def check(self, action: Any) -> None:
        """Raises: LearningError: an action is not of the space."""
        try:
            value = np.asarray(action)
        except ValueError:  # rows of different lengths
            value = np.asarray(None)
        kinds = "iu" if isinstance(self.space, Discrete) else "fiu"
        is_of_space = value.dtype.kind in kinds and bool(np.isfinite(value).all())
        if not is_of_space or not self.space.contains(value.astype(self.space.dtype)):
            raise LearningError(f"robot_{self.robot_id}: action {action!r:.80}: expected one of {self.space}")


class DiscreteAct(Act):
    """Five actions: stand, ahead, ahead to the left, ahead to the right, turn on the spot.

    A car cannot turn on the spot: `info` has a mask that says so. Nothing is said but the position.
    """

    MOVES = ((0.0, 0.0), (1.0, 0.0), (0.7, 0.5), (0.7, -0.5), (0.0, 1.0))
    """Speed and turn of each, as shares of the largest."""

    def __init__(self, setup: Setup, robot_id: int, said: int = 0) -> None:
        """Raises: LearningError: messages with numbers need continuous actions."""
        super().__init__(setup, robot_id)
        if said:
            raise LearningError(f"said: {said}; expected 0 with DiscreteAct")
        self.space = Discrete(len(self.MOVES))

    def twist(self, action: Any) -> Twist:
        """Return the command of an action."""
        speed, turn = self.MOVES[int(action)]
        return Twist(speed * self.drive.max_speed_mps, 0.0, turn * self.drive.max_turn_radps)

    def info(self) -> dict[str, Any]:
        """Return `action_mask`: which actions have an effect of their own, int8, as Gymnasium's masks."""
        on_the_spot = not isinstance(self.drive, CarDrive)
        mask = [speed != 0.0 or turn == 0.0 or on_the_spot for speed, turn in self.MOVES]
        return {"action_mask": np.array(mask, np.int8)}

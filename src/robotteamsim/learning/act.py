"""What the policy of each robot decides, as an action."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box, Discrete

from robotteamsim.geometry import Twist
from robotteamsim.interface import EVERYBODY, Decision, Message
from robotteamsim.learning.arrays import array_of, numbers_of, shown
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.senses import Said
from robotteamsim.scenario.drives import CarDrive, OmniDrive
from robotteamsim.setup import Setup


class Commands(NamedTuple):
    """What n agents are to do. Stacked missions have one more axis in front.

    twists: ahead and to the left [m/s], turn [rad/s], shape (n, 3).
    say:    the numbers that each says to the others, shape (n, said).
    """

    twists: np.ndarray
    say: np.ndarray

    def of(self, mission: int) -> Commands:
        """Return those of one of several missions."""
        return Commands(self.twists[mission], self.say[mission])

    def decisions(self, robot_ids: Sequence[int], positions_m: np.ndarray) -> list[Decision]:
        """Return the decisions of the agents, whose messages have their positions in `map` as they know them [m]."""
        team = zip(robot_ids, self.twists.tolist(), self.say.tolist(), positions_m.tolist(), strict=True)
        return [
            Decision(Twist(*twist), (Message(i, EVERYBODY, Said((x_m, y_m), tuple(say)).to_json()),))
            for i, twist, say, (x_m, y_m) in team
        ]


class Act:
    """Continuous actions, float32 within [-1, 1]: speed / max_speed_mps, turn / max_turn_radps, and what is said.

    If there is an omnidirectional robot, all have the speed to the left, too, after that ahead; other robots cannot
    follow it. Each decision sends a message with the robot's position and these numbers to everybody; it travels over
    the simulated network, and can be lost. A subclass replaces `space`, a `Box` or `Discrete`, `twists`, and, if its
    numbers are others, `say`.
    """

    space: Box | Discrete[Any]

    def __init__(self, setup: Setup, robot_ids: Sequence[int], said: int = 0) -> None:
        """Args: robot_ids: of the agents.  said: how many numbers each message has."""
        self.robot_ids, self.said = tuple(robot_ids), said
        self.drives = [setup.robots[i].drive for i in robot_ids]
        self.max_speeds_mps = np.array([drive.max_speed_mps for drive in self.drives])
        self.max_turns_radps = np.array([drive.max_turn_radps for drive in self.drives])
        self._moves = 3 if any(isinstance(robot.drive, OmniDrive) for robot in setup.robots) else 2
        self.space = Box(-1.0, 1.0, (self._moves + said,), np.float32)

    @property
    def rest(self) -> np.ndarray:
        """The action for absent agents."""
        return np.zeros(self.space.shape or (), self.space.dtype)

    def twists(self, actions: np.ndarray) -> np.ndarray:
        """Return the twists of actions, as of `Commands`.

        Args: actions: one per agent, also of stacked missions: float64; int64 if the space is discrete.
        """
        twists = np.zeros((*actions.shape[:-1], 3))
        twists[..., : self._moves - 1] = actions[..., : self._moves - 1] * self.max_speeds_mps[:, None]
        twists[..., 2] = actions[..., self._moves - 1] * self.max_turns_radps
        return twists

    def say(self, actions: np.ndarray) -> np.ndarray:
        """Return what actions say, within [-1, 1], as of `Commands`. Not called if nothing is said.

        Args: actions: as of `twists`.
        """
        return actions[..., self._moves :]

    def infos(self) -> list[dict[str, Any]]:
        """Return the `info` of each agent: what it may know that is not in its observation."""
        return [{} for _ in self.robot_ids]

    def commands(self, actions: Any) -> Commands:
        """Return what actions mean; nothing is clipped.

        Args:   actions: one per agent; or an array of those of stacked missions.
        Raises: LearningError: one is not of the space, or `twists` or `say` returns something else than it says.
        """
        values = array_of(actions)
        if not self._are_of_space(values, len(self.robot_ids)):
            for robot_id, action in zip(self.robot_ids, actions, strict=False):
                if not self._are_of_space(array_of([action]), 1):
                    raise LearningError(f"robot_{robot_id}: action {action!r:.80}: expected one of {self.space}")
            raise LearningError(
                f"actions of shape {values.shape}; expected one for each of {len(self.robot_ids)} robots"
            )
        values = values.astype(np.int64 if isinstance(self.space, Discrete) else np.float64)
        rows = values.shape[: values.ndim - len(self.space.shape or ())]
        said = numbers_of("say", self.say(values), (*rows, self.said)) if self.said else np.zeros((*rows, 0))
        if (np.abs(said) > 1.0).any():
            raise LearningError(f"say: {shown(said)}; expected numbers within [-1, 1]")
        return Commands(numbers_of("twists", self.twists(values), (*rows, 3)), said)

    def _are_of_space(self, values: np.ndarray, agents: int) -> bool:
        """Whether values are actions for so many agents, also of stacked missions."""
        space, shape = self.space, (agents, *(self.space.shape or ()))
        kinds, low, high = ("iu", 0, space.n - 1) if isinstance(space, Discrete) else ("fiu", space.low, space.high)
        if values.dtype.kind not in kinds or values.shape[-len(shape) :] != shape:
            return False
        values = values.astype(space.dtype)
        return bool(((values >= low) & (values <= high)).all())  # NaN is not


class DiscreteAct(Act):
    """Five actions: stand, ahead, ahead to the left, ahead to the right, turn on the spot.

    A car cannot turn on the spot: `infos` have a mask that says so. Nothing is said but the position.
    """

    MOVES = np.array(((0.0, 0.0), (1.0, 0.0), (0.7, 0.5), (0.7, -0.5), (0.0, 1.0)))
    """Speed and turn of each, as shares of the largest."""

    def __init__(self, setup: Setup, robot_ids: Sequence[int], said: int = 0) -> None:
        """Raises: LearningError: messages with numbers need continuous actions."""
        super().__init__(setup, robot_ids)
        if said:
            raise LearningError(f"said: {said}; expected 0 with DiscreteAct")
        self.space = Discrete(len(self.MOVES))

    def twists(self, actions: np.ndarray) -> np.ndarray:
        """Return the twists of actions, as of `Commands`."""
        return super().twists(np.insert(self.MOVES[actions], 1, 0.0, -1) if self._moves == 3 else self.MOVES[actions])

    def infos(self) -> list[dict[str, Any]]:
        """Return `action_mask` of each agent: which actions have an effect of their own, int8, as Gymnasium's masks."""
        turns_in_place = (self.MOVES[:, 0] == 0.0) & (self.MOVES[:, 1] != 0.0)
        cars = [isinstance(drive, CarDrive) for drive in self.drives]
        return [{"action_mask": (~(turns_in_place & is_car)).astype(np.int8)} for is_car in cars]

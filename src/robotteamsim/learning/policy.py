"""A learned policy as a controller: `control.algorithm: my_policy:Policy`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np

from robotteamsim.interface import Decision, Message, Observation, Task
from robotteamsim.learning.act import Act
from robotteamsim.learning.observe import Observe
from robotteamsim.learning.rules import Rules
from robotteamsim.learning.senses import Senses
from robotteamsim.setup import Setup


class PolicyController:
    """Drives a robot by a policy, wherever controllers run: headless, in campaigns, in ROS, in MuJoCo.

    A subclass defines `choose`. Its other attributes are those that it was trained with: the same observations, to the
    bit, reach it here.
    """

    observe: type[Observe] = Observe
    act: type[Act] = Act
    every = 5
    """It decides in each so many steps, and holds the command in between."""
    said = 0
    """How many numbers each message has."""
    teammates: int | None = None
    """How many teammates its observations have room for; None: as many as there are."""

    def __init__(self, robot_id: int, setup: Setup) -> None:
        """Make the controller of a robot. Raises: LearningError: an attribute is out of range."""
        Rules.of({key: getattr(self, key) for key in ("observe", "act", "every", "said", "teammates")})
        self._observe = self.observe(setup, [robot_id], self.said, self.teammates)
        self._act = self.act(setup, [robot_id], self.said)
        self._senses = Senses(setup, self._observe)
        self._senses.begin(0, setup)
        self._steps = 0
        self._held = Decision()

    def choose(self, vector: np.ndarray) -> Any:
        """Return the action for an observation."""
        raise NotImplementedError("a policy defines choose(vector)")

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """As for all controllers."""
        self._senses.note(0, observation.sim_time_ns, [inbox], [observation.robot])
        if not task.running:
            self._steps = 0
            return Decision()
        decision = self._held
        if self._steps % self.every == 0:
            self._senses.perceive_each(0, [observation], task, observation.sim_time_ns)
            action = self.choose(self._senses.vectors(np.array([[True]]))[0, 0])
            commands = self._act.commands([action])
            (decision,) = commands.decisions(self._act.robot_ids, self._senses.percepts.poses[0, :, :2])
            self._held = msgspec.structs.replace(decision, outbox=())
        self._steps += 1
        return decision

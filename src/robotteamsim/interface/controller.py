"""The protocol of every controller: observation and messages in, decision out."""

from collections.abc import Sequence
from typing import Protocol

from robotteamsim.interface.decision import Decision
from robotteamsim.interface.observation import Observation
from robotteamsim.interface.task import Task
from robotteamsim.network.messages import Message


class Controller(Protocol):
    """One robot's controller: created at the start of a trial and when the robot comes back, called in each step."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and the messages of this step.

        Args: inbox: the messages that arrived.  task: the mission's.
        """

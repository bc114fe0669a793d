"""The protocol of every controller: observation and messages in, decision out."""

from collections.abc import Sequence
from typing import Protocol

from robotteamsim.interface.decision import Decision
from robotteamsim.interface.observation import Observation
from robotteamsim.interface.task import Task
from robotteamsim.network.messages import Message


class Controller(Protocol):
    """One robot's controller: built at the start of a trial and whenever the robot returns, stepped once per step."""

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Take in what the robot perceives, the messages that arrived, and the mission's task."""

    def decide(self) -> Decision:
        """Return command and messages for this step."""

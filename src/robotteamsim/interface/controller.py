"""The protocol of every controller: what it perceives and receives in, its decision out."""

from collections.abc import Sequence
from typing import Protocol

import msgspec

from robotteamsim.interface.decision import Decision
from robotteamsim.interface.task import Task
from robotteamsim.network.messages import Message
from robotteamsim.sensing.readings import RobotReading, VoiceReading


class Observation(msgspec.Struct, frozen=True, eq=False):
    """Everything that one controller perceives in one step; sim_time_ns is the stamp of all parts."""

    robot_id: int
    sim_time_ns: int
    robot: RobotReading
    voice: VoiceReading


class Controller(Protocol):
    """One robot's controller: created at the start of a trial and when the robot comes back, called in each step."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and the messages of this step.

        Args: inbox: the messages that arrived.  task: the mission's.
        """

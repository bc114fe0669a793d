"""The protocol of every controller: what it perceives and receives in, its decision out."""

from collections.abc import Sequence
from typing import Protocol

import msgspec

from robotteamsim.geometry import Pose
from robotteamsim.interface.decision import Decision
from robotteamsim.interface.task import Task
from robotteamsim.network.messages import Message
from robotteamsim.sensing.readings import RobotReading, VoiceReading


class Observation(msgspec.Struct, frozen=True, eq=False):
    """Everything that one controller perceives in one step.

    sim_time_ns: stamp of all parts.
    own_pose:    where the robot believes that it is, in `map`; None: its true pose, see `control.localisation`.
    """

    robot_id: int
    sim_time_ns: int
    robot: RobotReading
    voice: VoiceReading
    own_pose: Pose | None = None

    @property
    def pose(self) -> Pose:
        """The pose in `map` that the robot uses as its own."""
        return self.robot.true_pose if self.own_pose is None else self.own_pose


class Controller(Protocol):
    """One robot's controller: created at the start of a trial and when the robot comes back, called in each step."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and the messages of this step.

        Args: inbox: the messages that arrived.  task: the mission's.
        """

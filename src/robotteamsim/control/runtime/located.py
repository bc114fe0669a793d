"""Gives a controller the pose that its robot believes to have, in place of the true one."""

from collections.abc import Sequence

import msgspec

from robotteamsim.geometry import PoseReading
from robotteamsim.interface import Controller, Decision, Message, Observation, Task
from robotteamsim.maps.localiser import Localiser


class Located:
    """Runs a robot's controller, which learns of no other pose than that of the robot's localiser."""

    def __init__(self, controller: Controller, localiser: Localiser) -> None:
        self.controller = controller
        self._localiser = localiser

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision."""
        pose = self._localiser.pose(observation)
        robot = msgspec.structs.replace(observation.robot, ground_truth=PoseReading.from_pose(pose))
        return self.controller.step(msgspec.structs.replace(observation, robot=robot, own_pose=pose), inbox, task)

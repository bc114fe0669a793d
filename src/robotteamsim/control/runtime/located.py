"""Gives a controller the pose that its robot believes to have, in place of the true one."""

from collections.abc import Sequence

import msgspec

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.interface import Controller, Decision, Message, Observation, Task
from robotteamsim.maps.localiser import Localiser


class Located:
    """Runs a robot's controller, which learns of no other pose than that of the robot's localiser."""

    def __init__(self, controller: Controller, localiser: Localiser) -> None:
        self.controller = controller
        self._localiser = localiser

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision."""
        pose, true_pose, voice = self._localiser.pose(observation), observation.robot.true_pose, observation.voice
        # A robot hears where a voice is as seen from itself.
        loudest = pose @ true_pose.inverse() @ Pose(*voice.local_best_m, 0.0)
        believed = msgspec.structs.replace(
            observation,
            robot=msgspec.structs.replace(observation.robot, ground_truth=PoseReading.from_pose(pose)),
            voice=msgspec.structs.replace(voice, local_best_m=(loudest.x_m, loudest.y_m)),
            own_pose=pose,
        )
        return self.controller.step(believed, inbox, task)

"""What all robots sense, and tf as users of ROS 2 expect it: of the team, and in each robot's namespace."""

from __future__ import annotations

from typing import Any

import numpy as np

from robotteamsim.nodes.motion import TeamOdometry
from robotteamsim.nodes.node import Node
from robotteamsim.nodes.outputs import ORIGIN, TeamOutputs
from robotteamsim.nodes.settings import Settings
from robotteamsim.nodes.stage import Unprefixed
from robotteamsim.recording.topics import robots

_MOVING = ("odom", "base_footprint")
"""Child frames whose transforms change."""


class Ros2TeamOutputs(TeamOutputs):
    """As `TeamOutputs`, and for each robot `tf` and `tf_static` without prefix: nav2 looks for base_link there."""

    def __init__(self, node: Node, settings: Settings, *, localized: bool) -> None:
        """As for all outputs of a team."""
        super().__init__(node, settings, localized=localized)
        self._own_make = {i: Unprefixed(node.make, i) for i in self._here}
        names = {i: settings.robot_topic(i, "tf") for i in self._here if settings.prefix}
        self._own_tf = {i: node.output(name, robots.TF.type_name) for i, name in names.items()}
        for i in self._own_tf:
            links = robots.robot_transforms(self._own_make[i], 0, i, self._models[i], ORIGIN)
            fixed = [link for link in links if link.child_frame_id not in _MOVING]
            output = node.output(settings.robot_topic(i, "tf_static"), robots.TF.type_name, latched=True)
            output.publish(self._make(robots.TF.type_name, transforms=fixed))

    def _publish_tf(self, time_ns: int, odometry: TeamOdometry, present: np.ndarray) -> None:
        super()._publish_tf(time_ns, odometry, present)
        readings: list[Any] | None = None
        for i, output in self._own_tf.items():
            if present[i] and output.wanted:
                readings = odometry.readings() if readings is None else readings
                links = self._links(self._own_make[i], time_ns, i, readings[i])
                moving = [link for link in links if link.child_frame_id in _MOVING]
                output.publish(self._make(robots.TF.type_name, transforms=moving))

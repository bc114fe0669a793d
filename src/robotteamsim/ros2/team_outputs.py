"""What all robots sense, and tf as users of ROS 2 expect it: of the team, and in each robot's namespace."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from robotteamsim.message_parts import RosMessage
from robotteamsim.nodes.node import Node
from robotteamsim.nodes.outputs import AT_ORIGIN, TeamOutputs
from robotteamsim.nodes.settings import Settings
from robotteamsim.nodes.stage import unprefixed
from robotteamsim.recording.topics import robots

_MOVING = ("odom", "base_footprint")
"""Child frames whose transforms change."""


class Ros2TeamOutputs(TeamOutputs):
    """As `TeamOutputs`, and for each robot `tf` and `tf_static` without prefix: nav2 looks for base_link there."""

    def __init__(self, node: Node, settings: Settings, *, localized: bool) -> None:
        """As for all outputs of a team."""
        super().__init__(node, settings, localized=localized)
        names = {i: settings.robot_topic(i, "tf") for i in self._here if settings.prefix}
        self._own_tf = {i: node.output(name, robots.TF.type_name) for i, name in names.items()}
        for i in self._own_tf:
            links = robots.robot_transforms(0, i, self._models[i], AT_ORIGIN)
            fixed = [link for link in _own(links, i) if link["child_frame_id"] not in _MOVING]
            output = node.output(settings.robot_topic(i, "tf_static"), robots.TF.type_name, latched=True)
            output.publish({"transforms": fixed})

    def _publish_tf(self, step: Any) -> None:
        super()._publish_tf(step)
        for i, output in self._own_tf.items():
            if step.present[i] and output.wanted:
                links = self._links(step, i)
                moving = [link for link in _own(links, i) if link["child_frame_id"] in _MOVING]
                output.publish({"transforms": moving})


def _own(links: Sequence[RosMessage], robot_id: int) -> list[RosMessage]:
    """Return the transforms of a robot as they are in its namespace."""
    return [unprefixed(link, robot_id) for link in links]

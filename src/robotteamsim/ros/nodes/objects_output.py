"""The poses of boxes and barrels, for current and later subscribers."""

from __future__ import annotations

from collections.abc import Sequence

from visualization_msgs.msg import MarkerArray

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.objects import object_markers
from robotteamsim.ros.transport.topics import Output
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.world import World


class ObjectsOutput:
    """The topic `/world/objects`; it is latched, so objects at rest are published once."""

    def __init__(self) -> None:
        self._output = Output("/world/objects", MarkerArray, latched=True)
        self._objects: tuple[MovableObject, ...] = ()
        self._poses: Sequence[Pose] = ()

    def show(self, world: World) -> None:
        """Publish all objects, unless nothing has changed. The world must not be changed meanwhile."""
        objects, poses = world.object_models(), tuple(world.objects().values())
        if (objects, poses) == (self._objects, self._poses):
            return
        self._output.publish(object_markers(objects, poses, replace=objects != self._objects))
        self._objects, self._poses = objects, poses

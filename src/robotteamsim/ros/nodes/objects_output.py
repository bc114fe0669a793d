"""Where boxes and barrels are, for subscribers of now and later."""

from __future__ import annotations

from collections.abc import Sequence

from visualization_msgs.msg import MarkerArray

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.objects import thing_markers
from robotteamsim.ros.transport.topics import Output
from robotteamsim.scenario.things import Thing
from robotteamsim.world import World


class ThingsOutput:
    """The topic `/world/things`; latched, so what stands still is published once."""

    def __init__(self) -> None:
        self._output = Output("/world/things", MarkerArray, latched=True)
        self._things: tuple[Thing, ...] = ()
        self._poses: Sequence[Pose] = ()

    def show(self, world: World) -> None:
        """Publish all things, unless nothing has changed. Nobody may change the world meanwhile."""
        things, poses = world.thing_models(), tuple(world.things().values())
        if (things, poses) == (self._things, self._poses):
            return
        self._output.publish(thing_markers(things, poses, anew=things != self._things))
        self._things, self._poses = things, poses

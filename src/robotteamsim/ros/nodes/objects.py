"""Boxes and barrels: their poses, for current and later subscribers, and requests to add or move them."""

from collections.abc import Sequence
from typing import Any

from visualization_msgs.msg import MarkerArray

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.objects import object_markers
from robotteamsim.ros.transport.topics import Output
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.problems import checked
from robotteamsim.srv import SetObjectRequest
from robotteamsim.world.contract import AnyWorld


class ObjectsOutput:
    """The topic `/world/objects`; it is latched, so objects at rest are published once."""

    def __init__(self) -> None:
        self._output = Output("/world/objects", MarkerArray, latched=True)
        self._objects: tuple[MovableObject, ...] = ()
        self._poses: Sequence[Pose] = ()

    def show(self, world: AnyWorld) -> None:
        """Publish all objects, unless nothing has changed. The world must not be changed meanwhile."""
        objects, poses = world.object_models(), tuple(world.objects().values())
        if (objects, poses) == (self._objects, self._poses):
            return
        self._output.publish(object_markers(objects, poses, replace=objects != self._objects))
        self._objects, self._poses = objects, poses


def set_object(world: AnyWorld, request: SetObjectRequest) -> None:
    """Add an object to a world, or move one.

    Raises: PlacementError: there is no room. ValueError: no such object, its name is taken, or values are invalid.
    """
    pose = Pose(request.pose.x, request.pose.y, request.pose.theta)
    if request.kind:
        world.add_object(_object(request, pose))
    else:
        world.move_object(request.name, pose)


def _object(request: SetObjectRequest, pose: Pose) -> MovableObject:
    size_m = (request.length_m, request.width_m)
    values: dict[str, Any] = {"name": request.name, "kind": request.kind, "pose": (pose.x_m, pose.y_m, pose.yaw_rad)}
    values |= {"size_m": size_m if any(size_m) else None, "radius_m": request.radius_m or None}
    # 0 in a request means the default.
    values |= {key: value for key in ("height_m", "mass_kg", "friction") if (value := getattr(request, key))}
    return checked(MovableObject, values, ValueError)

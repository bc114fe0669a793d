"""The values in requests."""

from typing import Any

from robotteamsim.geometry import Pose
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.problems import checked
from robotteamsim.srv import SetObjectRequest
from robotteamsim.world.contract import AnyWorld


def pose_of(request: Any) -> Pose:
    """Return the pose in a request."""
    return Pose(request.pose.x, request.pose.y, request.pose.theta)


def set_object(world: AnyWorld, request: SetObjectRequest) -> None:
    """Add an object to a world, or move one.

    Raises: PlacementError: there is no room. ValueError: no such object, its name is taken, or values are invalid.
    """
    pose = pose_of(request)
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

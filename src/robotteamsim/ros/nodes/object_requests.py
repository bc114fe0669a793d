"""Requests to add or move objects."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from robotteamsim.geometry import Pose
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.problems import problems
from robotteamsim.srv import SetObjectRequest
from robotteamsim.world import World


def set_object(world: World, request: SetObjectRequest) -> None:
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
    try:
        return MovableObject.model_validate(values)
    except ValidationError as error:
        raise ValueError(str(problems(error, MovableObject)[0])) from None

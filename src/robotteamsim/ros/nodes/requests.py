"""Checks of requests, and the values in them."""

from typing import Any

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.sections import Mission, Victim, Voice
from robotteamsim.srv import SetObjectRequest
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.placement import check_mission


def check_noise(noise_db: float) -> None:
    """Raises: ValueError: the background noise [dB] is out of range."""
    # The scenario's model has the range.
    checked(Voice, {"noise_db": noise_db}, ValueError)


def check_victim(scenario: Scenario, name: str, position_m: tuple[float, float]) -> None:
    """Raises: ValueError: a victim cannot have this name or be at this place [m, map]."""
    try:
        victim = checked(Victim, {"name": name, "position": position_m}, ValueError)
        check_mission(scenario.plan, Mission(victims=(victim,)))
    except (ValueError, PlacementError) as error:
        # This victim is the only one of the mission above.
        problem = str(error).removeprefix("mission.victims.0.")
        raise ValueError(f"set_victim: {name}: {problem}") from None


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

"""Requests that change a simulation, by the names of their services: `set_pose` is of type `SetPose`.

A request is any object with the attributes of its .srv file.
"""

from collections.abc import Callable, Mapping
from typing import Any

from robotteamsim.geometry import Pose
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.problems import checked
from robotteamsim.simulation import Simulation

Change = Callable[[Simulation, Any], None]
"""Raises: ValueError, RobotTeamSimError: the request cannot be carried out."""


def pose_of(request: Any) -> Pose:
    """Return the pose in a request."""
    return Pose(request.pose.x, request.pose.y, request.pose.theta)


def _position_m(request: Any) -> tuple[float, float]:
    return request.position.x, request.position.y


def _set_object(simulation: Simulation, request: Any) -> None:
    """Add an object, or move one."""
    pose = pose_of(request)
    if not request.kind:
        simulation.world.move_object(request.name, pose)
        return
    size_m = (request.length_m, request.width_m)
    values: dict[str, Any] = {"name": request.name, "kind": request.kind, "pose": (pose.x_m, pose.y_m, pose.yaw_rad)}
    values |= {"size_m": size_m if any(size_m) else None, "radius_m": request.radius_m or None}
    # 0 in a request means the default.
    values |= {key: value for key in ("height_m", "mass_kg", "friction") if (value := getattr(request, key))}
    try:
        added = checked(MovableObject, values, ValueError)
    except ValueError as error:
        raise ValueError(str(error).replace("size_m", "length_m, width_m")) from None
    simulation.world.add_object(added)


CHANGES: Mapping[str, Change] = {
    "remove_robot": lambda simulation, request: simulation.remove_robot(request.robot_id),
    "set_noise": lambda simulation, request: simulation.set_noise_db(request.noise_db),
    "set_victim": lambda simulation, request: simulation.set_victim(request.name, _position_m(request)),
}
CHANGES_OF_BODIES: Mapping[str, Change] = {
    "set_pose": lambda simulation, request: simulation.world.set_pose(request.robot_id, pose_of(request)),
    "set_object": _set_object,
    "remove_object": lambda simulation, request: simulation.world.remove_object(request.name),
    "lift_object": lambda simulation, request: simulation.lift_object(request.robot_id, request.name),
    "drop_object": lambda simulation, request: simulation.drop_object(request.robot_id),
    "take_passage": lambda simulation, request: simulation.take_passage(request.robot_id, request.level),
    "set_light": lambda simulation, request: simulation.set_light(request.name, request.lit),
    "ignite": lambda simulation, request: simulation.ignite(_position_m(request)),
}
"""Changes of what another world would have itself."""

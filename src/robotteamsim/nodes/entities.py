"""Robots, objects and victims by their names, as services see them that treat all alike."""

from __future__ import annotations

from typing import Literal, NamedTuple

from robotteamsim.geometry import Pose, Twist
from robotteamsim.message_parts import robot_name
from robotteamsim.simulation import Simulation


class Entity(NamedTuple):
    """A robot that is present, an object or a victim.

    pose: in `map`.  twist: in its own frame; 0 for objects.  reach_m: radius of a circle around it.
    """

    kind: Literal["robot", "object", "victim"]
    pose: Pose
    twist: Twist = Twist()
    reach_m: float = 0.0


def robot_names(simulation: Simulation) -> list[str]:
    """Return the names of all robots in the order of their ids, also of absent ones."""
    return [robot_name(robot_id) for robot_id in range(simulation.world.num_robots)]


def entities(simulation: Simulation) -> dict[str, Entity]:
    """Return all entities by name: victims, objects, robots. Of several with one name, it has the last."""
    world = simulation.world
    found = {victim.name: Entity("victim", Pose(*victim.position, 0.0)) for victim in simulation.mission.victims}
    for obj, pose in zip(*world.object_states(), strict=True):
        found[obj.name] = Entity("object", pose, reach_m=obj.reach_m)
    poses, twists = world.poses(), world.twists()
    for robot_id, name in enumerate(robot_names(simulation)):
        if world.present[robot_id]:
            reach_m = simulation.setup.robots[robot_id].reach_m
            found[name] = Entity("robot", poses[robot_id], twists[robot_id], reach_m)
    return found


def move_entity(simulation: Simulation, name: str, pose: Pose) -> None:
    """Move an entity, at rest; a victim has no yaw. Raises: KeyError: no such entity. ValueError, PlacementError."""
    kind = entities(simulation)[name].kind
    if kind == "robot":
        simulation.world.set_pose(robot_names(simulation).index(name), pose)
    elif kind == "object":
        simulation.world.move_object(name, pose)
    else:
        simulation.set_victim(name, (pose.x_m, pose.y_m))


def remove_entity(simulation: Simulation, name: str) -> None:
    """Remove a robot or an object. Raises: KeyError: no such entity. ValueError: it is a victim."""
    kind = entities(simulation)[name].kind
    if kind == "robot":
        simulation.remove_robot(robot_names(simulation).index(name))
    elif kind == "object":
        simulation.world.remove_object(name)
    else:
        raise ValueError(f"{name} is a victim; expected a robot or an object")

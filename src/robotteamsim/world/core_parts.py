"""Parts of the C++ world from models of the scenario."""

from __future__ import annotations

import functools

import shapely

from robotteamsim import _core
from robotteamsim.geometry import Pose
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import Solid, door_corners, solids
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.world.pieces import convex_pieces


@functools.lru_cache(maxsize=16)
def still_solids(plan: FloorPlan) -> tuple[tuple[Solid, ...], shapely.STRtree]:
    """Return the solids of a plan without doors, and their polygons as a tree; worlds of the same plan share them."""
    still = solids(plan.model_copy(update={"doors": ()}))
    return still, shapely.STRtree([solid.polygon for solid in still])


@functools.lru_cache(maxsize=16)
def core_solids(plan: FloorPlan) -> tuple[list[_core.world.Solid], list[_core.world.Door]]:
    """Return the solids and the doors of a plan; worlds of the same plan share the lists, so do not change them."""
    still, _ = still_solids(plan)
    pieces = [_core.world.Solid(solid.corners, convex_pieces(solid.corners)) for solid in still]
    return pieces, [core_door(door) for door in plan.doors]


def core_door(door: Door) -> _core.world.Door:
    """Return a door."""
    leaf = door_corners(door)
    return _core.world.Door(
        _core.world.Solid(leaf, convex_pieces(leaf)),
        door.closed,
        time_s=door.leaf_time_s,
        angle_rad=door.leaf_angle_rad,
        shift_m=door.leaf_shift_m,
        hinge_m=door.start,
    )


def core_robot(robot: PlacedRobot) -> _core.world.Robot:
    """Return a robot at its start pose."""
    return _core.world.Robot(
        radius_m=robot.radius_m,
        mass_kg=robot.mass_kg,
        drive=_core.world.Drive(**robot.drive.model_dump()),
        start=Pose(*robot.start_pose),
        footprint_m=robot.corners_m,
        present=robot.present,
    )


def core_object(obj: MovableObject) -> _core.world.MovableObject:
    """Return an object at its first pose."""
    return _core.world.MovableObject(
        radius_m=obj.reach_m,
        mass_kg=obj.mass_kg,
        friction=obj.friction,
        start=Pose(*obj.pose),
        corners_m=obj.corners_m,
    )

"""Parts of the C++ world from models of the scenario, with polygons in convex pieces, as Box2D requires."""

import functools

import shapely

from robotteamsim import _core
from robotteamsim.geometry import Pose
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import Corners, Solid, door_corners, footprints, solids
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors.base import Fan

MAX_CORNERS = 8
"""Box2D's limit for polygons."""

_MIN_AREA_M2 = 1e-9
"""Smaller triangles are rounding errors between collinear corners."""


@functools.lru_cache(maxsize=16)
def still_solids(plan: FloorPlan) -> tuple[tuple[Solid, ...], shapely.STRtree]:
    """Return the solids of a plan without doors, and their polygons as a tree; worlds of the same plan share them."""
    still = solids(plan.model_copy(update={"doors": ()}))
    return still, shapely.STRtree(footprints(still))


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
        drive=core_robot_drive(robot),
        start=Pose(*robot.start_pose),
        footprint_m=robot.corners_m,
        present=robot.present,
    )


def core_robot_drive(robot: PlacedRobot) -> _core.world.Drive:
    """Return the drive of a robot."""
    return _core.world.Drive(**robot.drive.model_dump())


def core_object(obj: MovableObject) -> _core.world.MovableObject:
    """Return an object at its first pose."""
    return _core.world.MovableObject(
        radius_m=obj.reach_m,
        mass_kg=obj.mass_kg,
        friction=obj.friction,
        start=Pose(*obj.pose),
        corners_m=obj.corners_m,
    )


def core_fan(fan: Fan) -> _core.world.Fan:
    """Return a fan in the plane."""
    return _core.world.Fan(
        beams=fan.beams,
        angle_min_rad=fan.angle_min_rad,
        angle_max_rad=fan.angle_max_rad,
        forward_m=fan.forward_m,
        left_m=fan.left_m,
        range_max_m=fan.range_max_m,
    )


def convex_pieces(corners: Corners) -> tuple[Corners, ...]:
    """Return convex polygons of at most eight corners whose union is a simple polygon.

    A convex polygon with few corners is returned as it is; any other is cut into the triangles of its constrained
    Delaunay triangulation. All corners are counter-clockwise [m].
    """
    if len(corners) <= MAX_CORNERS and _is_strictly_convex(corners):
        return (tuple(corners),)
    triangles = shapely.constrained_delaunay_triangles(shapely.Polygon(corners)).geoms
    return tuple(
        tuple(shapely.geometry.polygon.orient(triangle).exterior.coords[:-1])
        for triangle in triangles
        if triangle.area > _MIN_AREA_M2
    )


def _is_strictly_convex(corners: Corners) -> bool:
    turned = zip(corners, corners[1:] + corners[:1], corners[2:] + corners[:2], strict=True)
    return all((x1 - x0) * (y2 - y1) - (y1 - y0) * (x2 - x1) > 0.0 for (x0, y0), (x1, y1), (x2, y2) in turned)

"""Checks whether a robot or an object has room at a pose in the current state of a world."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, are_finite
from robotteamsim.scenario.body import Body
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import Solid
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.world.clearance import TOUCH_M
from robotteamsim.world.core_parts import still_solids
from robotteamsim.world.doors import DoorStates, leaf_outline


class Occupants(NamedTuple):
    """Everything in a world that moves.

    robot_poses:  of all robots in `map`, float64, shape (n, 3) [m, m, rad]; NaN where a robot is not present.
    objects:      each with its pose.
    """

    robot_poses: np.ndarray
    objects: Sequence[tuple[MovableObject, Pose]]
    doors: DoorStates


class FreeSpace:
    """The plan of a world and its team, for checks of poses against the current state.

    All checks raise PlacementError, which names the obstacle, or ValueError if the pose is not finite.
    """

    def __init__(self, plan: FloorPlan, robots: Sequence[PlacedRobot]) -> None:
        self._plan = plan
        self._robots = robots
        self._reaches_m = np.array([robot.reach_m for robot in robots])
        self._solids, self._shapes = still_solids(plan)

    def check_start_poses(self, doors: DoorStates) -> None:
        """Check the start poses of the robots that are present at the start."""
        placed = np.full((len(self._robots), 3), math.nan)
        for robot_id, robot in enumerate(self._robots):
            if robot.present:
                pose = Pose(*robot.start_pose)
                self.check_robot(robot_id, pose, Occupants(placed, (), doors), "start pose")
                placed[robot_id] = pose.x_m, pose.y_m, pose.yaw_rad

    def check_robot(self, robot_id: int, pose: Pose, others: Occupants, what: str = "pose") -> None:
        """Check a pose for a robot, regardless of its current one; `what` is the name of the pose in messages."""
        robot, name = self._robots[robot_id], f"robot_{robot_id}: {what}"
        clearance = "" if robot.footprint_m else f"; expected {robot.radius_m:g} m of clearance"
        body = self._body_at(robot, name, pose, others.doors, clearance)
        self._check_other_robots(robot_id, pose, body, others.robot_poses, _place(name, pose))
        _check_objects(body, _place(name, pose), others.objects)

    def check_object(self, obj: MovableObject, pose: Pose, others: Occupants) -> None:
        """Check a pose for an object, regardless of its current one."""
        name = f"{obj.kind} '{obj.name}': pose"
        body = self._body_at(obj, name, pose, others.doors)
        _check_objects(body, _place(name, pose), [(o, at) for o, at in others.objects if o.name != obj.name])
        for robot_id, (x_m, y_m, yaw_rad) in enumerate(others.robot_poses.tolist()):
            robot = self._robots[robot_id]
            is_near = math.dist((pose.x_m, pose.y_m), (x_m, y_m)) < obj.reach_m + robot.reach_m
            if is_near and body.overlaps(robot.body_at((x_m, y_m, yaw_rad)), TOUCH_M):
                raise PlacementError(f"{_place(name, pose)} is inside robot_{robot_id}")

    def check_reach(self, name: str, robot: Body, thing: str, body: Body, reach_m: float, doors: DoorStates) -> None:
        """Check that a robot reaches an object, with no wall or leaf between them. Raises: ValueError."""
        line = shapely.shortest_line(robot.core, body.core)
        distance_m = max(line.length - robot.margin_m - body.margin_m, 0.0)
        if distance_m > reach_m:
            raise ValueError(f"{name}: {thing} is {distance_m:.2f} m away; expected at most {reach_m:g} m")
        hit = self._solid_in(Body(line, 2.0 * TOUCH_M), doors)
        if hit is not None:
            raise ValueError(f"{name}: {thing} is behind {hit.kind} '{hit.name}'")

    def _body_at(
        self, thing: PlacedRobot | MovableObject, name: str, pose: Pose, doors: DoorStates, clearance: str = ""
    ) -> Body:
        """Return a body at a pose, inside the plan and clear of solids and leaves."""
        if not isinstance(pose, Pose):
            raise ValueError(f"{name}: {pose!r:.60}; expected a Pose")
        if not are_finite(pose.x_m, pose.y_m, pose.yaw_rad):
            raise ValueError(f"{name} must be finite, got {pose}")
        if not self._plan.bounds.contains((pose.x_m, pose.y_m)):
            raise PlacementError(f"{_place(name, pose)} is outside the plan, {self._plan.bounds}")
        body = thing.body_at((pose.x_m, pose.y_m, pose.yaw_rad))
        hit = self._solid_in(body, doors)
        if hit is not None:
            raise PlacementError(f"{_place(name, pose)} is inside {hit.kind} '{hit.name}'{clearance}")
        return body

    def _check_other_robots(self, robot_id: int, pose: Pose, body: Body, poses: np.ndarray, place: str) -> None:
        robot = self._robots[robot_id]
        apart_m = self._reaches_m + (robot.reach_m - TOUCH_M)
        near = np.hypot(*(poses[:, :2] - (pose.x_m, pose.y_m)).T) < apart_m
        near[robot_id] = False
        for other_id in np.flatnonzero(near).tolist():
            other, (x_m, y_m, yaw_rad) = self._robots[other_id], poses[other_id].tolist()
            if robot.footprint_m or other.footprint_m:
                if not body.overlaps(other.body_at((x_m, y_m, yaw_rad)), TOUCH_M):
                    continue
                distance = ""
            else:
                distance = f"; expected {robot.radius_m + other.radius_m:g} m between them"
            raise PlacementError(f"{place} is inside robot_{other_id} at ({x_m:.2f}, {y_m:.2f}){distance}")

    def _solid_in(self, body: Body, doors: DoorStates) -> Solid | None:
        """Return a solid, or a leaf at its current position, that a body overlaps; None if there is none."""
        near = self._shapes.query(body.core, predicate="dwithin", distance=body.margin_m - TOUCH_M)
        if len(near):
            return self._solids[int(min(near))]
        for door in self._plan.doors:
            corners = leaf_outline(door, doors[door.name])
            if corners is not None:
                leaf = Solid(door.name, "door", corners, door)
                if body.overlaps_shape(leaf.polygon, TOUCH_M):
                    return leaf
        return None


def _place(name: str, pose: Pose) -> str:
    return f"{name} ({pose.x_m:.2f}, {pose.y_m:.2f})"


def _check_objects(body: Body, place: str, objects: Sequence[tuple[MovableObject, Pose]]) -> None:
    for obj, at in objects:
        if body.overlaps(obj.body_at((at.x_m, at.y_m, at.yaw_rad)), TOUCH_M):
            raise PlacementError(f"{place} is inside {obj.kind} '{obj.name}'")

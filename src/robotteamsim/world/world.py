"""What is true: where robots are, what they run into, which doors are closed, what time it is."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.body import Body
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import Solid, solids
from robotteamsim.scenario.schedule import ScheduledEvent, in_order
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.world.doors import DoorStates, core_door, door_state, leaf_outline
from robotteamsim.world.pieces import convex_pieces
from robotteamsim.world.placement import check_objects

_TOUCH_M = 1e-6
"""Robots may be placed touching a wall or each other, up to rounding."""


class World:
    """A floor plan with robots in it: static walls, doors, round or polygonal bodies with drives.

    Commands are twists in `base_link`: the drive approaches them within its acceleration and speed limits in every
    physics substep; a sideways velocity is beyond all but omnidirectional drives. Contacts are solved by Box2D, without
    friction: they take the velocity that presses a robot into something, so it slides along a wall that it meets at an
    angle, and pushes robots. A robot that touches nothing moves in double precision exactly as its drive says.

    The team's size is fixed, but a robot may leave and come (again): one that is not there has no body, is seen by no
    sensor, and stands nowhere: its pose is NaN.

    Everything is deterministic: equal calls give equal bits, and `reset` begins the same again.
    """

    def __init__(
        self,
        plan: FloorPlan,
        robots: Sequence[PlacedRobot],
        run: Run,
        *,
        objects: Sequence[MovableObject] = (),
        schedule: Sequence[ScheduledEvent] = (),
    ) -> None:
        """Place the robots at their start poses, in id order.

        Args:   schedule: robots that leave and come by themselves; one whose place is taken comes when it is free.
        Raises: PlacementError: a robot or object starts in a wall, block, closed door, robot or object, or outside.
        """
        self.plan = plan
        self._robots = tuple(robots)
        self._first_objects = self._objects = tuple(objects)
        self._step_ns = round(run.step_s * 1e9)
        self._solids, self._shapes = _still_solids(plan)
        self._door_ids = {door.name: index for index, door in enumerate(plan.doors)}
        self._doors = DoorStates.at_start(plan)
        self._reaches_m = np.array([robot.reach_m for robot in self._robots])
        self._start_poses = [Pose(*robot.start_pose) for robot in self._robots]
        self._schedule = [happening for _, happening in in_order(schedule)]
        self._check_start_poses()
        check_objects(plan, self._objects, self._robots)
        self.core = self._build(run)
        """The C++ world, for the sensors that look at it."""
        self._have_leaves = any(door.motion != "instant" for door in plan.doors)
        self._begin()

    @property
    def num_robots(self) -> int:
        """Number of robots, there or not; their ids count from 0."""
        return len(self._robots)

    @property
    def step_ns(self) -> int:
        """Length of a step [ns]."""
        return self._step_ns

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None:
        """Advance by one step with one command per robot, in id order.

        What the schedule has for now happens first. The command of a robot that is not there changes nothing.
        Args:   twists: as an array float64, shape (n, 3): forward, left [m/s], counter-clockwise [rad/s].
        Raises: ValueError: the number of twists is wrong, or one is not finite; nothing has moved then.
        """
        if self._to_come:
            self._follow_schedule()
        self.core.step(twists)
        self.step_index += 1
        self.sim_time_ns += self._step_ns
        if self._have_leaves:
            self._look_at_doors()

    def poses(self) -> list[Pose]:
        """Return `map_T_base_link` of every robot; NaN of one that is not there."""
        return [Pose(*row) for row in self.core.poses().tolist()]

    def positions_m(self) -> np.ndarray:
        """Return the robots' positions in `map`, float64, shape (n, 2) [m]; NaN of one that is not there."""
        return self.core.poses()[:, :2]

    def twists(self) -> list[Twist]:
        """Return every robot's mean velocity in the last step as its body really moved, in `base_link`.

        A blocked robot has none; one that slides along a wall or is pushed has a sideways part.
        """
        return [Twist(*row) for row in self.core.twists().tolist()]

    def motions(self) -> list[Pose]:
        """Return every robot's way in the last step: its pose at the end, seen from that at the beginning.

        To be set elsewhere between steps (`set_pose`, `reset_positions`) is no way.
        """
        return [Pose(*row) for row in self.core.motions().tolist()]

    def in_contact(self) -> list[bool]:
        """Return whether each robot touched something in the last step (came within 5 mm)."""
        return self.core.in_contact().tolist()

    def contact_angles_rad(self) -> dict[int, tuple[float, ...]]:
        """Return in which directions the robots that touched something in the last step did so when they last did.

        Angles in `base_link`, ascending in (-pi, pi], from the robot's middle; contacts within 0.05 rad are one.
        """
        return {robot_id: tuple(angles) for robot_id, angles in self.core.contact_angles().items()}

    def objects(self) -> dict[str, Pose]:
        """Return where the middle of each object is in `map`, by name, in the scenario's order."""
        return {obj.name: Pose(*row) for obj, row in zip(self._objects, self.core.object_poses().tolist(), strict=True)}

    def door_states(self) -> DoorStates:
        """Return the state of all doors, by name, in the plan's order; its version grows with each change."""
        return self._doors

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        """Put a robot somewhere, standing still.

        Raises: PlacementError: it cannot stand there. ValueError: no such robot, or the pose is not finite.
        """
        if not self._is_there(robot_id):
            raise ValueError(f"robot_{robot_id} is not there; wanted one that is")
        self._check_free(robot_id, pose)
        self.core.set_pose(robot_id, pose)

    def remove_robot(self, robot_id: int) -> None:
        """Take a robot off the floor. Raises: ValueError: no such robot, or it is not there."""
        if not self._is_there(robot_id):
            raise ValueError(f"robot_{robot_id} is not there; it cannot be removed")
        self.core.remove_robot(robot_id)
        self._look_who_is_there()

    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None:
        """Put a robot that is not there somewhere, standing still; without a pose where it starts.

        Raises: PlacementError: it cannot stand there.
                ValueError: no such robot, it is there already, or the pose is not finite.
        """
        if self._is_there(robot_id):
            raise ValueError(f"robot_{robot_id} is there already; it cannot be spawned")
        place = self._start_poses[robot_id] if pose is None else pose
        self._check_free(robot_id, place)
        self.core.spawn_robot(robot_id, place)
        self._look_who_is_there()

    def object_models(self) -> tuple[MovableObject, ...]:
        """Return the objects that are there, in the order of `objects`, with the poses that they were added at."""
        return self._objects

    def add_object(self, obj: MovableObject) -> None:
        """Put another object into the world, at rest, behind the others in their order.

        Raises: PlacementError: it cannot stand there. ValueError: its name is taken.
        """
        known = next((other for other in self._objects if other.name == obj.name), None)
        if known is not None:
            raise ValueError(f"there is a {known.kind} '{obj.name}' already")
        self._check_object(obj, Pose(*obj.pose))
        self.core.add_object(_object(obj))
        self._objects = (*self._objects, obj)

    def move_object(self, name: str, pose: Pose) -> None:
        """Put an object elsewhere, at rest.

        Raises: PlacementError: it cannot stand there. ValueError: no such object, or the pose is not finite.
        """
        index = self._object_index(name)
        self._check_object(self._objects[index], pose)
        self.core.set_object_pose(index, pose)

    def remove_object(self, name: str) -> None:
        """Take an object out of the world. Raises: ValueError: no such object."""
        index = self._object_index(name)
        self.core.remove_object(index)
        self._objects = (*self._objects[:index], *self._objects[index + 1 :])

    def set_door(self, name: str, closed: bool) -> None:
        """Have a door closed or opened.

        An instant door is so at once, and a robot in the way of its leaf is pushed aside. The leaf of another swings or
        slides there in the steps to come, at an even pace; where anything is in its way it waits, and never pushes.

        Raises: ValueError: no such door.
        """
        if name not in self._doors:
            raise ValueError(f"there is no door '{name}', only {', '.join(self._doors) or 'none'}")
        self.core.set_door(self._door_ids[name], closed)
        self._look_at_doors()

    def reset_positions(self) -> None:
        """Put all robots back to their start poses, standing still; time, objects and doors stay as they are."""
        for robot_id, pose in enumerate(self._start_poses):
            if self._is_there(robot_id):
                self.core.set_pose(robot_id, pose)

    def reset(self) -> None:
        """Begin again as new: time, poses, who is there, objects and doors as at the start."""
        self.core.reset()
        self._look_at_doors()
        self._objects = self._first_objects
        self._begin()

    def _begin(self) -> None:
        self.step_index = 0
        """Number of steps since the start."""
        self.sim_time_ns = 0
        """Time since the start [ns]."""
        self._to_come = list(self._schedule)
        self._look_who_is_there()

    def _look_who_is_there(self) -> None:
        present = self.core.present()
        self.present: np.ndarray | None = None if present.all() else present
        """Whether each robot is there, bool, shape (n,); None: all are. The same object until one comes or leaves."""
        self.arrivals = tuple(self.core.arrivals())
        """How often each robot has come, its start included; the same object until one comes or leaves."""

    def _is_there(self, robot_id: int) -> bool:
        """Raises: ValueError: no such robot."""
        if not 0 <= robot_id < self.num_robots:
            raise ValueError(f"robot_id must be in 0..{self.num_robots - 1}, got {robot_id}")
        return self.present is None or bool(self.present[robot_id])

    def _follow_schedule(self) -> None:
        """Let happen what is due; what does not fit any more, as others had a hand in it, is left out."""
        waiting = []
        while self._to_come and round(self._to_come[0].at_s * 1e9) <= self.sim_time_ns:
            happening = self._to_come.pop(0)
            is_there = self._is_there(happening.robot_id)
            if happening.spawn is None and is_there:
                self.remove_robot(happening.robot_id)
            elif happening.spawn is not None and not is_there:
                try:
                    self.spawn_robot(happening.robot_id, happening.pose and Pose(*happening.pose))
                except PlacementError:
                    waiting.append(happening)
        self._to_come = waiting + self._to_come

    def _build(self, run: Run) -> _core.world.World:
        still, leaves = core_solids(self.plan)
        bodies, objects = [_body(robot) for robot in self._robots], [_object(obj) for obj in self._objects]
        return _core.world.World(still, leaves, bodies, run.step_s, run.physics_substeps, objects)

    def _check_start_poses(self) -> None:
        placed = np.full((self.num_robots, 3), math.nan)
        for robot_id, pose in enumerate(self._start_poses):
            if not self._robots[robot_id].present:
                continue
            self._check_pose(robot_id, pose, placed, "start pose")
            placed[robot_id] = pose.x_m, pose.y_m, pose.yaw_rad

    def _check_free(self, robot_id: int, pose: Pose) -> None:
        """Raise an error unless a robot can stand there now."""
        others = self.core.poses()
        others[robot_id] = math.nan
        self._check_pose(robot_id, pose, others, "pose")
        body = self._robots[robot_id].body_at((pose.x_m, pose.y_m, pose.yaw_rad))
        for obj, row in zip(self._objects, self.core.object_poses().tolist(), strict=True):
            if body.overlaps(obj.body_at(tuple(row)), _TOUCH_M):
                place = f"robot_{robot_id}: pose ({pose.x_m:.2f}, {pose.y_m:.2f})"
                raise PlacementError(f"{place} is inside {obj.kind} '{obj.name}'")

    def _check_pose(self, robot_id: int, pose: Pose, others: np.ndarray, what: str) -> None:
        """Raise an error unless a robot can stand there; others has rows of NaN for robots that are not there."""
        if not all(map(math.isfinite, (pose.x_m, pose.y_m, pose.yaw_rad))):
            raise ValueError(f"robot_{robot_id}: {what} must be finite, got {pose}")
        robot = self._robots[robot_id]
        place = f"robot_{robot_id}: {what} ({pose.x_m:.2f}, {pose.y_m:.2f})"
        if not self.plan.bounds.contains((pose.x_m, pose.y_m)):
            raise PlacementError(f"{place} is outside the plan, {self.plan.bounds}")
        body = robot.body_at((pose.x_m, pose.y_m, pose.yaw_rad))
        hit = self._solid_in(body)
        if hit is not None:
            wanted = "" if robot.footprint_m else f"; wanted {robot.radius_m:g} m of clearance"
            raise PlacementError(f"{place} is inside {hit.kind} '{hit.name}'{wanted}")
        self._check_others(robot_id, pose, body, others, place)

    def _check_others(self, robot_id: int, pose: Pose, body: Body, others: np.ndarray, place: str) -> None:
        robot = self._robots[robot_id]
        apart_m = self._reaches_m + (robot.reach_m - _TOUCH_M)
        for other_id in np.flatnonzero(np.hypot(*(others[:, :2] - (pose.x_m, pose.y_m)).T) < apart_m).tolist():
            other, (x_m, y_m, yaw_rad) = self._robots[other_id], others[other_id].tolist()
            if robot.footprint_m or other.footprint_m:
                if not body.overlaps(other.body_at((x_m, y_m, yaw_rad)), _TOUCH_M):
                    continue
                wanted = ""
            else:
                wanted = f"; wanted {robot.radius_m + other.radius_m:g} m between them"
            raise PlacementError(f"{place} is inside robot_{other_id} at ({x_m:.2f}, {y_m:.2f}){wanted}")

    def _object_index(self, name: str) -> int:
        names = [obj.name for obj in self._objects]
        if name not in names:
            raise ValueError(f"there is no object '{name}', only {', '.join(names) or 'none'}")
        return names.index(name)

    def _check_object(self, obj: MovableObject, pose: Pose) -> None:
        """Raise an error unless an object can stand there, whatever place it has now."""
        if not all(map(math.isfinite, (pose.x_m, pose.y_m, pose.yaw_rad))):
            raise ValueError(f"{obj.kind} '{obj.name}': pose must be finite, got {pose}")
        place = f"{obj.kind} '{obj.name}': pose ({pose.x_m:.2f}, {pose.y_m:.2f})"
        if not self.plan.bounds.contains((pose.x_m, pose.y_m)):
            raise PlacementError(f"{place} is outside the plan, {self.plan.bounds}")
        body = obj.body_at((pose.x_m, pose.y_m, pose.yaw_rad))
        hit = self._solid_in(body)
        if hit is not None:
            raise PlacementError(f"{place} is inside {hit.kind} '{hit.name}'")
        for other, row in zip(self._objects, self.core.object_poses().tolist(), strict=True):
            if other.name != obj.name and body.overlaps(other.body_at(tuple(row)), _TOUCH_M):
                raise PlacementError(f"{place} is inside {other.kind} '{other.name}'")
        for robot_id, row in enumerate(self.core.poses().tolist()):
            robot = self._robots[robot_id]
            is_near = math.dist((pose.x_m, pose.y_m), row[:2]) < obj.reach_m + robot.reach_m
            if is_near and body.overlaps(robot.body_at(tuple(row)), _TOUCH_M):
                raise PlacementError(f"{place} is inside robot_{robot_id}")

    def _solid_in(self, body: Body) -> Solid | None:
        near = self._shapes.query(body.core, predicate="dwithin", distance=body.margin_m - _TOUCH_M)
        hit = next((self._solids[index] for index in sorted(near)), None)
        return hit or next((leaf for leaf in self._leaves() if body.overlaps_shape(leaf.polygon, _TOUCH_M)), None)

    def _leaves(self) -> Iterator[Solid]:
        """Yield the leaves that are somewhere, where they are."""
        for door in self.plan.doors:
            corners = leaf_outline(door, self._doors[door.name])
            if corners is not None:
                yield Solid(door.name, "door", corners, door)

    def _look_at_doors(self) -> None:
        if self.core.doors_version != self._doors.version:
            states = {
                name: door_state(state) for name, state in zip(self._door_ids, self.core.door_states(), strict=True)
            }
            self._doors = DoorStates(states, self.core.doors_version)


@functools.lru_cache(maxsize=16)
def _still_solids(plan: FloorPlan) -> tuple[tuple[Solid, ...], shapely.STRtree]:
    """Return all solids of a plan but its doors, and their polygons as a tree; worlds on one plan share them."""
    still = solids(plan.model_copy(update={"doors": ()}))
    return still, shapely.STRtree([solid.polygon for solid in still])


@functools.lru_cache(maxsize=16)
def core_solids(plan: FloorPlan) -> tuple[list[_core.world.Solid], list[_core.world.Door]]:
    """Return the solids and the doors of the C++ world on a plan, not to be changed; worlds on one plan share them."""
    still, _ = _still_solids(plan)
    pieces = [_core.world.Solid(solid.corners, convex_pieces(solid.corners)) for solid in still]
    return pieces, [core_door(door) for door in plan.doors]


def _body(robot: PlacedRobot) -> _core.world.Robot:
    return _core.world.Robot(
        radius_m=robot.radius_m,
        mass_kg=robot.mass_kg,
        drive=_core.world.Drive(**robot.drive.model_dump()),
        start=Pose(*robot.start_pose),
        footprint_m=robot.corners_m,
        present=robot.present,
    )


def _object(obj: MovableObject) -> _core.world.MovableObject:
    return _core.world.MovableObject(
        radius_m=obj.reach_m,
        mass_kg=obj.mass_kg,
        friction=obj.friction,
        start=Pose(*obj.pose),
        corners_m=obj.corners_m,
    )

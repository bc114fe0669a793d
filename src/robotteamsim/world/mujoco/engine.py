"""MuJoCo as the physics of a world: robots that drive on wheels, objects, doors and contacts."""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import numpy as np
from msgspec.structs import astuple

from robotteamsim import _core
from robotteamsim.errors import PhysicsError
from robotteamsim.geometry import Pose, Twist, normalise_angle
from robotteamsim.scenario.body import Body
from robotteamsim.scenario.drives import CarDrive
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.mujoco import Gripper
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.world.core_parts import core_robot_drive
from robotteamsim.world.doors import DoorState
from robotteamsim.world.mujoco.bodies import object_name, robot_name
from robotteamsim.world.mujoco.building import leaf_name
from robotteamsim.world.mujoco.grippers import Grip, add_grips, grip_of
from robotteamsim.world.mujoco.leaves import Leaves
from robotteamsim.world.mujoco.model import compiled, make_spec, steps_per_substep
from robotteamsim.world.mujoco.ramps import ground_m
from robotteamsim.world.mujoco.shapes import about_z
from robotteamsim.world.mujoco.team_state import FreeBodies, SavedBody, Touches
from robotteamsim.world.mujoco.wheels import Motors

_SAME_PLACE_RAD = 0.05
"""Contacts nearer to each other than this are one."""
_BELOW_GROUND_M = -100.0
"""Height of the leaf of an open instant door, which does not exist."""
_STIFF_S, _SOFT_S = 0.02, 0.25
"""Times in which a leaf pushes out what touches it, and what is in its way when an instant door closes."""
_LEAD_SUBSTEPS = 1.5
"""The drive of a blocked robot is ahead of its body by at most what it can accelerate in this many substeps."""


class Engine:
    """The bodies of one world. See `_core.world.World`, which has the same methods.

    The model consists of what is present: when a robot or object arrives or leaves, it is compiled again.
    """

    model: mujoco.MjModel
    data: mujoco.MjData

    def __init__(
        self, plan: FloorPlan, robots: Sequence[PlacedRobot], run: Run, objects: Sequence[MovableObject]
    ) -> None:
        self._plan, self._robots, self._run = plan, tuple(robots), run
        self._first_objects = tuple(objects)
        self._substep_s = run.step_s / run.physics_substeps
        self._drives = [core_robot_drive(robot) for robot in self._robots]
        most = _LEAD_SUBSTEPS * self._substep_s
        self._lead = np.array([_accelerations(robot) for robot in self._robots]) * most
        self.reset()

    def reset(self) -> None:
        """Restore the initial state."""
        count = len(self._robots)
        self._present = np.array([robot.present for robot in self._robots])
        self._arrivals = self._present.astype(int).tolist()
        self._objects = list(self._first_objects)
        self._grips: dict[int, Grip] = {}
        self._leaves = Leaves(self._plan)
        self._speeds = np.zeros((count, 4))
        """Forward, turn, left and steering of each drive."""
        self._twists, self._motions = np.zeros((count, 3)), np.zeros((count, 3))
        self._touches: dict[int, list[float]] = {}
        starts = {i: Pose(*robot.start_pose) for i, robot in enumerate(self._robots) if self._present[i]}
        self._build(starts, [Pose(*obj.pose) for obj in self._objects], {}, {})

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None:
        """Advance by one step. Raises: PhysicsError: the state is no longer finite."""
        commands = twists if isinstance(twists, np.ndarray) else np.array(list(map(astuple, twists))).reshape(-1, 3)
        before = self.poses()
        touches: dict[int, list[float]] = {}
        for _ in range(self._run.physics_substeps):
            self._speeds = _core.world.reached_speeds(self._drives, self._speeds, commands, self._substep_s)
            self._speeds[~self._present] = 0.0
            self._move_leaves()
            for door in tuple(self._soft):
                self._set_softness(door)
            self._motors.drive(self.data, self._speeds)
            mujoco.mj_step(self.model, self.data, self._parts)
            self._follow_bodies()
            touches |= self._touches_now()
        self._touches = touches
        self._finish()
        self._note_motions(before)

    def poses(self) -> np.ndarray:
        """Return the poses of the robots."""
        rows = np.full((len(self._robots), 3), math.nan)
        rows[self._present] = self._bodies.poses()[: self._num_present]
        return rows

    def twists(self) -> np.ndarray:
        """Return the mean velocities of the robots in the last step."""
        return self._twists

    def motions(self) -> np.ndarray:
        """Return the motions of the robots in the last step."""
        return self._motions

    def in_contact(self) -> np.ndarray:
        """Return whether each robot touched something in the last step."""
        return np.isin(np.arange(len(self._robots)), list(self._touches))

    def contact_angles(self) -> dict[int, tuple[float, ...]]:
        """Return the directions of the last contacts in the last step."""
        return {robot_id: _distinct(self._touches[robot_id]) for robot_id in sorted(self._touches)}

    def object_poses(self) -> np.ndarray:
        """Return the poses of the objects."""
        return self._bodies.poses()[self._num_present :]

    def door_states(self) -> list[DoorState]:
        """Return the states of the doors."""
        return self._leaves.states()

    @property
    def doors_version(self) -> int:
        """Increases with each change of a door."""
        return self._leaves.version

    def present(self) -> np.ndarray:
        """Return whether each robot is present."""
        return self._present.copy()

    def arrivals(self) -> list[int]:
        """Return how often each robot has arrived."""
        return list(self._arrivals)

    def lean_rad(self) -> np.ndarray:
        """Return by how much each robot leans; NaN for absent ones."""
        angles_rad = np.full(len(self._robots), math.nan)
        angles_rad[self._present] = self._bodies.lean_rad()[: self._num_present]
        return angles_rad

    def body_id(self, robot_id: int) -> int | None:
        """Return the index of a robot's body in the model; None if it is absent."""
        return int(self._bodies.ids[self._index(robot_id)]) if self._present[robot_id] else None

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        """Move a robot to a pose, at rest."""
        if self._release(robot_id):
            self._rebuild(self._present, self._objects)
        self._bodies.place(self._index(robot_id), pose, self._ground_m(self._robots[robot_id], pose))
        self._forget(robot_id)
        self._finish()

    def remove_robot(self, robot_id: int) -> None:
        """Remove a robot."""
        self._release(robot_id)
        self._forget(robot_id)
        present = self._present.copy()
        present[robot_id] = False
        self._rebuild(present, self._objects)

    def spawn_robot(self, robot_id: int, pose: Pose) -> None:
        """Place an absent robot at a pose, at rest."""
        present = self._present.copy()
        present[robot_id] = True
        self._arrivals[robot_id] += 1
        self._rebuild(present, self._objects, new_robot=(robot_id, pose))

    def set_door(self, door: int, closed: bool) -> None:
        """Close or open a door."""
        self._leaves.set_closed(door, closed)
        self._put_leaf(door)
        self._set_softness(door)
        self._finish()

    def add_object(self, obj: MovableObject) -> None:
        """Add an object at its pose, at rest."""
        self._rebuild(self._present, [*self._objects, obj])

    def remove_object(self, index: int) -> None:
        """Remove an object."""
        self._release(name=self._objects[index].name)
        self._rebuild(self._present, self._objects[:index] + self._objects[index + 1 :])

    def set_object_pose(self, index: int, pose: Pose) -> None:
        """Move an object to a pose, at rest."""
        if self._release(name=self._objects[index].name):
            self._rebuild(self._present, self._objects)
        self._bodies.place(self._num_present + index, pose, self._ground_m(self._objects[index], pose))
        self._finish()

    @property
    def loads(self) -> dict[int, str]:
        """The names of the objects that robots hold, by the robots' ids."""
        return {robot_id: grip.object_name for robot_id, grip in sorted(self._grips.items())}

    def lift_object(self, robot_id: int, index: int, gripper: Gripper) -> None:
        """Let a robot lift an object."""
        obj, body = self._objects[index], self.body_id(robot_id)
        assert body is not None
        self._grips[robot_id] = grip_of(self.data, body, object_name(obj), obj.name, gripper)
        self._rebuild(self._present, self._objects)

    def drop_object(self, robot_id: int) -> None:
        """Let a robot open its gripper."""
        self._grips.pop(robot_id)
        self._rebuild(self._present, self._objects)

    def _release(self, robot_id: int | None = None, name: str | None = None) -> bool:
        """Open the gripper of a robot, or the one that holds an object; return whether it held something."""
        count = len(self._grips)
        self._grips = {i: grip for i, grip in self._grips.items() if i != robot_id and grip.object_name != name}
        return len(self._grips) < count

    def _ground_m(self, thing: PlacedRobot | MovableObject, pose: Pose) -> float:
        return ground_m(self._run.mujoco.ramps, thing.body_at(astuple(pose)))

    def _index(self, robot_id: int) -> int:
        return int(self._present[:robot_id].sum())

    def _present_ids(self) -> list[int]:
        return np.flatnonzero(self._present).tolist()

    def _rebuild(
        self, present: np.ndarray, objects: list[MovableObject], new_robot: tuple[int, Pose] | None = None
    ) -> None:
        """Compile the model of these bodies; those that stay keep their state."""
        robots = {robot_id: self._bodies.saved(index) for index, robot_id in enumerate(self._present_ids())}
        saved_objects = {obj.name: self._bodies.saved(i) for i, obj in enumerate(self._objects, self._num_present)}
        poses = {robot_id: Pose(*row) for robot_id, row in enumerate(self.poses().tolist())}
        if new_robot is not None:
            poses[new_robot[0]] = new_robot[1]
        self._present, self._objects = present, objects
        self._build(
            {robot_id: poses[robot_id] for robot_id in self._present_ids()},
            [Pose(*obj.pose) for obj in objects],
            robots,
            saved_objects,
        )

    def _build(
        self,
        poses: dict[int, Pose],
        object_poses: list[Pose],
        robots: dict[int, SavedBody],
        saved_objects: dict[str, SavedBody],
    ) -> None:
        placed = {robot_id: (self._robots[robot_id], pose) for robot_id, pose in poses.items()}
        objects = list(zip(self._objects, object_poses, strict=True))
        spec = make_spec(self._plan, placed, objects, self._run)
        add_grips(spec, self._grips)
        self.model = compiled(spec)
        self.data = mujoco.MjData(self.model)
        self._parts = steps_per_substep(self._run)
        names = [*map(robot_name, placed), *map(object_name, self._objects)]
        self._bodies = FreeBodies(self.model, self.data, names)
        self._num_present = len(placed)
        self._found = Touches(self.model, self._bodies)
        self._motors = Motors(self._robots, list(placed))
        for index, robot_id in enumerate(placed):
            if robot_id in robots:
                self._bodies.restore(index, robots[robot_id])
        for index, obj in enumerate(self._objects, self._num_present):
            if obj.name in saved_objects:
                self._bodies.restore(index, saved_objects[obj.name])
        self._leaf_ids = [self.model.body_mocapid[self.model.body(leaf_name(door)).id] for door in self._plan.doors]
        self._soft: set[int] = set()
        """Doors that push something out of their way."""
        for door in range(len(self._plan.doors)):
            self._put_leaf(door)
            self._set_softness(door)
        self._finish()

    def _put_leaf(self, door: int) -> None:
        pose, leaf = self._leaves.pose(door), self._leaf_ids[door]
        self.data.mocap_pos[leaf] = [0.0, 0.0, _BELOW_GROUND_M] if pose is None else [pose.x_m, pose.y_m, 0.0]
        self.data.mocap_quat[leaf] = about_z(0.0 if pose is None else pose.yaw_rad)

    def _set_softness(self, door: int) -> None:
        """Let a leaf that has appeared inside of something push it out slowly."""
        is_soft = self._leaves.pose(door) is not None and self._leaves.covers_any(door, self._footprints)
        (self._soft.add if is_soft else self._soft.discard)(door)
        geom = self.model.geom(leaf_name(self._plan.doors[door])).id
        self.model.geom_solref[geom, 0] = _SOFT_S if is_soft else _STIFF_S

    def _move_leaves(self) -> None:
        for door in self._leaves.advance(self._substep_s, self._footprints):
            self._put_leaf(door)
        self._leaves.note_changes()

    def _footprints(self) -> list[Body]:
        models: list[PlacedRobot | MovableObject] = [
            *(self._robots[robot_id] for robot_id in self._present_ids()),
            *self._objects,
        ]
        rows = self._bodies.poses().tolist()
        return [model.body_at((x, y, yaw)) for model, (x, y, yaw) in zip(models, rows, strict=True)]

    def _follow_bodies(self) -> None:
        """Keep the drives near to what the bodies do, so that a blocked robot stops pressing."""
        if not np.isfinite(self.data.qpos).all():
            raise PhysicsError(
                f"MuJoCo became unstable at {self.data.time:.2f} s; a smaller run.mujoco.timestep_s may help"
            )
        real = self._bodies.speeds()[: self._num_present]
        lead, speeds = self._lead[self._present], self._speeds[self._present]
        speeds[:, :3] = np.minimum(np.maximum(speeds[:, :3], real - lead), real + lead)
        self._speeds[self._present] = speeds

    def _touches_now(self) -> dict[int, list[float]]:
        """Return the directions in which robots touch something, by id."""
        found = self._found.found(self.data)
        if not found:
            return {}
        ids, rows = self._present_ids(), self._bodies.poses().tolist()
        touches: dict[int, list[float]] = {}
        for index, place in found:
            x_m, y_m, yaw_rad = rows[index]
            angle_rad = normalise_angle(math.atan2(place[1] - y_m, place[0] - x_m) - yaw_rad)
            touches.setdefault(ids[index], []).append(angle_rad)
        return touches

    def _note_motions(self, before: np.ndarray) -> None:
        """Compute motions, and the velocities of the arcs that lead there."""
        delta = self.poses() - before
        cos, sin = np.cos(before[:, 2]), np.sin(before[:, 2])
        x, y = cos * delta[:, 0] + sin * delta[:, 1], cos * delta[:, 1] - sin * delta[:, 0]
        turn = np.arctan2(np.sin(delta[:, 2]), np.cos(delta[:, 2]))
        self._motions = np.nan_to_num(np.column_stack((x, y, turn)))
        half = 0.5 * turn
        stretch = 1.0 / np.sinc(half / math.pi)  # of the arc, compared with its chord
        forward, left = np.cos(half) * x + np.sin(half) * y, np.cos(half) * y - np.sin(half) * x
        self._twists = np.nan_to_num(np.column_stack((forward * stretch, left * stretch, turn))) / self._run.step_s

    def _forget(self, robot_id: int) -> None:
        """Bring the drive of a robot to rest, without a motion or contact in the last step."""
        for rows in (self._speeds, self._twists, self._motions):
            rows[robot_id] = 0.0
        self._touches.pop(robot_id, None)

    def _finish(self) -> None:
        """Compute where all shapes are, for rays."""
        mujoco.mj_kinematics(self.model, self.data)


def _accelerations(robot: PlacedRobot) -> tuple[float, float, float]:
    """Return the greatest changes of the forward speed, the turn and the speed to the left."""
    drive = robot.drive
    turn = math.inf if isinstance(drive, CarDrive) else drive.max_turn_acceleration_radps2
    return drive.max_acceleration_mps2, turn, drive.max_acceleration_mps2


def _distinct(angles_rad: list[float]) -> tuple[float, ...]:
    """Return angles in ascending order, without those that are near to another."""
    distinct: list[float] = []
    for angle_rad in sorted(angles_rad):
        if not distinct or angle_rad - distinct[-1] >= _SAME_PLACE_RAD:
            distinct.append(angle_rad)
    if len(distinct) > 1 and distinct[0] + math.tau - distinct[-1] < _SAME_PLACE_RAD:
        distinct.pop()
    return tuple(distinct)

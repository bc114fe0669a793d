"""What all worlds have in common: time, presence, and checks of poses and names."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Protocol

import numpy as np

from robotteamsim import _core
from robotteamsim.errors import CameraError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Camera, LightSensor
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorState, DoorStates, LeafMotion
from robotteamsim.world.free_space import FreeSpace, Occupants
from robotteamsim.world.placement import check_objects

_NO_MISHAPS: Mapping[int, Mishap] = MappingProxyType({})
_NO_LOADS: Mapping[int, str] = MappingProxyType({})


class _DoorReading(Protocol):
    @property
    def closed(self) -> bool: ...
    @property
    def opening(self) -> float: ...
    @property
    def motion(self) -> LeafMotion: ...


class Physics(Protocol):
    """What moves the bodies of a world; see the methods of the same names in `AnyWorld`.

    Arrays have one row (x or forward, y or left, yaw or turn) per robot or object. Doors and objects have indices.
    """

    @property
    def doors_version(self) -> int:
        """Return a number that grows with each change of a door."""

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None:
        """Advance by one step."""

    def poses(self) -> np.ndarray:
        """Return the poses of the robots."""

    def team(self) -> _core.world.TeamMotion:
        """Return their last step."""

    def contact_angles(self) -> dict[int, tuple[float, ...]]:
        """Return the directions of contacts, by id."""

    def object_poses(self) -> np.ndarray:
        """Return the poses of the objects."""

    def door_states(self) -> Sequence[_DoorReading]:
        """Return the states of the doors."""

    def present(self) -> np.ndarray:
        """Return whether each robot is present."""

    def arrivals(self) -> Sequence[int]:
        """Return how often each robot has arrived."""

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        """Move a robot to a pose, at rest."""

    def remove_robot(self, robot_id: int) -> None:
        """Remove a robot."""

    def spawn_robot(self, robot_id: int, pose: Pose) -> None:
        """Place an absent robot at a pose, at rest."""

    def set_door(self, door: int, closed: bool) -> None:
        """Close or open a door."""

    def remove_object(self, index: int) -> None:
        """Remove an object."""

    def set_object_pose(self, index: int, pose: Pose) -> None:
        """Move an object to a pose, at rest."""

    def reset(self) -> None:
        """Restore the initial state."""


class BaseWorld(ABC):
    """What all worlds have in common: time, checks of poses and names. See `AnyWorld` for its contract.

    A subclass adds the physics.
    """

    def __init__(
        self,
        plan: FloorPlan,
        robots: Sequence[PlacedRobot],
        run: Run,
        *,
        objects: Sequence[MovableObject] = (),
    ) -> None:
        """Place the robots at their start poses, in id order.

        Raises: PlacementError: a robot or object starts in a wall, block, closed door, robot or object, or outside.
        """
        self.plan = plan
        self._robots = tuple(robots)
        self._first_objects = self._objects = tuple(objects)
        self._step_ns = round(run.step_s * 1e9)
        self._free_space = FreeSpace(plan, self._robots)
        self._door_ids = {door.name: index for index, door in enumerate(plan.doors)}
        self._doors = DoorStates.at_start(plan)
        self._start_poses = [Pose(*robot.start_pose) for robot in self._robots]
        self._free_space.check_start_poses(self._doors)
        check_objects(plan, self._objects, self._robots)
        self._physics = self._make_physics(run)
        self.team_version = 0
        self._have_leaves = any(door.motion != "instant" for door in plan.doors)
        self._begin()

    @abstractmethod
    def _make_physics(self, run: Run) -> Physics:
        """Return the physics at the start, with `_robots` and `_objects`."""

    @abstractmethod
    def _add_body(self, obj: MovableObject) -> None:
        """Add an object to the physics."""

    @property
    def num_robots(self) -> int:
        """See `AnyWorld.num_robots`."""
        return len(self._robots)

    @property
    def step_ns(self) -> int:
        """See `AnyWorld.step_ns`."""
        return self._step_ns

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None:
        """See `AnyWorld.step`."""
        self._physics.step(twists)
        self.step_index += 1
        self.sim_time_ns += self._step_ns
        if self._have_leaves:
            self._update_doors()

    def team(self) -> _core.world.TeamMotion:
        """See `AnyWorld.team`."""
        return self._physics.team()

    def poses(self) -> list[Pose]:
        """See `AnyWorld.poses`."""
        return [Pose(*row) for row in self._physics.poses().tolist()]

    def positions_m(self) -> np.ndarray:
        """See `AnyWorld.positions_m`."""
        return self._physics.poses()[:, :2]

    def twists(self) -> list[Twist]:
        """See `AnyWorld.twists`."""
        return [Twist(*row) for row in self.team().twists.tolist()]

    def motions(self) -> list[Pose]:
        """See `AnyWorld.motions`."""
        return [Pose(*row) for row in self.team().motions.tolist()]

    def in_contact(self) -> list[bool]:
        """See `AnyWorld.in_contact`."""
        in_contact: list[bool] = self.team().in_contact.tolist()
        return in_contact

    def contact_angles_rad(self) -> dict[int, tuple[float, ...]]:
        """See `AnyWorld.contact_angles_rad`."""
        return self._physics.contact_angles()

    def objects(self) -> dict[str, Pose]:
        """See `AnyWorld.objects`."""
        return {
            obj.name: Pose(*row) for obj, row in zip(self._objects, self._physics.object_poses().tolist(), strict=True)
        }

    def door_states(self) -> DoorStates:
        """See `AnyWorld.door_states`."""
        return self._doors

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        """See `AnyWorld.set_pose`."""
        if not self._is_present(robot_id):
            raise ValueError(f"robot_{robot_id} is not present; it cannot be moved")
        self._free_space.check_robot(robot_id, pose, self._occupants())
        self._physics.set_pose(robot_id, pose)

    def remove_robot(self, robot_id: int) -> None:
        """See `AnyWorld.remove_robot`."""
        if not self._is_present(robot_id):
            raise ValueError(f"robot_{robot_id} is not present; it cannot be removed")
        self._physics.remove_robot(robot_id)
        self._update_presence()

    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None:
        """See `AnyWorld.spawn_robot`."""
        if self._is_present(robot_id):
            raise ValueError(f"robot_{robot_id} is already present; it cannot be spawned")
        place = self._start_poses[robot_id] if pose is None else pose
        self._free_space.check_robot(robot_id, place, self._occupants())
        self._physics.spawn_robot(robot_id, place)
        self._update_presence()

    def object_models(self) -> tuple[MovableObject, ...]:
        """See `AnyWorld.object_models`."""
        return self._objects

    def add_object(self, obj: MovableObject) -> None:
        """See `AnyWorld.add_object`."""
        known = next((other for other in self._objects if other.name == obj.name), None)
        if known is not None:
            raise ValueError(f"there is already a {known.kind} '{obj.name}'")
        self._free_space.check_object(obj, Pose(*obj.pose), self._occupants())
        self._add_body(obj)
        self._objects = (*self._objects, obj)

    def move_object(self, name: str, pose: Pose) -> None:
        """See `AnyWorld.move_object`."""
        index = self._object_index(name)
        self._free_space.check_object(self._objects[index], pose, self._occupants())
        self._physics.set_object_pose(index, pose)

    def remove_object(self, name: str) -> None:
        """See `AnyWorld.remove_object`."""
        index = self._object_index(name)
        self._physics.remove_object(index)
        self._objects = (*self._objects[:index], *self._objects[index + 1 :])

    def lift_object(self, robot_id: int, name: str) -> None:
        """See `AnyWorld.lift_object`."""
        raise ValueError(f"robot_{robot_id} has no gripper; it needs robots.gripper and run.world mujoco")

    def drop_object(self, robot_id: int) -> None:
        """See `AnyWorld.drop_object`."""
        self._is_present(robot_id)
        raise ValueError(f"robot_{robot_id} holds nothing")

    def set_door(self, name: str, closed: bool) -> None:
        """See `AnyWorld.set_door`."""
        if name not in self._doors:
            raise ValueError(f"unknown door '{name}'; known: {', '.join(self._doors) or 'none'}")
        self._physics.set_door(self._door_ids[name], closed)
        self._update_doors()

    def set_light(self, name: str, lit: bool) -> None:
        """See `AnyWorld.set_light`."""
        raise ValueError(f"unknown light '{name}'; known: none")

    def illuminance_lx(self, robot_id: int, sensor: LightSensor) -> float:
        """See `AnyWorld.illuminance_lx`."""
        return 0.0

    def image(self, robot_id: int, camera: Camera) -> np.ndarray:
        """See `AnyWorld.image`."""
        raise CameraError(f"robots.cameras: '{camera.name}' needs run.world mujoco")

    def reset_positions(self) -> None:
        """See `AnyWorld.reset_positions`."""
        for robot_id, pose in enumerate(self._start_poses):
            if self._is_present(robot_id):
                self._physics.set_pose(robot_id, pose)

    def reset(self) -> None:
        """See `AnyWorld.reset`."""
        self._physics.reset()
        self._update_doors()
        self._objects = self._first_objects
        self._begin()

    def _begin(self) -> None:
        self.step_index = 0
        self.sim_time_ns = 0
        self.mishaps = _NO_MISHAPS
        self.loads = _NO_LOADS
        self._update_presence()

    def _update_presence(self) -> None:
        self.present = self._physics.present()
        self.arrivals = tuple(self._physics.arrivals())
        self.team_version += 1

    def _is_present(self, robot_id: int) -> bool:
        """Raises: ValueError: no such robot."""
        if not 0 <= robot_id < self.num_robots:
            raise ValueError(f"robot_id must be in 0..{self.num_robots - 1}, got {robot_id}")
        return bool(self.present[robot_id])

    def _occupants(self) -> Occupants:
        """Return the current positions of robots, objects and leaves."""
        poses = [Pose(*row) for row in self._physics.object_poses().tolist()]
        return Occupants(self._physics.poses(), list(zip(self._objects, poses, strict=True)), self._doors)

    def _object_index(self, name: str) -> int:
        names = [obj.name for obj in self._objects]
        if name not in names:
            raise ValueError(f"unknown object '{name}'; known: {', '.join(names) or 'none'}")
        return names.index(name)

    def _update_doors(self) -> None:
        if self._physics.doors_version != self._doors.version:
            states = [DoorState(door.closed, door.opening, door.motion) for door in self._physics.door_states()]
            self._doors = DoorStates(dict(zip(self._door_ids, states, strict=True)), self._physics.doors_version)

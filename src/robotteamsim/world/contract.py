"""The contract of worlds: what everybody who uses a world relies on, whichever engine computes its physics.

`robotteamsim.testing.contract` tests each world against it. Simulations, sensors, the ROS nodes and the viewer use
only these members.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Literal, NamedTuple, Protocol

import numpy as np

from robotteamsim.errors import CameraError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Camera, LightSensor
from robotteamsim.scenario.sensors.base import Fan
from robotteamsim.world.doors import DoorState, DoorStates, LeafMotion
from robotteamsim.world.free_space import FreeSpace, Occupants
from robotteamsim.world.placement import check_objects

Mishap = Literal["tipped_over", "left_world"]
"""Why a robot cannot go on: it lies on its side or back, or it has left the world."""


class ObjectStates(NamedTuple):
    """The objects of a world, and the pose of each one's centre in `map`."""

    models: tuple[MovableObject, ...]
    poses: tuple[Pose, ...]


NO_OBJECTS = ObjectStates((), ())


class _Door(Protocol):
    @property
    def closed(self) -> bool: ...
    @property
    def opening(self) -> float: ...
    @property
    def motion(self) -> LeafMotion: ...


class _Physics(Protocol):
    """What moves the bodies of a world: `_core.world.World`, or the engine of MuJoCo.

    Its methods do what those of `AnyWorld` do, without checks. Arrays have one row (x or forward, y or left, yaw or
    turn) per robot or object. Doors and objects have indices.
    """

    @property
    def doors_version(self) -> int:
        """Return a number that grows with each change of a door."""

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None: ...
    def twists(self) -> np.ndarray: ...
    def motions(self) -> np.ndarray: ...
    def in_contact(self) -> np.ndarray: ...
    def poses(self) -> np.ndarray: ...
    def contact_angles(self) -> dict[int, tuple[float, ...]]: ...
    def present(self) -> np.ndarray: ...
    def arrivals(self) -> Sequence[int]: ...
    def object_poses(self) -> np.ndarray: ...
    def door_states(self) -> Sequence[_Door]: ...
    def set_pose(self, robot_id: int, pose: Pose) -> None: ...
    def remove_robot(self, robot_id: int) -> None: ...
    def spawn_robot(self, robot_id: int, pose: Pose) -> None: ...
    def set_door(self, door: int, closed: bool) -> None: ...
    def remove_object(self, index: int) -> None: ...
    def set_object_pose(self, index: int, pose: Pose) -> None: ...
    def reset(self) -> None: ...


class AnyWorld(ABC):
    """A floor plan with robots, objects and doors, in steps of constant length.

    **Time.** `step` advances by one step; nothing changes by itself between steps.
    **Commands in.** One twist per robot and step, in `base_link`. It holds for the whole step: the robot's drive
    approaches it within its limits of speed and acceleration. Only omnidirectional drives move sideways.
    **Readings out.** True poses, velocities, motions and contacts after the last step, in id order.
    **Team.** Its size is fixed, but robots leave and arrive. An absent robot has no body, no sensor sees it, its
    command is ignored, and its pose is NaN.
    **Determinism.** The same calls give bit-identical results; `reset` restores the initial state.
    **Errors.** ValueError for numbers that are not finite and for unknown names and ids, PlacementError where there is
    no room. After an error nothing has changed.

    A subclass adds the physics.
    """

    plan: FloorPlan
    step_index: int
    """Number of steps since the start."""
    sim_time_ns: int
    """Time since the start [ns]."""
    team_version: int
    """Increases with each change of `present`, `arrivals`, `mishaps` and `loads`."""
    present: np.ndarray
    """Whether each robot is present, bool, shape (n,)."""
    arrivals: tuple[int, ...]
    """Number of arrivals of each robot, including the start."""
    mishaps: Mapping[int, Mishap]
    """Robots that lie on their side or have left the world, by id. Such robots do not end a mission. A robot that has
    left is absent; it may be spawned again."""

    loads: Mapping[int, str]
    """Names of the objects that robots hold, by the robots' ids."""

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
    def _make_physics(self, run: Run) -> _Physics:
        """Return the physics at the start, with `_robots` and `_objects`."""

    @abstractmethod
    def caster(self, fan: Fan) -> Callable[[Sequence[int]], np.ndarray]:
        """Return the function that casts these beams from some robots, by their ids, as the world is when it is called.

        It returns how far the beams reach, float64, shape (robots, beams) [m]; inf without a return.

        Walls, doors, objects and other robots return a beam, and so do floors in a world with heights; the robot itself
        does not. An absent robot gets no returns.
        """

    @abstractmethod
    def _add_body(self, obj: MovableObject) -> None:
        """Add an object to the physics."""

    @property
    def num_robots(self) -> int:
        """Number of robots, present or not; ids count from 0."""
        return len(self._robots)

    @property
    def step_ns(self) -> int:
        """Length of a step [ns]."""
        return self._step_ns

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None:
        """Advance by one step with one command per robot, in id order.

        The command of an absent robot is ignored.
        Args:   twists: or an array, float64, shape (n, 3): forward, left [m/s], counter-clockwise [rad/s].
        Raises: ValueError: the number of twists is wrong, or one is not finite; then nothing has moved.
        """
        self._physics.step(twists)
        self.count_steps(1)
        if self._have_leaves:
            self._update_doors()

    def count_steps(self, number: int) -> None:
        """Note that the physics has made so many steps."""
        self.step_index += number
        self.sim_time_ns += number * self._step_ns

    def motion(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the last step of all robots as arrays in id order: `poses`, `twists`, `motions` and `in_contact`.

        Poses and motions are float64, shape (n, 3): x, y [m], yaw [rad]; twists float64, shape (n, 3): forward, left
        [m/s], counter-clockwise [rad/s]; contacts bool, shape (n,).
        """
        physics = self._physics
        return physics.poses(), physics.twists(), physics.motions(), physics.in_contact()

    def poses(self) -> list[Pose]:
        """Return `map_T_base_link` of every robot, projected onto the floor; NaN for absent robots."""
        return [Pose(*row) for row in self._physics.poses().tolist()]

    def positions_m(self) -> np.ndarray:
        """Return the robots' positions in `map`, float64, shape (n, 2) [m]; NaN for absent robots."""
        return self._physics.poses()[:, :2]

    def twists(self) -> list[Twist]:
        """Return every robot's true mean velocity in the last step, in `base_link`.

        It is zero for a blocked robot, and has a sideways component for one that is pushed or slides along something.
        """
        return [Twist(*row) for row in self._physics.twists().tolist()]

    def motions(self) -> list[Pose]:
        """Return every robot's motion in the last step: its pose at the end in the frame of that at the beginning.

        Teleporting (`set_pose`, `reset_positions`) does not count as motion.
        """
        return [Pose(*row) for row in self._physics.motions().tolist()]

    def in_contact(self) -> list[bool]:
        """Return whether each robot touched something in the last step (came within 5 mm)."""
        in_contact: list[bool] = self._physics.in_contact().tolist()
        return in_contact

    def contact_angles_rad(self) -> dict[int, tuple[float, ...]]:
        """Return the directions of contacts in the last step, by id of the robots that touched something.

        Angles in `base_link`, ascending in (-pi, pi], from the robot's centre; contacts within 0.05 rad count as one.
        """
        return self._physics.contact_angles()

    def objects(self) -> dict[str, Pose]:
        """Return the pose of each object's centre in `map`, by name, in the scenario's order."""
        return {
            obj.name: Pose(*row) for obj, row in zip(self._objects, self._physics.object_poses().tolist(), strict=True)
        }

    def door_states(self) -> DoorStates:
        """Return the state of all doors, by name, in the plan's order; its version grows with each change."""
        return self._doors

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        """Move a robot to a pose, at rest.

        Raises: PlacementError: there is no room. ValueError: no such robot, it is absent, or the pose is not finite.
        """
        if not self._is_present(robot_id):
            raise ValueError(f"robot_{robot_id} is not present; it cannot be moved")
        self._free_space.check_robot(robot_id, pose, self._occupants())
        self._physics.set_pose(robot_id, pose)

    def remove_robot(self, robot_id: int) -> None:
        """Remove a robot. Raises: ValueError: no such robot, or it is absent."""
        if not self._is_present(robot_id):
            raise ValueError(f"robot_{robot_id} is not present; it cannot be removed")
        self._physics.remove_robot(robot_id)
        self._update_presence()

    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None:
        """Spawn an absent robot at a pose, at rest; by default at its start pose.

        Raises: PlacementError: there is no room.
                ValueError: no such robot, it is already present, or the pose is not finite.
        """
        if self._is_present(robot_id):
            raise ValueError(f"robot_{robot_id} is already present; it cannot be spawned")
        place = self._start_poses[robot_id] if pose is None else pose
        self._free_space.check_robot(robot_id, place, self._occupants())
        self._physics.spawn_robot(robot_id, place)
        self._update_presence()

    def object_states(self) -> ObjectStates:
        """Return the present objects and where they are."""
        return ObjectStates(self._objects, tuple(self.objects().values())) if self._objects else NO_OBJECTS

    def add_object(self, obj: MovableObject) -> None:
        """Add an object at rest, at the end of the order.

        Raises: PlacementError: there is no room. ValueError: its name is taken.
        """
        known = next((other for other in self._objects if other.name == obj.name), None)
        if known is not None:
            raise ValueError(f"there is already a {known.kind} '{obj.name}'")
        self._free_space.check_object(obj, Pose(*obj.pose), self._occupants())
        self._add_body(obj)
        self._objects = (*self._objects, obj)

    def move_object(self, name: str, pose: Pose) -> None:
        """Move an object to a pose, at rest.

        Raises: PlacementError: there is no room. ValueError: no such object, or the pose is not finite.
        """
        index = self._object_index(name)
        self._free_space.check_object(self._objects[index], pose, self._occupants())
        self._physics.set_object_pose(index, pose)

    def remove_object(self, name: str) -> None:
        """Remove an object. Raises: ValueError: no such object."""
        index = self._object_index(name)
        self._physics.remove_object(index)
        self._objects = (*self._objects[:index], *self._objects[index + 1 :])

    def lift_object(self, robot_id: int, name: str) -> None:
        """Let a robot's gripper hold an object, which moves with the robot until it is dropped.

        Raises: ValueError: no such robot or object, no gripper, or the object is too far, too heavy, behind a wall or
                held; also in a world without grippers.
        """
        raise ValueError(f"robot_{robot_id} has no gripper; it needs robots.gripper and run.world mujoco")

    def drop_object(self, robot_id: int) -> None:
        """Open a robot's gripper. A robot that is moved by `set_pose` or removed drops its load, too.

        Raises: ValueError: no such robot, or it holds nothing.
        """
        self._is_present(robot_id)
        raise ValueError(f"robot_{robot_id} holds nothing")

    def set_door(self, name: str, closed: bool) -> None:
        """Close or open a door.

        An instant door changes at once and pushes robots in the way of its leaf aside. The leaf of any other swings or
        slides at constant speed in the following steps; it stops while something is in its way, and never pushes.

        Raises: ValueError: no such door.
        """
        if not isinstance(name, str) or name not in self._doors:
            raise ValueError(f"unknown door '{name}'; known: {', '.join(self._doors) or 'none'}")
        self._physics.set_door(self._door_ids[name], closed)
        self._update_doors()

    def set_light(self, name: str, lit: bool) -> None:
        """Switch a light on or off. Raises: ValueError: no such light."""
        raise ValueError(f"unknown light '{name}'; known: none")

    def illuminance_lx(self, robot_id: int, sensor: LightSensor) -> float:
        """Return what one of a robot's light sensors measures [lx]; 0 for an absent robot and without lights."""
        return 0.0

    def image(self, robot_id: int, camera: Camera) -> np.ndarray:
        """Return what one of a robot's cameras sees, in the form that `Camera` describes.

        Raises: CameraError: nothing can be drawn on this computer or in this world.
        """
        raise CameraError(f"robots.sensors: camera '{camera.name}' needs run.world mujoco")

    def close_cameras(self) -> None:
        """Free what the cameras keep in the thread that draws their images, which has to call this, until the next."""
        return

    def reset_positions(self) -> None:
        """Move all present robots to their start poses, at rest; time, objects and doors stay as they are."""
        for robot_id, pose in enumerate(self._start_poses):
            if self._is_present(robot_id):
                self._physics.set_pose(robot_id, pose)

    def reset(self) -> None:
        """Restore the initial state: time, poses, presence, objects and doors."""
        self._physics.reset()
        self._update_doors()
        self._objects = self._first_objects
        self._begin()

    def _begin(self) -> None:
        self.step_index = 0
        self.sim_time_ns = 0
        self.mishaps = {}
        self.loads = {}
        self._update_presence()

    def _update_presence(self) -> None:
        self.present = self._physics.present()
        self.arrivals = tuple(self._physics.arrivals())
        self.team_version += 1

    def _is_present(self, robot_id: int) -> bool:
        """Raises: ValueError: no such robot."""
        if not isinstance(robot_id, int | np.integer) or not 0 <= robot_id < self.num_robots:
            raise ValueError(f"robot_id must be in 0..{self.num_robots - 1}, got {robot_id!r:.60}")
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

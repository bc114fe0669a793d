"""The true state of a trial: poses of robots and objects, contacts, doors, time."""

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.schedule import ScheduledEvent, Upcoming
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.world.core_parts import core_object, core_robot, core_solids
from robotteamsim.world.doors import DoorState, DoorStates
from robotteamsim.world.free_space import FreeSpace, Occupants
from robotteamsim.world.placement import check_objects


class World:
    """A floor plan with robots and objects: static walls, doors, round or polygonal bodies with drives.

    Commands are twists in `base_link`: the drive approaches them within its acceleration and speed limits in every
    physics substep; only omnidirectional drives can move sideways. Box2D solves contacts without friction: a contact
    removes the velocity component that presses a robot into something, so a robot slides along a wall that it meets at
    an angle, and pushes robots. A robot without contact moves in double precision exactly as its drive computes.

    The size of the team is fixed, but robots may leave and arrive (again). An absent robot has no body, no sensor sees
    it, and its pose is NaN.

    Everything is deterministic: the same calls give bit-identical results, and `reset` restores the initial state.
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

        Args:   schedule: robots that leave and arrive by themselves, and doors that open and close; a robot whose
                    place is occupied arrives when it is free. Noise and victims are not part of the world.
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
        self._schedule = tuple(schedule)
        self._free_space.check_start_poses(self._doors)
        check_objects(plan, self._objects, self._robots)
        still, leaves = core_solids(plan)
        bodies, models = [core_robot(robot) for robot in self._robots], [core_object(obj) for obj in self._objects]
        self.core = _core.world.World(still, leaves, bodies, run.step_s, run.physics_substeps, models)
        """The C++ world, for sensors."""
        self._have_leaves = any(door.motion != "instant" for door in plan.doors)
        self._begin()

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

        Scheduled events that are due happen first. The command of an absent robot is ignored.
        Args:   twists: as an array float64, shape (n, 3): forward, left [m/s], counter-clockwise [rad/s].
        Raises: ValueError: the number of twists is wrong, or one is not finite; then nothing has moved.
        """
        self._follow_schedule()
        self.core.step(twists)
        self.step_index += 1
        self.sim_time_ns += self._step_ns
        if self._have_leaves:
            self._update_doors()

    def poses(self) -> list[Pose]:
        """Return `map_T_base_link` of every robot; NaN for absent robots."""
        return [Pose(*row) for row in self.core.poses().tolist()]

    def positions_m(self) -> np.ndarray:
        """Return the robots' positions in `map`, float64, shape (n, 2) [m]; NaN for absent robots."""
        return self.core.poses()[:, :2]

    def twists(self) -> list[Twist]:
        """Return every robot's true mean velocity in the last step, in `base_link`.

        It is zero for a blocked robot, and has a sideways component for one that slides along a wall or is pushed.
        """
        return [Twist(*row) for row in self.core.twists().tolist()]

    def motions(self) -> list[Pose]:
        """Return every robot's motion in the last step: its pose at the end in the frame of that at the beginning.

        Teleporting (`set_pose`, `reset_positions`) does not count as motion.
        """
        return [Pose(*row) for row in self.core.motions().tolist()]

    def in_contact(self) -> list[bool]:
        """Return whether each robot touched something in the last step (came within 5 mm)."""
        in_contact: list[bool] = self.core.in_contact().tolist()
        return in_contact

    def contact_angles_rad(self) -> dict[int, tuple[float, ...]]:
        """Return the directions of contacts in the last step, by id of the robots that touched something.

        Angles in `base_link`, ascending in (-pi, pi], from the robot's centre; contacts within 0.05 rad count as one.
        """
        return self.core.contact_angles()

    def objects(self) -> dict[str, Pose]:
        """Return the pose of each object's centre in `map`, by name, in the scenario's order."""
        return {obj.name: Pose(*row) for obj, row in zip(self._objects, self.core.object_poses().tolist(), strict=True)}

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
        self.core.set_pose(robot_id, pose)

    def remove_robot(self, robot_id: int) -> None:
        """Remove a robot. Raises: ValueError: no such robot, or it is absent."""
        if not self._is_present(robot_id):
            raise ValueError(f"robot_{robot_id} is not present; it cannot be removed")
        self.core.remove_robot(robot_id)
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
        self.core.spawn_robot(robot_id, place)
        self._update_presence()

    def object_models(self) -> tuple[MovableObject, ...]:
        """Return the present objects in the order of `objects`, with the poses at which they were added."""
        return self._objects

    def add_object(self, obj: MovableObject) -> None:
        """Add an object at rest, at the end of the order.

        Raises: PlacementError: there is no room. ValueError: its name is taken.
        """
        known = next((other for other in self._objects if other.name == obj.name), None)
        if known is not None:
            raise ValueError(f"there is already a {known.kind} '{obj.name}'")
        self._free_space.check_object(obj, Pose(*obj.pose), self._occupants())
        self.core.add_object(core_object(obj))
        self._objects = (*self._objects, obj)

    def move_object(self, name: str, pose: Pose) -> None:
        """Move an object to a pose, at rest.

        Raises: PlacementError: there is no room. ValueError: no such object, or the pose is not finite.
        """
        index = self._object_index(name)
        self._free_space.check_object(self._objects[index], pose, self._occupants())
        self.core.set_object_pose(index, pose)

    def remove_object(self, name: str) -> None:
        """Remove an object. Raises: ValueError: no such object."""
        index = self._object_index(name)
        self.core.remove_object(index)
        self._objects = (*self._objects[:index], *self._objects[index + 1 :])

    def set_door(self, name: str, closed: bool) -> None:
        """Close or open a door.

        An instant door changes at once and pushes robots in the way of its leaf aside. The leaf of any other swings or
        slides at constant speed in the following steps; it stops while something is in its way, and never pushes.

        Raises: ValueError: no such door.
        """
        if name not in self._doors:
            raise ValueError(f"unknown door '{name}'; known: {', '.join(self._doors) or 'none'}")
        self.core.set_door(self._door_ids[name], closed)
        self._update_doors()

    def reset_positions(self) -> None:
        """Move all present robots to their start poses, at rest; time, objects and doors stay as they are."""
        for robot_id, pose in enumerate(self._start_poses):
            if self._is_present(robot_id):
                self.core.set_pose(robot_id, pose)

    def reset(self) -> None:
        """Restore the initial state: time, poses, presence, objects and doors."""
        self.core.reset()
        self._update_doors()
        self._objects = self._first_objects
        self._begin()

    def _begin(self) -> None:
        self.step_index = 0
        """Number of steps since the start."""
        self.sim_time_ns = 0
        """Time since the start [ns]."""
        self._upcoming = Upcoming(self._schedule, ("remove", "spawn", "door"))
        self._waiting: list[ScheduledEvent] = []
        """Spawns that are due, of robots whose place is occupied."""
        self._update_presence()

    def _update_presence(self) -> None:
        present = self.core.present()
        self.present: np.ndarray | None = None if present.all() else present
        """Whether each robot is present, bool, shape (n,); None if all are. The same object until that changes."""
        self.arrivals = tuple(self.core.arrivals())
        """Number of arrivals of each robot, including the start; the same object until a robot arrives or leaves."""

    def _is_present(self, robot_id: int) -> bool:
        """Raises: ValueError: no such robot."""
        if not 0 <= robot_id < self.num_robots:
            raise ValueError(f"robot_id must be in 0..{self.num_robots - 1}, got {robot_id}")
        return self.present is None or bool(self.present[robot_id])

    def _follow_schedule(self) -> None:
        """Apply the events that are due; those that no longer apply are skipped."""
        due, self._waiting = self._waiting + self._upcoming.due(self.sim_time_ns), []
        for event in due:
            if event.door is not None:
                self.set_door(event.door, bool(event.closed))
            elif event.remove is not None and self._is_present(event.remove):
                self.remove_robot(event.remove)
            elif event.spawn is not None and not self._is_present(event.spawn):
                try:
                    self.spawn_robot(event.spawn, event.pose and Pose(*event.pose))
                except PlacementError:
                    self._waiting.append(event)

    def _occupants(self) -> Occupants:
        """Return the current positions of robots, objects and leaves."""
        poses = [Pose(*row) for row in self.core.object_poses().tolist()]
        return Occupants(self.core.poses(), list(zip(self._objects, poses, strict=True)), self._doors)

    def _object_index(self, name: str) -> int:
        names = [obj.name for obj in self._objects]
        if name not in names:
            raise ValueError(f"unknown object '{name}'; known: {', '.join(names) or 'none'}")
        return names.index(name)

    def _update_doors(self) -> None:
        if self.core.doors_version != self._doors.version:
            states = [DoorState(door.closed, door.opening, door.motion) for door in self.core.door_states()]
            self._doors = DoorStates(dict(zip(self._door_ids, states, strict=True)), self.core.doors_version)

"""The contract of worlds: what everybody who uses a world relies on, whichever engine computes its physics.

`test/python/world/conformance` tests each world against it. Simulations, sensors, the ROS nodes and the viewer use
only these members.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Literal, Protocol

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sensors import Camera, LightSensor
from robotteamsim.scenario.sensors.base import Fan
from robotteamsim.world.doors import DoorStates

Mishap = Literal["tipped_over", "left_world"]
"""Why a robot cannot go on: it lies on its side or back, or it has left the world."""


class AnyWorld(Protocol):
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

    @property
    def num_robots(self) -> int:
        """Number of robots, present or not; ids count from 0."""

    @property
    def step_ns(self) -> int:
        """Length of a step [ns]."""

    def caster(self, fan: Fan) -> Callable[[Sequence[int]], np.ndarray]:
        """Return the function that casts these beams from some robots, by their ids, as the world is when it is called.

        It returns how far the beams reach, float64, shape (robots, beams) [m]; inf without a return.

        Walls, doors, objects and other robots return a beam, and so do floors in a world with heights; the robot itself
        does not. An absent robot gets no returns.
        """

    def illuminance_lx(self, robot_id: int, sensor: LightSensor) -> float:
        """Return what one of a robot's light sensors measures [lx]; 0 for an absent robot and without lights."""

    def image(self, robot_id: int, camera: Camera) -> np.ndarray:
        """Return what one of a robot's cameras sees, in the form of `FurtherReadings.images`.

        Raises: CameraError: nothing can be drawn on this computer or in this world.
        """

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None:
        """Advance by one step with one command per robot, in id order.

        The command of an absent robot is ignored.
        Args:   twists: as an array float64, shape (n, 3): forward, left [m/s], counter-clockwise [rad/s].
        Raises: ValueError: the number of twists is wrong, or one is not finite; then nothing has moved.
        """

    def team(self) -> _core.world.TeamMotion:
        """Return the last step of all robots as arrays in id order; see the methods with these names.

        poses, motions: float64, shape (n, 3): x, y [m], yaw [rad].
        twists:         float64, shape (n, 3): forward, left [m/s], counter-clockwise [rad/s].
        in_contact:     bool, shape (n,).
        """

    def poses(self) -> list[Pose]:
        """Return `map_T_base_link` of every robot, projected onto the floor; NaN for absent robots."""

    def positions_m(self) -> np.ndarray:
        """Return the robots' positions in `map`, float64, shape (n, 2) [m]; NaN for absent robots."""

    def twists(self) -> list[Twist]:
        """Return every robot's true mean velocity in the last step, in `base_link`.

        It is zero for a blocked robot, and has a sideways component for one that is pushed or slides along something.
        """

    def motions(self) -> list[Pose]:
        """Return every robot's motion in the last step: its pose at the end in the frame of that at the beginning.

        Teleporting (`set_pose`, `reset_positions`) does not count as motion.
        """

    def in_contact(self) -> list[bool]:
        """Return whether each robot touched something in the last step (came within 5 mm)."""

    def contact_angles_rad(self) -> dict[int, tuple[float, ...]]:
        """Return the directions of contacts in the last step, by id of the robots that touched something.

        Angles in `base_link`, ascending in (-pi, pi], from the robot's centre; contacts within 0.05 rad count as one.
        """

    def objects(self) -> dict[str, Pose]:
        """Return the pose of each object's centre in `map`, by name, in the scenario's order."""

    def object_models(self) -> tuple[MovableObject, ...]:
        """Return the present objects in the order of `objects`, with the poses at which they were added."""

    def door_states(self) -> DoorStates:
        """Return the state of all doors, by name, in the plan's order; its version grows with each change."""

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        """Move a robot to a pose, at rest.

        Raises: PlacementError: there is no room. ValueError: no such robot, it is absent, or the pose is not finite.
        """

    def remove_robot(self, robot_id: int) -> None:
        """Remove a robot. Raises: ValueError: no such robot, or it is absent."""

    def spawn_robot(self, robot_id: int, pose: Pose | None = None) -> None:
        """Spawn an absent robot at a pose, at rest; by default at its start pose.

        Raises: PlacementError: there is no room.
                ValueError: no such robot, it is already present, or the pose is not finite.
        """

    def add_object(self, obj: MovableObject) -> None:
        """Add an object at rest, at the end of the order.

        Raises: PlacementError: there is no room. ValueError: its name is taken.
        """

    def move_object(self, name: str, pose: Pose) -> None:
        """Move an object to a pose, at rest.

        Raises: PlacementError: there is no room. ValueError: no such object, or the pose is not finite.
        """

    def remove_object(self, name: str) -> None:
        """Remove an object. Raises: ValueError: no such object."""

    def lift_object(self, robot_id: int, name: str) -> None:
        """Let a robot's gripper hold an object, which moves with the robot until it is dropped.

        Raises: ValueError: no such robot or object, no gripper, or the object is too far, too heavy, behind a wall or
                held; also in a world without grippers.
        """

    def drop_object(self, robot_id: int) -> None:
        """Open a robot's gripper. A robot that is moved by `set_pose` or removed drops its load, too.

        Raises: ValueError: no such robot, or it holds nothing.
        """

    def set_door(self, name: str, closed: bool) -> None:
        """Close or open a door.

        An instant door changes at once and pushes robots in the way of its leaf aside. The leaf of any other swings or
        slides at constant speed in the following steps; it stops while something is in its way, and never pushes.

        Raises: ValueError: no such door.
        """

    def set_light(self, name: str, lit: bool) -> None:
        """Switch a light on or off. Raises: ValueError: no such light."""

    def reset_positions(self) -> None:
        """Move all present robots to their start poses, at rest; time, objects and doors stay as they are."""

    def reset(self) -> None:
        """Restore the initial state: time, poses, presence, objects and doors."""

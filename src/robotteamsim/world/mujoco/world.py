"""The world of MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from msgspec.structs import astuple

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import Run
from robotteamsim.scenario.sensors import Camera, LightSensor
from robotteamsim.scenario.sensors.base import Fan
from robotteamsim.world.contract import AnyWorld, Mishap
from robotteamsim.world.mujoco.cameras import Cameras
from robotteamsim.world.mujoco.engine import Engine
from robotteamsim.world.mujoco.lights import Lights
from robotteamsim.world.mujoco.rays import Rays


class MujocoWorld(AnyWorld):
    """A floor plan with heights, robots on wheels, and objects, in three dimensions.

    Motors turn the wheels at the speeds that the drive wants; friction of the tyres on the floor moves the robot.
    Wheels slip and robots lean, so a robot does not move exactly as its drive computes, and it may tip over. A robot
    that has left the bounds of the plan is removed.

    `AnyWorld` documents the members.
    """

    engine: Engine
    """Model and state of MuJoCo."""

    def caster(self, fan: Fan) -> Callable[[Sequence[int]], np.ndarray]:
        """See `AnyWorld.caster`."""
        return lambda robot_ids: np.stack([self._rays.ranges_m(robot_id, fan) for robot_id in robot_ids])

    def _make_physics(self, run: Run) -> Engine:
        self.engine = Engine(self.plan, self._robots, run, self._objects)
        self._rays = Rays(self.engine)
        self._lights = Lights(run.mujoco.lights, self._rays)
        self._cameras = Cameras(self.engine, self._lights)
        self._tipped_rad = run.mujoco.tipped_rad
        self._reaches_m = np.array([robot.reach_m for robot in self._robots])
        return self.engine

    def _add_body(self, obj: MovableObject) -> None:
        self.engine.add_object(obj)

    def step(self, twists: Sequence[Twist] | np.ndarray) -> None:
        """See `AnyWorld.step`."""
        super().step(twists)
        self._note_mishaps()

    def lift_object(self, robot_id: int, name: str) -> None:
        """See `AnyWorld.lift_object`."""
        who = f"robot_{robot_id}"
        if not self._is_present(robot_id):
            raise ValueError(f"{who} is not present; it cannot lift an object")
        robot, obj = self._robots[robot_id], self._objects[self._object_index(name)]
        gripper = robot.gripper
        thing = f"{obj.kind} '{name}'"
        if gripper is None:
            raise ValueError(f"{who} has no gripper; it needs robots.gripper")
        for holder, load in self.loads.items():
            if holder == robot_id or load == name:
                raise ValueError(f"robot_{holder} already holds '{load}'")
        if obj.mass_kg > gripper.max_mass_kg:
            raise ValueError(f"{who}: {thing} has {obj.mass_kg:g} kg; expected at most {gripper.max_mass_kg:g} kg")
        body, load_body = robot.body_at(astuple(self.poses()[robot_id])), obj.body_at(astuple(self.objects()[name]))
        self._free_space.check_reach(who, body, thing, load_body, gripper.reach_m, self.door_states())
        self.engine.lift_object(robot_id, self._object_index(name), gripper)
        self._note_loads()

    def drop_object(self, robot_id: int) -> None:
        """See `AnyWorld.drop_object`."""
        if robot_id not in self.loads:
            super().drop_object(robot_id)
        self.engine.drop_object(robot_id)
        self._note_loads()

    def set_pose(self, robot_id: int, pose: Pose) -> None:
        """See `AnyWorld.set_pose`."""
        super().set_pose(robot_id, pose)
        self._note_loads()

    def move_object(self, name: str, pose: Pose) -> None:
        """See `AnyWorld.move_object`."""
        super().move_object(name, pose)
        self._note_loads()

    def remove_object(self, name: str) -> None:
        """See `AnyWorld.remove_object`."""
        super().remove_object(name)
        self._note_loads()

    def illuminance_lx(self, robot_id: int, sensor: LightSensor) -> float:
        """See `AnyWorld.illuminance_lx`."""
        return self._lights.illuminance_lx(robot_id, sensor)

    def image(self, robot_id: int, camera: Camera) -> np.ndarray:
        """See `AnyWorld.image`."""
        return self._cameras.image(robot_id, camera)

    def close_cameras(self) -> None:
        """See `AnyWorld.close_cameras`."""
        self._cameras.close()

    def reset_positions(self) -> None:
        """See `AnyWorld.reset_positions`."""
        super().reset_positions()
        self._note_loads()

    def set_light(self, name: str, lit: bool) -> None:
        """See `AnyWorld.set_light`."""
        self._lights.set_lit(name, lit)

    def reset(self) -> None:
        """See `AnyWorld.reset`."""
        self._lights.reset()
        super().reset()

    def _update_presence(self) -> None:
        super()._update_presence()
        self._note_loads()

    def _note_loads(self) -> None:
        loads = self.engine.loads
        if loads != self.loads:
            self.loads = loads
            self.team_version += 1

    def _note_mishaps(self) -> None:
        tipped = self.engine.lean_rad() > self._tipped_rad  # not for NaN
        mishaps: dict[int, Mishap] = dict.fromkeys(np.flatnonzero(tipped).tolist(), "tipped_over")
        for robot_id in np.flatnonzero(self._has_left()).tolist():
            self.remove_robot(robot_id)
            mishaps[robot_id] = "left_world"
        left = {i: why for i, why in self.mishaps.items() if why == "left_world" and not self._is_present(i)}
        mishaps = dict(sorted((left | mishaps).items()))
        if mishaps != self.mishaps:
            self.mishaps = mishaps
            self.team_version += 1

    def _has_left(self) -> np.ndarray:
        """Return whether each robot is completely beyond the bounds of the plan."""
        positions_m, bounds = self.positions_m(), self.plan.bounds
        beyond = np.maximum(np.array(bounds.min) - positions_m, positions_m - np.array(bounds.max)).max(axis=1)
        has_left: np.ndarray = beyond > self._reaches_m  # not for NaN
        return has_left

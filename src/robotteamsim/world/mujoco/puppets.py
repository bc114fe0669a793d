"""Robots at given poses, without physics: what their cameras see of a recorded run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from robotteamsim.geometry import Pose
from robotteamsim.scenario.body import Body
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Camera
from robotteamsim.world.mujoco.bodies import robot_name
from robotteamsim.world.mujoco.building import leaf_name
from robotteamsim.world.mujoco.cameras import Scene
from robotteamsim.world.mujoco.leaves import Leaves
from robotteamsim.world.mujoco.looks import add_shadows
from robotteamsim.world.mujoco.model import make_spec
from robotteamsim.world.mujoco.ramps import ground_m
from robotteamsim.world.mujoco.team_state import FreeBodies

_OUT_OF_SIGHT_M = -100.0


class Puppets:
    """The bodies of a scenario; doors, objects and lamps are as at the start."""

    def __init__(self, scenario: Scenario, team: Sequence[PlacedRobot], viewer: int, camera: Camera) -> None:
        """Args: viewer: id of the robot that gets the camera."""
        self._viewer, self._camera, self._ramps = viewer, camera, scenario.run.mujoco.ramps
        self._robots = list(team)
        self._robots[viewer] = self._robots[viewer].model_copy(update={"sensors": (camera,)})
        placed = {robot_id: (robot, Pose(*robot.start_pose)) for robot_id, robot in enumerate(self._robots)}
        spec = make_spec(scenario.plan, placed, [(obj, Pose(*obj.pose)) for obj in scenario.objects], scenario.run)
        leaves = Leaves(scenario.plan)
        for index, door in enumerate(scenario.plan.doors):
            pose = leaves.pose(index)
            leaf = spec.body(leaf_name(door))
            leaf.pos = [0.0, 0.0, _OUT_OF_SIGHT_M] if pose is None else [pose.x_m, pose.y_m, 0.0]
        self.model = spec.compile()
        add_shadows(self.model, scenario.run.mujoco.lights)
        self.data = mujoco.MjData(self.model)
        self._bodies = FreeBodies(self.model, self.data, list(map(robot_name, placed)))
        self._scene = Scene(self, scenario.run.mujoco.lights)

    def body_id(self, robot_id: int) -> int | None:
        """See `rays.Bodies`."""
        return int(self._bodies.ids[robot_id])

    def image(self, poses: Mapping[int, Pose]) -> np.ndarray:
        """Return what the camera sees while robots are at poses, by id: uint8, shape (height, width, 3)."""
        for robot_id in range(len(self._robots)):
            pose = poses.get(robot_id)
            if pose is None:
                self._bodies.place(robot_id, Pose(0.0, 0.0, 0.0), _OUT_OF_SIGHT_M)
            else:
                self._bodies.place(robot_id, pose, ground_m(self._ramps, self._body(robot_id, pose)))
        mujoco.mj_kinematics(self.model, self.data)
        return self._scene.image(self._viewer, self._camera)

    def _body(self, robot_id: int, pose: Pose) -> Body:
        return self._robots[robot_id].body_at((pose.x_m, pose.y_m, pose.yaw_rad))

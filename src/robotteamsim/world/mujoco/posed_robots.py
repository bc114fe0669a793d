"""Robots at given poses, without physics: what their cameras see of a recorded run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
from msgspec.structs import astuple

from robotteamsim.geometry import Pose
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Camera
from robotteamsim.world.mujoco.appearance import add_shadows
from robotteamsim.world.mujoco.bodies import robot_name
from robotteamsim.world.mujoco.cameras import Cameras
from robotteamsim.world.mujoco.lights import Lights
from robotteamsim.world.mujoco.model import compiled, start_spec
from robotteamsim.world.mujoco.ramps import ground_m
from robotteamsim.world.mujoco.rays import Rays
from robotteamsim.world.mujoco.team_state import FreeBodies

_OUT_OF_SIGHT_M = -100.0


class PosedRobots:
    """The bodies of a scenario; doors, objects and lights are as at the start."""

    def __init__(self, scenario: Scenario, team: Sequence[PlacedRobot], viewer: int, camera: Camera) -> None:
        """Args: viewer: id of the robot that gets the camera."""
        settings = scenario.run.mujoco
        self._viewer, self._camera, self._ramps = viewer, camera, settings.ramps
        self._robots = list(team)
        self._robots[viewer] = self._robots[viewer].model_copy(update={"sensors": (camera,)})
        self.model = compiled(start_spec(scenario, dict(enumerate(self._robots))))
        add_shadows(self.model, settings.lights)
        self.data = mujoco.MjData(self.model)
        self._bodies = FreeBodies(self.model, self.data, list(map(robot_name, range(len(self._robots)))))
        self._cameras = Cameras(self, Lights(settings.lights, Rays(self)))

    def body_id(self, robot_id: int) -> int | None:
        """See `rays.Bodies`."""
        return int(self._bodies.ids[robot_id])

    def image(self, poses: Mapping[int, Pose]) -> np.ndarray:
        """Return what the camera sees while robots are at poses, by id: uint8, shape (height, width, 3)."""
        for robot_id, robot in enumerate(self._robots):
            pose = poses.get(robot_id)
            if pose is None:
                self._bodies.place(robot_id, Pose(0.0, 0.0, 0.0), _OUT_OF_SIGHT_M)
            else:
                self._bodies.place(robot_id, pose, ground_m(self._ramps, robot.body_at(astuple(pose))))
        mujoco.mj_kinematics(self.model, self.data)
        return self._cameras.image(self._viewer, self._camera)

"""What the camera of one robot saw in a recorded run, drawn again by MuJoCo from the recorded poses."""

from __future__ import annotations

import numpy as np

from robotteamsim.errors import CameraError
from robotteamsim.geometry import Pose
from robotteamsim.recording.replay.recorded_run import RecordedRun
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sensors import Camera
from robotteamsim.setup import resolve
from robotteamsim.world.mujoco.posed_robots import PosedRobots

_CAMERA = Camera(name="film", width_px=640, height_px=360, fov_rad=1.4)
"""Of a robot without a camera for colours."""


class RobotView:
    """Draws images for films. Doors, objects and lights are as at the start of the scenario."""

    def __init__(self, run: RecordedRun, scenario: Scenario, robot_id: int) -> None:
        """Raises: CameraError: the run or the scenario has no such robot."""
        self._tracks = {
            robot.robot_id: robot.track
            for robot in run.robots
            if robot.track.is_on_map and robot.robot_id is not None and robot.robot_id < scenario.num_robots
        }
        if robot_id not in self._tracks:
            known = ", ".join(map(str, self._tracks)) or "none"
            raise CameraError(
                f"--camera {robot_id}: no robot on the map in the bag and in {scenario.name}; known: {known}"
            )
        robots = resolve(scenario).robots
        cameras = (sensor for sensor in robots[robot_id].sensors if isinstance(sensor, Camera))
        colour = (camera for camera in cameras if camera.images == "rgb")
        self._posed = PosedRobots(scenario, robots, robot_id, next(colour, _CAMERA))
        self.title = f"camera of robot {robot_id}"

    def image(self, stamp_ns: int) -> np.ndarray:
        """See `film.View`."""
        poses = {
            robot_id: Pose(*track.poses[track.index_at(stamp_ns)].tolist())
            for robot_id, track in self._tracks.items()
            if track.is_present(stamp_ns)
        }
        return self._posed.image(poses)

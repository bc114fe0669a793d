"""Images of the robots' cameras, drawn by OpenGL without a screen."""

from __future__ import annotations

import math
import os
import sys
from typing import Any, ClassVar

import mujoco
import numpy as np

from robotteamsim.errors import CameraError
from robotteamsim.scenario.sections import Robot
from robotteamsim.scenario.sensors import Camera
from robotteamsim.world.mujoco import INSTALL_EGL
from robotteamsim.world.mujoco.lights import Lights
from robotteamsim.world.mujoco.rays import Bodies
from robotteamsim.world.mujoco.shapes import about_z

_AHEAD = [0.5, 0.5, -0.5, -0.5]
"""The quaternion of a camera that looks along the x axis, with z up."""


def cameras_of(robot: Robot) -> list[Camera]:
    """Return the cameras of a robot."""
    return [sensor for sensor in robot.sensors if isinstance(sensor, Camera)]


def camera_name(robot_name: str, camera: Camera) -> str:
    """Return the name of a camera in the model."""
    return f"{robot_name}/{camera.name}"


def add_camera(body: Any, name: str, camera: Camera) -> None:
    """Add a camera to the body of a robot in the spec."""
    quat = np.empty(4)
    mujoco.mju_mulQuat(quat, np.array(about_z(camera.yaw_rad)), np.array(_AHEAD))
    fovy_rad = 2.0 * math.atan(0.5 * camera.height_px / camera.focal_px)
    place = [camera.forward_m, camera.left_m, camera.height_m]
    body.add_camera(name=name, pos=place, quat=quat, fovy=math.degrees(fovy_rad))


class Cameras:
    """The cameras of all robots."""

    _process: ClassVar[int | None] = None
    """State of the process, not of a world: which one has drawn.

    The threads of OpenGL do not survive a fork: a child would wait for them for ever.
    """

    def __init__(self, bodies: Bodies, lights: Lights) -> None:
        self._bodies, self._lights = bodies, lights
        self._model: mujoco.MjModel | None = None
        self._renderers: dict[tuple[int, int], mujoco.Renderer] = {}
        self._shown = mujoco.MjvOption()
        self._shown.geomgroup[:] = 1  # objects and wheels, too

    def image(self, robot_id: int, camera: Camera) -> np.ndarray:
        """See `AnyWorld.image`."""
        body = self._bodies.body_id(robot_id)
        if body is None:
            shape = (camera.height_px, camera.width_px)
            return np.zeros((*shape, 3), np.uint8) if camera.images == "rgb" else np.zeros(shape, np.float32)
        model, data = self._bodies.model, self._bodies.data
        self._lights.show(model)
        mujoco.mj_camlight(model, data)
        renderer = self._renderer(model, camera)
        renderer.update_scene(data, camera_name(model.body(body).name, camera), self._shown)
        if camera.images == "rgb":
            image: np.ndarray = renderer.render().copy()
            return image
        renderer.enable_depth_rendering()
        depth_m: np.ndarray = renderer.render().copy()
        renderer.disable_depth_rendering()
        return depth_m

    def close(self) -> None:
        """See `AnyWorld.close_cameras`."""
        for renderer in self._renderers.values():
            renderer.close()
        self._renderers = {}

    def _renderer(self, model: mujoco.MjModel, camera: Camera) -> mujoco.Renderer:
        """Return the renderer for a size; a new model needs new ones."""
        if Cameras._process not in (None, os.getpid()):
            raise CameraError("robots.sensors: no image can be drawn in a fork of a process that has drawn")
        Cameras._process = os.getpid()
        if model is not self._model:
            self.close()
            self._model = model
        size = camera.height_px, camera.width_px
        if size not in self._renderers:
            try:
                self._renderers[size] = mujoco.Renderer(model, *size)
            # The bindings of OpenGL raise errors of many types where a library or a device is missing.
            except Exception as error:
                raise CameraError(
                    f"robots.sensors: no image can be drawn ({type(error).__name__}); {INSTALL_EGL}, "
                    "and set MUJOCO_GL=egl if mujoco is imported first"
                ) from error
        return self._renderers[size]


def _leave_display_to_parent() -> None:
    """In a forked process: at its exit, MuJoCo would close the display and wait for threads that the fork lacks."""
    if egl := sys.modules.get("mujoco.egl"):
        egl.EGL_DISPLAY = None  # type: ignore[attr-defined]


if sys.platform != "win32":
    os.register_at_fork(after_in_child=_leave_display_to_parent)

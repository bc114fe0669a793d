"""How the world looks to cameras: light, sky, shadows and the markings on the floor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco

from robotteamsim.palette import FAINT_INK, GRID, PAPER, ROBOT_BODY, SOFT_INK, WALL_EDGE
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.mujoco import Light
from robotteamsim.scenario.plan import painted_lines
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Camera
from robotteamsim.world.mujoco.shapes import WHEEL_GROUP, about_z, rgba
from robotteamsim.world.mujoco.wheels import Chassis

FLOOR = "floor"
"""The material of the floor."""

_NEAREST_M = 0.02
"""Cameras see nothing that is nearer."""
_TILE_M = 2.0
_LINE_M = 0.1
_PAINT_M = 0.002
_SUN = (0.45, 0.3, -0.84)
_DOME_M = 0.05
_REFLECTANCE = 0.06


def set_appearance(spec: mujoco.MjSpec, plan: FloorPlan, cameras: Sequence[Camera], lights: Sequence[Light]) -> None:
    """Set light, sky, distances and sizes for cameras; a scenario with lights has no sun."""
    visual, diagonal_m = spec.visual, math.dist(plan.bounds.min, plan.bounds.max)
    spec.stat.extent = 1.0  # the unit of the distances below
    visual.map.znear = _NEAREST_M
    visual.map.zfar = 2.0 * diagonal_m
    visual.map.shadowclip = 0.7 * diagonal_m
    visual.quality.shadowsize = 1024
    visual.global_.offwidth = max([640, *(camera.width_px for camera in cameras)])
    visual.global_.offheight = max([480, *(camera.height_px for camera in cameras)])
    ambient, diffuse = (0.2, 0.15) if lights else (0.4, 0.25)
    visual.headlight.ambient, visual.headlight.diffuse = [ambient] * 3, [diffuse] * 3
    visual.headlight.specular = [0.0] * 3
    if lights:
        visual.quality.numquads = 16  # OpenGL computes illumination at the corners of these
    else:
        _add_sun(spec, plan)
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=rgba(SOFT_INK if lights else GRID)[:3],
        rgb2=rgba(ROBOT_BODY if lights else SOFT_INK)[:3],
        width=128,
        height=768,
    )
    _add_tiles(spec)
    for index, (start, end) in enumerate(painted_lines(plan)):
        _add_line(spec, f"bay {index}", start, end)


def add_shadows(model: mujoco.MjModel, lights: Sequence[Light]) -> None:
    """Add the shadows of the sun and reflections of the floor, which would triple the time of robots' images."""
    model.light_castshadow[:] = not lights
    model.material(FLOOR).reflectance = _REFLECTANCE


def add_dome(body: Any, name: str, robot: PlacedRobot, bottom_m: float) -> None:
    """Add the housing of the laser on top of a robot, which only cameras see."""
    radius_m = 0.3 * Chassis.of(robot).half_width_m
    keys = {"contype": 0, "conaffinity": 0, "group": WHEEL_GROUP, "mass": 0.0, "rgba": rgba(ROBOT_BODY)}
    body.add_geom(
        name=f"{name}/dome",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=[radius_m, 0.5 * _DOME_M, 0.0],
        pos=[0.0, 0.0, bottom_m + 0.5 * _DOME_M],
        **keys,
    )


def _add_sun(spec: mujoco.MjSpec, plan: FloorPlan) -> None:
    away_m = 0.6 * math.dist(plan.bounds.min, plan.bounds.max)
    middle = [0.5 * (low + high) for low, high in zip(plan.bounds.min, plan.bounds.max, strict=True)]
    spec.worldbody.add_light(
        name="sun",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=[middle[0] - away_m * _SUN[0], middle[1] - away_m * _SUN[1], -away_m * _SUN[2]],
        dir=list(_SUN),
        diffuse=[0.75, 0.73, 0.69],
        specular=[0.1, 0.1, 0.1],
        castshadow=False,
    )


def _add_tiles(spec: mujoco.MjSpec) -> None:
    texture = spec.add_texture(
        name=FLOOR,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=rgba(WALL_EDGE)[:3],
        rgb2=rgba(WALL_EDGE)[:3],
        markrgb=rgba(FAINT_INK)[:3],
        width=512,
        height=512,
    )
    material = spec.add_material(name=FLOOR, texuniform=True, texrepeat=[1.0 / _TILE_M] * 2)
    textures = material.textures
    textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = texture.name
    material.textures = textures


def _add_line(spec: mujoco.MjSpec, name: str, start: tuple[float, float], end: tuple[float, float]) -> None:
    (x0, y0), (x1, y1) = start, end
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.5 * math.dist(start, end), 0.5 * _LINE_M, _PAINT_M],
        pos=[0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0],
        quat=about_z(math.atan2(y1 - y0, x1 - x0)),
        contype=0,
        conaffinity=0,
        group=WHEEL_GROUP,
        rgba=rgba(PAPER),
    )

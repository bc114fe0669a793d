"""Lights: small spheres that shine equally in all directions, for light sensors and for cameras."""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from robotteamsim.palette import YELLOW
from robotteamsim.scenario.mujoco import Light
from robotteamsim.scenario.sensors import LightSensor
from robotteamsim.world.mujoco.rays import Rays
from robotteamsim.world.mujoco.shapes import LIGHT_GROUP, rgba

MOST_DRAWN = 7
"""OpenGL draws this many lights, besides the light at the camera."""
_BULB_M = 0.05
_WHITE_LX = 20.0
"""In images a white surface with this illuminance, or more, is white."""


def add_lights(spec: mujoco.MjSpec, lights: Sequence[Light]) -> None:
    """Add the lights of a scenario to a spec. Beams pass through them."""
    for index, light in enumerate(lights):
        place = [*light.position, light.height_m]
        if index < MOST_DRAWN:
            spec.worldbody.add_light(
                name=light.name,
                pos=place,
                type=mujoco.mjtLightType.mjLIGHT_SPOT,
                dir=[0.0, 0.0, -1.0],
                cutoff=180.0,
                exponent=0.0,
                diffuse=[1.0, 1.0, 1.0],
                attenuation=[0.05, 0.0, _WHITE_LX / light.intensity_cd],
                castshadow=False,
            )
        bulb = spec.add_material(name=f"light {light.name}", rgba=rgba(YELLOW), emission=1.0)
        spec.worldbody.add_geom(
            name=f"light {light.name}",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[_BULB_M, 0.0, 0.0],
            pos=place,
            contype=0,
            conaffinity=0,
            group=LIGHT_GROUP,
            material=bulb.name,
        )


class Lights:
    """The lights of a world, and which of them are lit."""

    def __init__(self, lights: Sequence[Light], rays: Rays) -> None:
        self._lights, self._rays = tuple(lights), rays
        self._places_m = np.array([(*light.position, light.height_m) for light in lights]).reshape(-1, 3)
        self._intensities_cd = np.array([light.intensity_cd for light in lights])
        self.reset()

    def reset(self) -> None:
        """Restore which lights are lit at the start."""
        self._lit = np.array([light.lit for light in self._lights], dtype=bool)

    def set_lit(self, name: str, lit: bool) -> None:
        """Switch a light. Raises: ValueError: no such light."""
        names = [light.name for light in self._lights]
        if name not in names:
            raise ValueError(f"unknown light '{name}'; known: {', '.join(names) or 'none'}")
        self._lit[names.index(name)] = lit

    def show(self, model: mujoco.MjModel) -> None:
        """Switch the lights of a model."""
        drawn = self._lit[:MOST_DRAWN]
        model.light_active[: len(drawn)] = drawn
        for light, lit in zip(self._lights, self._lit, strict=True):
            model.material(f"light {light.name}").emission[:] = float(lit)

    def illuminance_lx(self, robot_id: int, sensor: LightSensor) -> float:
        """Return the sum of I cos(a) / d^2 over lit lights in sight, where a is the angle to the sensor's axis."""
        placed = self._rays.axis(robot_id, sensor)
        if placed is None or not self._lit.any():
            return 0.0
        origin, axis = placed
        offsets_m = self._places_m[self._lit] - origin
        distances_m = np.maximum(np.linalg.norm(offsets_m, axis=1), _BULB_M)
        directions = offsets_m / distances_m[:, None]
        ranges_m = self._rays.cast_m(robot_id, origin, directions, float(distances_m.max()))
        reached = np.maximum(directions @ axis, 0.0) * (ranges_m >= distances_m)
        return math.fsum(self._intensities_cd[self._lit] * reached / distances_m**2)

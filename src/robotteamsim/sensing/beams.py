"""The beams of lasers and sonars in any world: measured ranges as sensors report them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.hazards import HazardField, HazardSource
from robotteamsim.scenario.sensors.base import BeamModel
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.core_parts import core_fan


def core_limits(model: BeamModel) -> _core.sensing.RangeLimits:
    """Return what a sensor reports instead of ranges beyond its limits.

    A beam that hits nothing within range_max reads range_max, or +inf if the model says so. One that hits something
    nearer than range_min reads range_min, or -inf (REP-117).
    """
    return _core.sensing.RangeLimits(
        range_min_m=model.range_min_m,
        range_max_m=model.fan.range_max_m,
        too_near_m=model.too_near_m,
        no_return_m=model.no_return_m,
    )


class Beams:
    """The beams of one kind of sensor in a world."""

    def __init__(self, world: AnyWorld, model: BeamModel) -> None:
        self._world, self._cast = world, world.caster(model.fan)
        self._core_fan, self._no_return_m = core_fan(model.fan), model.no_return_m
        self._limits = core_limits(model)

    def scan(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """Return the reported ranges, float32, shape (robots, beams) [m].

        Args: noise_m: added to the ranges, shape (robots, beams); empty without noise.
        """
        return _core.sensing.report(self._limits, self._cast(robot_ids), noise_m)

    def nearest(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """Return the nearest return of each robot, as it is reported, float32, shape (robots,) [m].

        Args: noise_m: added to it, shape (robots, 1); empty without noise.
        """
        nearest_m = self._cast(robot_ids).min(axis=1, keepdims=True)
        return _core.sensing.report(self._limits, nearest_m, noise_m)[:, 0]

    def dim(self, robot_ids: Sequence[int], haze: _core.hazards.Haze, ranges_m: np.ndarray) -> None:
        """Remove the returns that smoke hides. Args: ranges_m: as from `scan`, changed in place."""
        poses = self._world.motion()[0][robot_ids]
        _core.sensing.dim(self._core_fan, poses, haze, self._no_return_m, ranges_m)


class SmokyAir:
    """The air of a world, as sensors find it. Smoke hides the returns of lasers; it does not stop ultrasound."""

    def __init__(self, hazards: HazardSource) -> None:
        self._hazards = hazards
        self._haze_version = -1
        self._haze: _core.hazards.Haze | None = None

    @property
    def is_new(self) -> bool:
        """Whether fire and smoke have advanced in the last step."""
        return self._hazards.updated

    @property
    def field(self) -> HazardField:
        """Fire, smoke and temperature as of the last update."""
        return self._hazards.field

    @property
    def haze(self) -> _core.hazards.Haze:
        """The smoke as an obstacle for light: returns from beyond `fire.soot.laser_optical_depth` are hidden."""
        if self._haze is None or self._hazards.version != self._haze_version:
            self._haze_version, self._haze = self._hazards.version, _haze(self.field)
        return self._haze


def _haze(field: HazardField) -> _core.hazards.Haze:
    """Return the smoke as an obstacle for light."""
    soot = field.fire.soot
    return _core.hazards.Haze(
        field.origin_m, field.resolution_m, field.soot_g_m3, soot.extinction_m2_g, soot.laser_optical_depth
    )

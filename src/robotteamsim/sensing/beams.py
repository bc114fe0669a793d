"""The beams of lasers and sonars in any world: measured ranges as sensors report them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.hazards import HazardField, HazardSource
from robotteamsim.scenario.sensors import Laser as LaserModel
from robotteamsim.scenario.sensors.base import BeamModel
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.core_parts import core_fan


class Beams:
    """The beams of one kind of sensor in a world."""

    def __init__(self, world: AnyWorld, model: BeamModel) -> None:
        self._world, self._cast = world, world.caster(model.fan)
        self._core_fan, self._no_return_m = core_fan(model.fan), model.no_return_m
        self._limits = _core.sensing.RangeLimits(
            range_min_m=model.range_min_m,
            range_max_m=model.fan.range_max_m,
            too_near_m=model.too_near_m,
            no_return_m=model.no_return_m,
        )

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
        poses = self._world.team().poses[robot_ids]
        _core.sensing.dim(self._core_fan, poses, haze, self._no_return_m, ranges_m)


_NO_NOISE = np.empty((0, 0))


class Laser:
    """The lasers of one kind in a world.

    A beam that hits nothing within range_max reads range_max, or +inf if the model says so. One that hits something
    nearer than range_min reads range_min, or -inf (REP-117).
    """

    def __init__(self, model: LaserModel, world: AnyWorld) -> None:
        self._model = model
        self.beams = Beams(world, model.beam_model())
        """The beams of these lasers."""

    def scan(self, robot_ids: Sequence[int], generators: Sequence[np.random.Generator]) -> np.ndarray:
        """Return the current ranges, float32, shape (robots, beams), the first beam at angle_min [m].

        Args: generators: of each robot's noise; not used if the model has no noise.
        """
        return self.beams.scan(robot_ids, self._noise_m(generators))

    def _noise_m(self, generators: Sequence[np.random.Generator]) -> np.ndarray:
        """Draw the noise of one scan of each robot, float64, shape (robots, beams) [m]; empty without noise."""
        if self._model.noise_m > 0.0:
            return np.stack([each.normal(0.0, self._model.noise_m, self._model.beams) for each in generators])
        return _NO_NOISE


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

    def dim(self, beams: Beams, robot_ids: Sequence[int], ranges_m: np.ndarray) -> None:
        """Remove the returns that smoke hides, in place: those from beyond `fire.soot.laser_optical_depth`.

        Args: ranges_m: the scans of these robots, float32, shape (robots, beams) [m].
        """
        if self._hazards.version != self._haze_version:
            self._haze_version, self._haze = self._hazards.version, _haze(self.field)
        assert self._haze is not None
        beams.dim(robot_ids, self._haze, ranges_m)


def _haze(field: HazardField) -> _core.hazards.Haze:
    """Return the smoke as an obstacle for light."""
    soot = field.fire.soot
    return _core.hazards.Haze(
        field.origin_m, field.resolution_m, field.soot_g_m3, soot.extinction_m2_g, soot.laser_optical_depth
    )

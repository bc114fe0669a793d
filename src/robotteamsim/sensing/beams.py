"""The beams of lasers and sonars, in any world: measured ranges as sensors report them."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.world.contract import AnyWorld, Fan, Scene
from robotteamsim.world.core_parts import core_solids


@dataclass(frozen=True, slots=True)
class BeamModel:
    """Beams with equal angles between them, from one point of a robot.

    angle_min_rad, angle_max_rad: of the first and of the last beam in base_link.
    forward_m, left_m, height_m:  their origin in base_link.
    too_near_m, no_return_m:      reported for ranges below range_min_m and above range_max_m.
    """

    beams: int
    angle_min_rad: float
    angle_max_rad: float
    forward_m: float
    left_m: float
    height_m: float
    range_min_m: float
    range_max_m: float
    too_near_m: float
    no_return_m: float


class Beams(Protocol):
    """The sensors of one kind in one world."""

    def scan(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """Return the reported ranges, float32, shape (robots, beams) [m].

        Args: noise_m: added to the ranges, shape (robots, beams); empty without noise.
        """

    def nearest(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """Return the nearest return of each robot, as it is reported, float32, shape (robots,) [m].

        Args: noise_m: added to it, shape (robots,); empty without noise.
        """


def beams_in(world: AnyWorld, model: BeamModel) -> Beams:
    """Return the beams of one kind in a world."""
    scene = world.scene
    if isinstance(scene, _core.world.World):
        return PlanarBeams(scene, planar_laser(world.plan, model))
    return RayBeams(scene, model)


# Worlds on one plan share lasers, because they store visible edges per cell.
@functools.lru_cache(maxsize=64)
def planar_laser(plan: FloorPlan, model: BeamModel) -> _core.sensing.Laser:
    """Return the C++ lasers of one kind on a plan."""
    return _core.sensing.Laser(
        *core_solids(plan),
        beams=model.beams,
        angle_min_rad=model.angle_min_rad,
        angle_max_rad=model.angle_max_rad,
        forward_m=model.forward_m,
        range_min_m=model.range_min_m,
        range_max_m=model.range_max_m,
        too_near_m=model.too_near_m,
        no_return_m=model.no_return_m,
        left_m=model.left_m,
    )


class PlanarBeams:
    """Beams in the plane, computed in C++."""

    def __init__(self, scene: _core.world.World, laser: _core.sensing.Laser) -> None:
        self._scene = scene
        self.laser = laser
        """The C++ laser."""

    def scan(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """See `Beams.scan`."""
        return self.laser.scan(self._scene, robot_ids, noise_m)

    def nearest(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """See `Beams.nearest`."""
        return self.laser.nearest(self._scene, robot_ids, noise_m)


class RayBeams:
    """Beams as rays of a world whose bodies have heights."""

    def __init__(self, caster: Scene, model: BeamModel) -> None:
        angles_rad = np.linspace(model.angle_min_rad, model.angle_max_rad, model.beams)
        self._caster = caster
        self._model = model
        self._fan = Fan(angles_rad, model.forward_m, model.left_m, model.height_m, model.range_max_m)

    def scan(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """See `Beams.scan`."""
        return self._reported(self._ranges_m(robot_ids), noise_m)

    def nearest(self, robot_ids: Sequence[int], noise_m: np.ndarray) -> np.ndarray:
        """See `Beams.nearest`."""
        return self._reported(self._ranges_m(robot_ids).min(axis=1), noise_m)

    def _ranges_m(self, robot_ids: Sequence[int]) -> np.ndarray:
        return np.stack([self._caster.ranges_m(robot_id, self._fan) for robot_id in robot_ids])

    def _reported(self, ranges_m: np.ndarray, noise_m: np.ndarray) -> np.ndarray:
        model, noisy_m = self._model, ranges_m + noise_m if noise_m.size else ranges_m
        near_m = np.where(noisy_m >= model.range_min_m, noisy_m, model.too_near_m)
        return np.where(noisy_m > model.range_max_m, model.no_return_m, near_m).astype(np.float32)

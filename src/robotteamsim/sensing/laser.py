"""The laser range finder, which detects walls, doors, objects and other robots."""

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.scenario.sensors import Laser as LaserModel
from robotteamsim.scenario.sensors import MountedLaser
from robotteamsim.sensing.beams import BeamModel, beams_in
from robotteamsim.world.contract import AnyWorld

_NO_NOISE = np.empty((0, 0))


class Laser:
    """The lasers of one kind in a world.

    A beam that hits nothing within range_max reads range_max, or +inf if the model says so. One that hits something
    nearer than range_min reads range_min, or -inf (REP-117).
    """

    def __init__(self, model: LaserModel, world: AnyWorld) -> None:
        self._model = model
        self.num_beams = model.beams
        self.beams = beams_in(world, _beam_model(model))
        """The beams of these lasers."""

    def scan(self, robot_ids: Sequence[int], generators: Sequence[np.random.Generator]) -> np.ndarray:
        """Return the current ranges, float32, shape (robots, beams), the first beam at angle_min [m].

        Args: generators: of each robot's noise; not used if the model has no noise.
        """
        return self.beams.scan(robot_ids, self.noise_m(generators))

    def noise_m(self, generators: Sequence[np.random.Generator]) -> np.ndarray:
        """Draw the noise of one scan of each robot, float64, shape (robots, beams) [m]; empty without noise."""
        if self._model.noise_m > 0.0:
            return np.stack([each.normal(0.0, self._model.noise_m, self._model.beams) for each in generators])
        return _NO_NOISE


def _beam_model(model: LaserModel) -> BeamModel:
    as_rep_117 = model.no_return == "inf"
    left_m, yaw_rad = (model.left_m, model.yaw_rad) if isinstance(model, MountedLaser) else (0.0, 0.0)
    return BeamModel(
        beams=model.beams,
        angle_min_rad=yaw_rad + model.angle_min_rad,
        angle_max_rad=yaw_rad + model.angle_max_rad,
        forward_m=model.forward_m,
        left_m=left_m,
        height_m=model.height_m,
        range_min_m=model.range_min_m,
        range_max_m=model.range_max_m,
        too_near_m=-math.inf if as_rep_117 else model.range_min_m,
        no_return_m=math.inf if as_rep_117 else model.range_max_m,
    )

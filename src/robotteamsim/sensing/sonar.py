"""Sonars: the range of the nearest obstacle within a cone."""

import numpy as np

from robotteamsim.scenario.sensors import Sonar as SonarModel
from robotteamsim.sensing.beams import BeamModel, beams_in
from robotteamsim.world.contract import AnyWorld

_NO_NOISE = np.empty(0)


class Sonar:
    """The sonars of one kind in a world.

    A sonar reads the shortest of the rays in its cone, which are cast like a laser's beams; obstacles narrower than the
    gap between two rays may be missed. Without a return it reads range_max; for anything nearer than range_min it reads
    range_min.
    """

    def __init__(self, model: SonarModel, world: AnyWorld) -> None:
        self._model = model
        self._beams = beams_in(world, _beam_model(model))

    def read(self, robot_id: int, generator: np.random.Generator) -> float:
        """Return the current range of a robot's sonar, a float32 [m].

        Args: generator: of its noise; not used if the model has no noise.
        """
        noise_m = generator.normal(0.0, self._model.noise_m, 1) if self._model.noise_m > 0.0 else _NO_NOISE
        return float(self._beams.nearest([robot_id], noise_m)[0])


def _beam_model(model: SonarModel) -> BeamModel:
    return BeamModel(
        beams=model.rays,
        angle_min_rad=model.yaw_rad - 0.5 * model.opening_rad,
        angle_max_rad=model.yaw_rad + 0.5 * model.opening_rad,
        forward_m=model.forward_m,
        left_m=model.left_m,
        height_m=model.height_m,
        range_min_m=model.range_min_m,
        range_max_m=model.range_max_m,
        too_near_m=model.range_min_m,
        no_return_m=model.range_max_m,
    )

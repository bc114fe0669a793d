"""The laser range finder, which detects walls, doors, objects and other robots."""

from collections.abc import Sequence

import numpy as np

from robotteamsim.scenario.sensors import Laser as LaserModel
from robotteamsim.sensing.beams import Beams
from robotteamsim.world.contract import AnyWorld

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

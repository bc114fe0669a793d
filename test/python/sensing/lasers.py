"""The beams of one laser, without the rest of a robot's sensors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.scenario.sections import Laser
from robotteamsim.sensing.beams import Beams
from robotteamsim.world.contract import AnyWorld


class LaserBeams:
    """Scans with a laser that some robots of a world carry."""

    def __init__(self, model: Laser, world: AnyWorld) -> None:
        self._model, self._beams = model, Beams(world, model.beam_model())

    def scan(self, robot_ids: Sequence[int], generators: Sequence[np.random.Generator]) -> np.ndarray:
        """Return the ranges, shape (robots, beams) [m]. Args: generators: of each robot's noise."""
        model, noise_m = self._model, np.empty((0, 0))
        if model.noise_m > 0.0:
            noise_m = np.stack([each.normal(0.0, model.noise_m, model.beams) for each in generators])
        return self._beams.scan(robot_ids, noise_m)

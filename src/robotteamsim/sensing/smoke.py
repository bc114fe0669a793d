"""How smoke hides the returns of lasers. Sonars are not affected: smoke does not stop ultrasound."""

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.hazards import HazardField, HazardSource
from robotteamsim.sensing.beams import Beams


class SmokyAir:
    """The air of a world, as sensors find it."""

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

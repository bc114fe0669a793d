"""How likely a robot hears victims at other places, as infotaxis assumes."""

from __future__ import annotations

import numpy as np

from robotteamsim.propagation import VoiceField, VoiceSource
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.sections import Voice
from robotteamsim.swarm import Vector


class Hearing:
    """The probability of hearing a victim at each of some places from each other one, through all walls.

    The constants l_c and gamma of eq. (7) are unknown, within the ranges of `voice`; the level is taken as uniform
    between those of the quietest and the loudest voice. Losses are the same in both directions, so that a voice map of
    the robot's own place has the levels that it would hear. Doors have their states at the start.
    """

    def __init__(self, building: Building, voice: Voice, places: tuple[Vector, ...]) -> None:
        # Without noise, levels that are not heard are known, too.
        self._field = VoiceField(building.plan, voice.model_copy(update={"noise_db": 0.0}))
        self._voice, self._places = voice, places
        self._places_m = np.array(places)
        self._rows: dict[int, np.ndarray] = {}

    def probabilities(self, index: int) -> np.ndarray:
        """Return the probability of hearing a victim at each place from the place `index`, shape (places,)."""
        row = self._rows.get(index)
        if row is None:
            row = self._rows[index] = self._row(index)
        return row

    def _row(self, index: int) -> np.ndarray:
        (loud, quiet), (far, near) = self._voice.constant_db, self._voice.exponent
        loudest = self._field.map_db([VoiceSource(self._places[index], loud, far)])
        cells = np.floor((self._places_m - loudest.origin_m) / loudest.resolution_m).astype(int)
        high_db = loudest.values[cells[:, 1], cells[:, 0]].astype(float)
        away_m = np.maximum(np.hypot(*(self._places_m - self._places_m[index]).T), 1.0)
        spread_db = quiet - loud + 10.0 * (near - far) * np.log10(away_m)
        over_db = high_db - self._voice.noise_db
        # With one possible voice, the spread is 0 and the answer is yes or no.
        share = np.where(spread_db > 0.0, over_db / np.maximum(spread_db, 1e-9), over_db > 0.0)
        heard = np.where((high_db > 0.0) & (over_db > 0.0), np.clip(share, 0.0, 1.0), 0.0)
        heard[index] = 1.0
        return heard


def hearing(building: Building, voice: Voice, places: tuple[Vector, ...]) -> Hearing:
    """Return the hearing model of some places, which robots share."""
    return building.shared(Hearing, voice, places)

"""Finding the source of a voice that a robot hears."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from robotteamsim import _core
from robotteamsim.control.search.cells import CellGrid
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Voice
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.swarm import Vector

_RULED_OUT = 1e-6
"""Factor of the probability of places that the belief excludes: the belief may be wrong."""

_LARGEST_MISFIT = 4.0
_FEWEST_LEVELS = 6
"""After so many levels a misfit means that they come from two voices, or that a victim walks."""

_BESIDE_M = 2.5
"""A robot that hears the faintest victim from so near follows the voice itself [m]."""

_STILL_LIKELY = 0.05
"""A voice that is no longer heard is not approached further if its place is less probable, as a share of the prior."""

_DEVIATION = math.sqrt(1.0 / 12.0)
"""Standard deviation of a uniform distribution over an interval of length 1."""


def spread(low: float, high: float, least: float) -> tuple[float, float]:
    """Return the mean and the standard deviation of a uniform distribution, the latter at least `least`."""
    return 0.5 * (low + high), max(_DEVIATION * (high - low), least)


@dataclass(slots=True)
class Hunted:
    """A voice that the robot hears, or heard before the path to its source led away from it.

    cell:     where the victim probably is.
    source_m: the centre of that cell, in `map` [m].
    follow_m: the loudest place, if the robot is next to the victim; None if it is not.
    """

    cell: int
    source_m: Vector
    follow_m: Vector | None


class Hunt:
    """Estimates where the voice comes from that a robot hears, from the levels at all places since it first heard it.

    The path around a wall may lead where the voice is not heard: the source is kept until the belief excludes it. If
    another voice is heard there, the robot comes back to the first one afterwards. A robot that has been next to a cell
    would have saved the victim there.
    """

    def __init__(self, scenario: Scenario, grid: CellGrid) -> None:
        voice = scenario.voice
        self._grid = grid
        low_db, high_db = voice.constant_db
        self._loudness_db = spread(-high_db, -low_db, 0.5)
        self._exponent = spread(*voice.exponent, 0.05)
        self._beside_db = _level_at(_BESIDE_M, voice)
        self._saved_within_m = max(scenario.mission.save_distance_m - 0.7 * grid.cell_m, 0.3)
        self._fix: _core.control.VoiceFix | None = None
        self._source: Hunted | None = None
        self._was_heard = False
        self._left: dict[int, Hunted] = {}
        """Sources that were not heard on the way to them, before a voice was heard again, by cell: the first one there.

        The voice that was heard again is the same one, or another."""
        self._prior: np.ndarray | None = None
        self._visited: set[int] = set()
        self._heard_at: set[Vector] = set()
        self._epoch = -1

    def follow(
        self,
        voice: VoiceReading,
        epoch: int,
        position: Vector,
        losses: _core.control.VoiceLosses,
        mass: np.ndarray,
        prior: np.ndarray,
    ) -> Hunted | None:
        """Return the voice of this iteration; None if nothing is heard, and what was heard before is unlikely now.

        Args: epoch: of the task: a new one may have ended the voice.
              mass, prior: of each cell, what the belief leaves and what it started with.
        """
        if not voice.heard or not math.isfinite(voice.local_best_level_db):
            self._was_heard = False
            while self._source is None or not self._is_likely(self._source.cell, mass, prior):
                self.forget()
                if not self._left:
                    return None
                self._source = self._left.popitem()[1]
            return replace(self._source, follow_m=None)
        if self._source is not None and not self._was_heard:
            self._left.setdefault(self._source.cell, self._source)
        self._was_heard = True
        if self._fix is None or epoch != self._epoch or self._prior is None:
            self._epoch = epoch
            self._prior = mass + np.float32(_RULED_OUT) * prior
            self._visited.clear()
            self._restart(losses)
        assert self._fix is not None
        self._add(voice, position)
        source = self._fix.most_probable(self._prior)
        if source is not None and source[1] > _LARGEST_MISFIT and self._fix.count >= _FEWEST_LEVELS:
            self._restart(losses)
            self._add(voice, position)
            source = self._fix.most_probable(self._prior)
        if source is None:
            self._source = None
            return None
        self._source = Hunted(source[0], self._grid.centre_of(source[0]), self.beside(voice))
        return self._source

    @property
    def is_on(self) -> bool:
        """Whether a voice is or was heard whose source is still to be reached."""
        return self._source is not None or bool(self._left)

    def forget(self) -> None:
        """Forget the voice that the robot hears."""
        self._fix = self._source = None

    def note_found(self, place: Vector, within_m: float) -> None:
        """Forget the voices whose sources are near a victim who has been found. Args: place: in `map` [m]."""
        near = [cell for cell, left in self._left.items() if math.dist(left.source_m, place) <= within_m]
        for cell in near:
            del self._left[cell]
        if self._source is not None and math.dist(self._source.source_m, place) <= within_m:
            self.forget()

    def beside(self, voice: VoiceReading) -> Vector | None:
        """Return the loudest place that a robot perceives, if the victim must be next to it; else None."""
        return voice.local_best_m if voice.heard and voice.local_best_level_db >= self._beside_db else None

    def _is_likely(self, cell: int, mass: np.ndarray, prior: np.ndarray) -> bool:
        """Whether the victim may be in a cell or next to it, for all that the team has heard."""
        row, column = divmod(cell, self._grid.columns)
        near = np.s_[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        shape = self._grid.rows, self._grid.columns
        return float(mass.reshape(shape)[near].sum()) > _STILL_LIKELY * float(prior.reshape(shape)[near].sum())

    def _restart(self, losses: _core.control.VoiceLosses) -> None:
        self._fix = _core.control.VoiceFix(losses, self._loudness_db, self._exponent)
        self._heard_at = set()

    def _add(self, voice: VoiceReading, position: Vector) -> None:
        """Add the levels of a reading, each place once, and rule out the cell of the robot."""
        assert self._fix is not None
        assert self._prior is not None
        if voice.local_best_m not in self._heard_at:
            self._heard_at.add(voice.local_best_m)
            self._fix.add(voice.local_best_m, voice.local_best_level_db)
            if voice.level_db > 0.0:
                self._fix.add(position, voice.level_db)
        cell = self._grid.cell_of(position)
        if cell not in self._visited and math.dist(self._grid.centre_of(cell), position) <= self._saved_within_m:
            self._prior[cell] *= np.float32(_RULED_OUT)
            self._visited.add(cell)


def _level_at(distance_m: float, voice: Voice) -> float:
    """Return the level of the faintest voice at a distance [dB]."""
    return -voice.constant_db[1] - 10.0 * voice.exponent[1] * math.log10(distance_m)

"""What one robot knows about victims: its belief, where the team listened, the noise, and who was found."""

from __future__ import annotations

import functools
import math
import struct
from collections import deque
from collections.abc import Iterable

import numpy as np

from robotteamsim import _core
from robotteamsim.control.search.cells import (
    CellGrid,
    Places,
    loss_step_db,
    places,
    unheard,
    voice_losses,
)
from robotteamsim.scenario.building import Doors
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_NOISE_STEP_DB = 0.25
"""A smaller change of the estimated noise does not change the belief."""

_SPACING = 0.25
"""Distance of places to listen at, if it is above `place_spacing_m`: this share of the hearing distance."""

MOST_FOUND = 200
"""A message holds at most so many places of found victims."""


class Knowledge:
    """The belief of one robot, updated by its own hearing and by what its teammates send.

    The number of victims is unknown. With a mean of m expected victims and an exponential prior for the rate, the rate
    after k found victims is (1 + k) / (1/m + F) per victim of the prior, where F is the searched share of the prior
    [the posterior mean of a Poisson process with a gamma prior].
    """

    def __init__(self, setup: Setup, robot_id: int, grid: CellGrid, start: int) -> None:
        """Args: start: the cell where the robot starts; NO_CELL for none."""
        scenario = setup.scenario
        search, voice = scenario.control.as_kind(SearchControl), scenario.voice
        self._voice, self._building, self._grid = voice, setup.map_of(robot_id), grid
        self._reach_m, self._start = setup.robots[robot_id].reach_m, start
        self._save_distance_m, self._tuning = scenario.mission.save_distance_m, search
        self._mean_victims = search.expected_victims
        self._step_db = loss_step_db(voice)
        # A victim is loudest in one cell of the voice map, or in two that are neighbours.
        self._found_within_m = 1.5 * voice.map_resolution_m
        self.noise = NoiseEstimate(search.assumed_noise_db)
        """The robot's own estimate, from its readings."""
        self.noise_db = search.assumed_noise_db
        """The noise that the belief assumes [dB]."""
        self.log = ListeningLog()
        self.losses = voice_losses(setup.map_of(robot_id), voice, grid, ())
        self.places = self._spaced_places()
        """Where victims may be and where to listen."""
        self.belief = _core.control.VictimBelief(self.losses, self.places.prior)
        self.belief.set_unheard(unheard(voice, self.noise_db))
        self.found: list[Vector] = []
        """Places of victims whom the team has reached, in `map` [m]."""
        self._remaining: float | None = None

    @property
    def measured_noise_db(self) -> float | None:
        """The robot's own estimate of the noise; None if no voice has shown it."""
        return self.noise.noise_db if self.noise.is_measured else None

    @property
    def remaining(self) -> float:
        """The probability that a victim of the prior is still unheard."""
        if self._remaining is None:
            self._remaining = self.belief.remaining()
        return self._remaining

    @property
    def victims_per_share(self) -> float:
        """Expected victims per share of the prior that is still to be searched."""
        searched = max(1.0 - self.remaining, 0.0)
        return (1.0 + len(self.found)) / (1.0 / self._mean_victims + searched)

    @property
    def open_m2(self) -> float:
        """The floor on which victims may be [m^2]."""
        return self.places.num_open * self._grid.cell_m**2

    @property
    def hearing_m(self) -> float:
        """The distance at which a middling voice is heard without walls [m]."""
        voice = self._voice
        over_db = -0.5 * sum(voice.constant_db) - self.noise_db
        return float(10.0 ** (over_db / (5.0 * sum(voice.exponent)))) + voice.local_best_radius_m

    def use_doors(self, doors: Doors) -> None:
        """Listen through the doors as they are believed to be now; what was heard before stays valid."""
        self.losses = voice_losses(self._building, self._voice, self._grid, doors)
        self.belief.set_losses(self.losses)

    def agree_on_noise(self, of_teammates_db: list[float]) -> None:
        """Use the lowest estimate of the robot and its teammates, or the assumption."""
        own_db = self.measured_noise_db
        known = of_teammates_db if own_db is None else [*of_teammates_db, own_db]
        # What is heard is an upper limit even if no voice has appeared or vanished yet.
        noise_db = min([*known, self.noise.noise_db]) if own_db is None and not known else min(known)
        if abs(noise_db - self.noise_db) < _NOISE_STEP_DB:
            return
        self.noise_db = noise_db
        self.belief.set_unheard(unheard(self._voice, noise_db))
        self._remaining = None
        self.places = self._spaced_places()

    def _spaced_places(self) -> Places:
        """Return the places to listen at: the farther a robot hears, the fewer."""
        spacing_m = max(self._tuning.place_spacing_m, _SPACING * self.hearing_m)
        stride = max(1, round(spacing_m / self._grid.cell_m))
        return self._building.shared(places, self._reach_m, self._grid, self._start, self._save_distance_m, stride)

    def listen(self, cell: int, voice: VoiceReading) -> None:
        """Note that the robot hears nothing at a cell, or nothing louder than a voice."""
        above_db = voice.local_best_level_db - self.noise_db if voice.heard else 0.0
        above = limited(above_db / self._step_db)
        if self.log.add(cell, above, own=True):
            self._learn(cell, above)

    def merge(self, listened: str, found: tuple[Vector, ...]) -> bool:
        """Add what a teammate knows; return whether it is about the same plan."""
        entries = entries_in(listened, self._grid.size)
        if entries is None:
            return False
        for cell, above in self.log.merge(entries):
            self._learn(cell, above)
        for place in found:
            self.add_found(place)
        return True

    def _learn(self, cell: int, above: int) -> None:
        self.belief.listen(cell, above)
        self._remaining = None

    def add_found(self, place: Vector) -> None:
        """Add a victim whom a robot has reached, unless one at that place is already known."""
        if place in self.found:
            return
        is_new = all(math.dist(place, known) > self._found_within_m for known in self.found)
        if is_new and len(self.found) < MOST_FOUND:
            self.found.append(place)

    def has_found_at(self, source_m: Vector) -> bool:
        """Whether a found victim is where a voice came from."""
        return any(math.dist(place, source_m) <= self._tuning.same_voice_m for place in self.found)

    def mass(self) -> np.ndarray:
        """Return the probability of each cell that an unheard victim is there, float32."""
        return self.belief.mass()


_KEPT = 3
"""A corner of a wall makes a voice appear with a jump; the smallest of so many levels is near the noise."""


class NoiseEstimate:
    """Estimates the noise of a robot's surroundings from the levels at which voices appear and vanish.

    A voice is heard only above the noise. The level at which a voice becomes audible, or the last one before it is no
    longer audible, is therefore the noise, up to the change within one step. Every level that is heard is an upper
    limit. Before the first voice appears, the robot uses an assumption.
    """

    def __init__(self, assumed_db: float) -> None:
        self.noise_db = assumed_db
        """The estimate [dB]."""
        self._edges_db: deque[float] = deque(maxlen=_KEPT)
        self._last: VoiceReading | None = None
        self._epoch = -1

    @property
    def is_measured(self) -> bool:
        """Whether a voice has appeared or vanished; otherwise the estimate is an assumption, or an upper limit."""
        return bool(self._edges_db)

    def note(self, voice: VoiceReading, epoch: int) -> None:
        """Note the reading of a step. Args: epoch: of the task; voices that a new epoch brings or ends do not count."""
        last, self._last = self._last, voice
        if last is not None and not (voice.heard or last.heard):
            self._epoch = epoch
            return
        if last is None or epoch != self._epoch:
            self._epoch = epoch
        elif voice.heard != last.heard:
            self._edges_db.append((voice if voice.heard else last).local_best_level_db)
            self.noise_db = min(self._edges_db)
        if voice.heard and voice.local_best_level_db < self.noise_db:
            self.noise_db = voice.local_best_level_db
            if self._edges_db:
                self._edges_db.append(voice.local_best_level_db)


_ENTRY = struct.Struct(">HB")
"""The cell, and the loudness that would have been noticed; three bytes, as hexadecimal digits in a message."""

_LARGEST = 255


class ListeningLog:
    """The cells at which robots of the team listened, and the faintest voice that they would have noticed there.

    A message contains the sender's own new entries, and some of all that it knows, in turn. Entries may arrive twice,
    late or not at all: for each cell the smallest value counts, so all robots that know the same entries agree, and
    robots of a split team agree after they have met for some time.
    """

    def __init__(self) -> None:
        self._above: dict[int, int] = {}
        """Steps over the noise above which a voice would have been noticed, by cell."""
        self._texts: dict[int, str] = {}
        self._order: list[int] = []
        """The cells in the order in which the robot learned of them."""
        self._unsent: dict[int, None] = {}
        self._next = 0
        """Index in `_order` of the next old entry to send."""

    def __len__(self) -> int:
        return len(self._order)

    def add(self, cell: int, above: int, *, own: bool) -> bool:
        """Add an entry, of the robot itself or of a teammate; return whether it is news."""
        known = self._above.get(cell)
        if known is not None and known <= above:
            return False
        if known is None:
            self._order.append(cell)
        self._above[cell] = above
        self._texts[cell] = f"{cell:04x}{above:02x}"
        if own:
            self._unsent[cell] = None
        return True

    def merge(self, entries: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
        """Add entries of a teammate; return those that are news."""
        known = self._above
        news = [(cell, above) for cell, above in entries if above < known.get(cell, _LARGEST + 1)]
        return [(cell, above) for cell, above in news if self.add(cell, above, own=False)]

    def to_text(self, most: int, repeated: int) -> str:
        """Return at most `most` of the robot's own news, and `repeated` of all entries, in turn."""
        news = list(self._unsent)[-most:]
        for cell in news:
            del self._unsent[cell]
        if self._next >= len(self._order):
            self._next = 0
        old = self._order[self._next : self._next + repeated]
        self._next += repeated
        return "".join(map(self._texts.__getitem__, dict.fromkeys([*news, *old])))


# The robots of one process receive the same messages.
@functools.lru_cache(maxsize=1024)
def entries_in(text: str, num_cells: int) -> tuple[tuple[int, int], ...] | None:
    """Return the entries in a text from `to_text`; None if it does not fit a grid of so many cells."""
    try:
        data = bytes.fromhex(text)
    except ValueError:
        return None
    if len(data) % _ENTRY.size:
        return None
    entries = tuple(_ENTRY.iter_unpack(data))
    return entries if max(entries, default=(0, 0))[0] < num_cells else None


def limited(above: float) -> int:
    """Return a number of steps over the noise as an entry holds it: a whole number from 0 to 255, rounded up."""
    return min(max(-int(-above // 1), 0), _LARGEST)

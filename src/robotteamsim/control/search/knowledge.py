"""What one robot knows about victims: its belief, where the team listened, the noise, and who was found."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim import _core
from robotteamsim.control.search.cells import (
    CellGrid,
    Places,
    loss_step_db,
    unheard,
    voice_losses,
)
from robotteamsim.control.search.listening import ListeningLog, entries_in, limited
from robotteamsim.control.search.noise import NoiseEstimate
from robotteamsim.scenario.building import Doors
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_NOISE_STEP_DB = 0.25
"""A smaller change of the estimated noise does not change the belief."""

MOST_FOUND = 200
"""A message holds at most so many places of found victims."""


class Knowledge:
    """The belief of one robot, updated by its own hearing and by what its teammates send.

    The number of victims is unknown. With a mean of m expected victims and an exponential prior for the rate, the rate
    after k found victims is (1 + k) / (1/m + F) per victim of the prior, where F is the searched share of the prior
    [the posterior mean of a Poisson process with a gamma prior].
    """

    def __init__(self, setup: Setup, grid: CellGrid, places: Places) -> None:
        scenario = setup.scenario
        search, voice = scenario.control.as_kind(SearchControl), scenario.voice
        self._voice, self._building, self._grid, self._places = voice, setup.building, grid, places
        self._mean_victims = search.expected_victims
        self._step_db = loss_step_db(voice)
        self._found_within_m = 2.0 * scenario.mission.save_distance_m + voice.map_resolution_m
        self.noise = NoiseEstimate(search.assumed_noise_db)
        """The robot's own estimate, from its readings."""
        self._noise_db = search.assumed_noise_db
        self.log = ListeningLog()
        self.losses = voice_losses(setup.building, voice, grid, ())
        self.belief = _core.control.VictimBelief(self.losses, places.prior)
        self.belief.set_unheard(unheard(voice, self._noise_db))
        self.found: list[Vector] = []
        """Places of victims whom the team has reached, in `map` [m]."""
        self._remaining: float | None = None

    @property
    def noise_db(self) -> float:
        """The noise that the belief assumes [dB]."""
        return self._noise_db

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
        return self._places.num_open * self._grid.cell_m**2

    @property
    def hearing_m(self) -> float:
        """The distance at which a middling voice is heard without walls [m]."""
        voice = self._voice
        over_db = -0.5 * sum(voice.constant_db) - self._noise_db
        return float(10.0 ** (over_db / (5.0 * sum(voice.exponent)))) + voice.local_best_radius_m

    def use_doors(self, doors: Doors) -> None:
        """Listen through the doors as they are believed to be now; what was heard before stays valid."""
        self.losses = voice_losses(self._building, self._voice, self._grid, doors)
        self.belief.set_losses(self.losses)

    def agree_on_noise(self, of_teammates_db: list[float]) -> bool:
        """Use the lowest estimate of the robot and its teammates, or the assumption; return whether it has changed."""
        own_db = self.measured_noise_db
        known = of_teammates_db if own_db is None else [*of_teammates_db, own_db]
        # What is heard is an upper limit even if no voice has appeared or vanished yet.
        noise_db = min([*known, self.noise.noise_db]) if own_db is None and not known else min(known)
        if abs(noise_db - self._noise_db) < _NOISE_STEP_DB:
            return False
        self._noise_db = noise_db
        self.belief.set_unheard(unheard(self._voice, noise_db))
        self._remaining = None
        return True

    def listen(self, cell: int, voice: VoiceReading) -> None:
        """Note that the robot hears nothing at a cell, or nothing louder than a voice."""
        above_db = voice.local_best_level_db - self._noise_db if voice.heard else 0.0
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

    def mass(self) -> np.ndarray:
        """Return the probability of each cell that an unheard victim is there, float32."""
        return self.belief.mass()

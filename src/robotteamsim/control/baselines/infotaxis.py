"""Infotaxis: search by the greatest expected reduction of entropy [vergassola2007]."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.control.baselines.patrol_graph import Graph, reachable_lattice
from robotteamsim.control.baselines.searching import RouteController
from robotteamsim.control.driving.path_controller import Situation
from robotteamsim.errors import ScenarioError
from robotteamsim.interface.payload import Index, Update, update_reader
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.propagation import VoiceField, VoiceSource
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.controllers.routes import InfotaxisControl
from robotteamsim.scenario.sections import Voice
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_LONGEST_EDGE = 1.5
"""Longest path between linked places of the lattice, in spacings."""
_LEAST_SHARE = 1e-3
"""When the mean probability that is left falls below this, the floor has been searched: the robot starts again."""
_LEFT_AT_VISITED = 1e-4
"""Factor for places where a robot has been; below _LEAST_SHARE."""
_LEAST_AGREEMENT = 0.03
"""Probability of the silence, given the voices, below which the voices are forgotten; more than that of one miss."""


class Listening(Update, frozen=True, tag="infotaxis"):
    """The message of a robot to its team: where it is on the lattice, whether it hears a voice, where it goes next.

    epoch:   of the task; a voice of another epoch may be that of a victim who has been saved since.
    reached: whether it is at `place`, and not only nearest to it.
    """

    robot_id: Index
    epoch: Index
    place: Index
    reached: bool
    heard: bool
    intends: Index


parse_listening = update_reader(Listening, kept=8192)
"""Return what a teammate hears; None if it is another message."""


class Belief:
    """Where the next victim may be: a probability for each place, from what was heard and what was not.

    Silence at a place counts for all victims and is kept. A voice counts until the voice map changes, because its
    victim may have been saved. Both count once for each place, because repeated readings there are not independent.
    """

    def __init__(self, num_places: int) -> None:
        self._silent = np.ones(num_places)
        self._heard = np.ones(num_places)
        self._silent_at: set[int] = set()
        self._heard_at: set[int] = set()
        self._visited: set[int] = set()
        self.is_searched = False
        """Whether the whole floor has been searched at least once."""

    def add(self, place: int, heard: bool, probabilities: np.ndarray) -> None:
        """Add a reading. Args: probabilities: of hearing a victim at each place from `place`."""
        known = self._heard_at if heard else self._silent_at
        if place in known:
            return
        known.add(place)
        if heard:
            self._heard *= probabilities
            if self._heard.max() < _LEAST_SHARE:  # The voices of several victims have no common origin.
                self._heard = probabilities.copy()
        else:
            self._silent *= 1.0 - probabilities
            self._start_again_if_searched()
        if (self._silent * self._heard).sum() < _LEAST_AGREEMENT * self._heard.sum():
            self.forget_voices()  # Wherever the voices could come from, it was silent nearby.

    def visit(self, place: int, found: np.ndarray) -> None:
        """A robot was at a place: there is no victim where it would have found one, bool; kept as silence is."""
        if place not in self._visited:
            self._visited.add(place)
            self._silent[found] *= _LEFT_AT_VISITED
            self._start_again_if_searched()

    def forget_voices(self) -> None:
        """Forget the voices, but not the silence."""
        self._heard[:] = 1.0
        self._heard_at.clear()

    def _start_again_if_searched(self) -> None:
        if self._silent.mean() < _LEAST_SHARE:
            self.is_searched = True
            self._silent[:] = 1.0
            self._silent_at.clear()
            self._visited.clear()

    @property
    def distribution(self) -> np.ndarray:
        """The probabilities; their sum is 1."""
        left = self._silent * self._heard
        total = left.sum()
        return np.asarray(left / total if total > 0.0 else self._silent / self._silent.sum())


def entropy_nats(weights: np.ndarray) -> float:
    """Return the entropy of a distribution that is proportional to some weights; 0 if all are 0."""
    total = weights.sum()
    if total <= 0.0:
        return 0.0
    shares = weights[weights > 0.0] / total
    return float(-(shares * np.log(shares)).sum())


def expected_gain_nats(belief: np.ndarray, heard: np.ndarray, found: np.ndarray) -> float:
    """Return the expected reduction of the entropy by going to a place [vergassola2007].

    p(found) S + (1 - p(found)) (S - E[S after listening]), with two possible readings, a voice or silence.

    Args: belief: probabilities of the victim's places.  heard: of hearing a victim at each place from there.
          found: whether a victim at each place would be found at once.
    """
    before, p_found = entropy_nats(belief), float(belief[found].sum())
    voice, silence = belief * heard, belief * (1.0 - heard)
    p_voice = float(voice.sum())
    after = p_voice * entropy_nats(voice) + (1.0 - p_voice) * entropy_nats(silence)
    return p_found * before + (1.0 - p_found) * (before - after)


class InfotaxisController(RouteController):
    """Moves to the neighbouring place of a lattice from which it expects to learn most about the next victim's place.

    The belief contains the readings of all robots that send theirs; places that teammates with a lower id go to count
    as silent. If no neighbour promises enough, the robot drives to the place with the highest probability per path
    length. A voice is followed to its source, because here, unlike in [vergassola2007], it has a gradient.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        """Raises: ScenarioError: the plan has no room for the lattice."""
        scenario, tuning = setup.scenario, setup.scenario.control.as_kind(InfotaxisControl)
        super().__init__(robot_id, setup, tuning)
        self._infotaxis = tuning
        reach_m = setup.robots[robot_id].reach_m
        self._graph: Graph = reachable_lattice(setup, reach_m, tuning.spacing_m, _LONGEST_EDGE)
        if not self._graph.places:
            raise ScenarioError(
                f"{scenario.name}: control.spacing_m: {tuning.spacing_m:g} m leaves no two places linked"
            )
        self._hearing = setup.map_of(robot_id).shared(Hearing, scenario.voice, self._graph.places)
        self._places_m = np.array(self._graph.places)
        self._save_m = max(scenario.mission.save_distance_m, 0.5 * tuning.spacing_m)
        self._belief = Belief(len(self._graph.places))
        self._intended: dict[int, int] = {}
        """The place that each teammate goes to, by robot id."""
        self._at = 0
        self._intends = 0
        self._given_up: set[int] = set()
        """Places that took too long to reach since the voice map last changed."""

    @property
    def is_searched(self) -> bool:
        """Whether the belief of this robot has excluded the whole floor once."""
        return self._belief.is_searched

    def _forget_voices(self) -> None:
        self._belief.forget_voices()
        self._given_up.clear()

    def _listen(self, inbox: Sequence[Message]) -> None:
        for message in inbox:
            heard = parse_listening(message.payload)
            if heard is None or max(heard.place, heard.intends) >= len(self._graph.places):
                continue
            if heard.reached:
                self._belief.visit(heard.place, self._is_near(heard.place))
            if not heard.heard or heard.epoch == self._epoch:
                self._belief.add(heard.place, heard.heard, self._heard_from(heard.place))
            self._intended[heard.robot_id] = heard.intends

    def _look(self, now: Situation) -> tuple[Message, ...]:
        self._at = self._graph.nearest(now.position)
        heard = now.observation.voice.heard
        reached = math.dist(now.position, self._graph.places[self._at]) < self._infotaxis.arrived_m
        if reached:
            self._belief.visit(self._at, self._is_near(self._at))
        self._belief.add(self._at, heard, self._heard_from(self._at))
        update = Listening(self.robot_id, self._epoch, self._at, reached, heard, self._intends)
        return (Message(self.robot_id, EVERYBODY, update.to_json()),)

    def _next_place(self, position: Vector, is_done: bool) -> Vector:
        at = self._graph.nearest(position)
        if is_done and math.dist(position, self._graph.places[self._intends]) >= self._infotaxis.arrived_m:
            self._given_up.add(self._intends)
        belief = self._without_teammates(self._belief.distribution)
        options = [other for other, _ in self._graph.edges[at] if other not in self._given_up]
        gains = [expected_gain_nats(belief, self._heard_from(other), self._is_near(other)) for other in options]
        if options and max(gains) >= self._infotaxis.least_gain_nats:
            self._intends = options[gains.index(max(gains))]
        else:
            self._intends = self._likely_place(belief, at)
        return self._graph.places[self._intends]

    def _without_teammates(self, belief: np.ndarray) -> np.ndarray:
        """Return the belief if teammates with a lower id hear nothing where they go."""
        for robot_id, place in self._intended.items():
            if robot_id < self.robot_id:
                belief = belief * (1.0 - self._heard_from(place))
        total = belief.sum()
        return belief / total if total > 0.0 else self._belief.distribution

    def _likely_place(self, belief: np.ndarray, at: int) -> int:
        """Return another place with the highest probability per length of the path to it."""
        # Paths are the same in both directions: one map of lengths, from the place where the robot is.
        lengths_m = np.array(
            [self.driver.map.distance_m(self._graph.places[at], place) for place in self._graph.places]
        )
        worth = belief / (lengths_m + self._infotaxis.spacing_m)
        worth[[at, *self._given_up]] = -1.0
        return int(np.argmax(worth))

    def _heard_from(self, place: int) -> np.ndarray:
        """Return the probability that a victim at each place is heard from one place."""
        return (1.0 - self._infotaxis.missed) * self._hearing.probabilities(place)

    def _is_near(self, place: int) -> np.ndarray:
        """Return whether a victim at each place would be found at one place, bool."""
        away_m = self._places_m - self._places_m[place]
        return np.asarray(np.hypot(away_m[:, 0], away_m[:, 1]) <= self._save_m)


class Hearing:
    """The probability of hearing a victim at each of some places from each other one, through all walls.

    The constants l_c and gamma of eq. (7) are unknown, within the ranges of `voice`; the level is taken as uniform
    between those of the quietest and the loudest voice. Losses are the same in both directions, so that a voice map of
    the robot's own place has the levels that it would hear. Doors have their states at the start.
    """

    def __init__(self, building: MapSource, voice: Voice, places: tuple[Vector, ...]) -> None:
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

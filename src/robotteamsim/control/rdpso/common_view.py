"""Values derived only from the updates of one iteration: the same for all robots that heard the same updates."""

from collections.abc import Iterable
from typing import NamedTuple

from robotteamsim import _core
from robotteamsim.control.rdpso.update import Best, RdpsoUpdate, Sighting
from robotteamsim.interface import OUTSIDE
from robotteamsim.swarm import SwarmState, Vector


class Bests(NamedTuple):
    """The bests of a swarm and of excluded robots, which share the voices they hear with every swarm; highest first.

    The distance of an excluded robot to the area does not count: of its own local best only a voice does.
    """

    known: tuple[Best, ...]
    local: tuple[Best, ...]


class Comparable(NamedTuple):
    """The loudest cells and the bests by swarm of robots with the same task and the same beliefs about doors."""

    heard: _core.control.HeardNotes
    bests: dict[int, Bests]


class CommonView:
    """The updates of one iteration. Robots share it, so it must not be changed.

    values:    of the local bests, by robot id, for each swarm in the updates (OUTSIDE is one).
    positions: of the robots in `map` [m], likewise.
    states:    each swarm's memory, as sent by its member with the lowest id.
    doors:     all sightings of doors in the updates.
    verdicts:  cached results of `Membership`: the swarm of each robot that changes, and the swarms' memories.
    """

    def __init__(self, updates: tuple[RdpsoUpdate, ...]) -> None:
        """Args: updates: at least one, in the order of robot ids."""
        self.updates = updates
        self.iteration = updates[0].iteration
        self.values: dict[int, dict[int, float]] = {}
        self.positions: dict[int, dict[int, Vector]] = {}
        self.states: dict[int, SwarmState] = {}
        doors: dict[Sighting, None] = {}
        self._by_basis: dict[tuple[int, tuple[Sighting, ...]], list[RdpsoUpdate]] = {}
        for update in updates:
            swarm_id = update.swarm_id
            if swarm_id not in self.states:
                self.states[swarm_id], self.values[swarm_id], self.positions[swarm_id] = update.swarm, {}, {}
            self.values[swarm_id][update.robot_id] = update.value
            self.positions[swarm_id][update.robot_id] = update.position
            doors |= dict.fromkeys(update.doors)
            self._by_basis.setdefault((update.epoch, update.doors), []).append(update)
        self.doors = tuple(doors)
        self.verdicts: dict[tuple[object, ...], tuple[dict[int, int], dict[int, SwarmState]]] = {}
        self._comparable: dict[tuple[int, tuple[Sighting, ...]], Comparable] = {}

    def comparable(self, own: RdpsoUpdate) -> Comparable:
        """Return the common values of the updates with a robot's task and its beliefs about doors."""
        basis = own.epoch, own.doors
        if basis not in self._comparable:
            updates = self._by_basis[basis]
            heard = _core.control.HeardNotes([(update.position, update.loudest) for update in updates])
            swarm_ids = {update.swarm_id for update in updates}
            self._comparable[basis] = Comparable(heard, {i: _bests_of(i, updates) for i in swarm_ids})
        return self._comparable[basis]


def _bests_of(swarm_id: int, updates: Iterable[RdpsoUpdate]) -> Bests:
    own = [update for update in updates if update.swarm_id in (swarm_id, OUTSIDE)]
    known = [update.known_best for update in own if update.known_best]
    local = [u.local_best for u in own if u.local_best and (u.swarm_id != OUTSIDE or u.local_best.is_voice)]
    return Bests(_highest_first(known), _highest_first(local))


def _highest_first(bests: Iterable[Best]) -> tuple[Best, ...]:
    """Return bests in descending order, each once; ties keep their order."""
    return tuple(sorted(dict.fromkeys(bests), key=lambda best: best.value, reverse=True))

"""What follows from the reports of one iteration alone: the same for all robots that heard the same ones."""

from __future__ import annotations

from collections.abc import Iterable
from operator import attrgetter
from typing import NamedTuple

from robotteamsim import _core
from robotteamsim.control.rdpso.update import NOTHING, Best, RdpsoUpdate, Sighting
from robotteamsim.interface import OUTSIDE
from robotteamsim.swarm import SwarmState, Vector

_KEPT_VIEWS = 64
_VALUE, _SWARM_ID = attrgetter("value"), attrgetter("swarm_id")
_HEARD = attrgetter("position", "loudest")
_BASIS = attrgetter("epoch", "doors")
"""What two robots' bests must have in common."""
_views: dict[tuple[int, ...], CommonView] = {}


class Bests(NamedTuple):
    """What a swarm and the excluded, who share what they hear with every swarm, report as bests: the highest first.

    How near an excluded robot comes to the area is no success: of its own local best only a voice counts.
    """

    known: tuple[Best, ...]
    local: tuple[Best, ...]


class CommonView:
    """Reports of one iteration, put in order. Robots share it, so nobody changes what it holds.

    values:    of the local bests, by robot id, of each swarm heard of (OUTSIDE is one).
    positions: of the robots in `map` [m], likewise.
    states:    each swarm's memory, as its member of the lowest id has it.
    doors:     all that the reports say of doors.
    verdicts:  what `Membership` made of it: who goes to which swarm, and the swarms' memories.
    """

    def __init__(self, reports: tuple[RdpsoUpdate, ...]) -> None:
        """Args: reports: at least one, in the order of robot ids."""
        self.reports = reports
        self.iteration = reports[0].iteration
        self.values: dict[int, dict[int, float]] = {}
        self.positions: dict[int, dict[int, Vector]] = {}
        self.states: dict[int, SwarmState] = {}
        doors: dict[Sighting, None] = {}
        self._by_basis: dict[tuple[int, tuple[Sighting, ...]], list[RdpsoUpdate]] = {}
        for report in reports:
            robot_id, _, epoch, position, _, local_best, _, swarm_id, state, sightings = report
            if swarm_id not in self.states:
                self.states[swarm_id], self.values[swarm_id], self.positions[swarm_id] = state, {}, {}
            value, _ = local_best or NOTHING
            self.values[swarm_id][robot_id] = value
            self.positions[swarm_id][robot_id] = position
            doors |= dict.fromkeys(sightings)
            self._by_basis.setdefault((epoch, sightings), []).append(report)
        self.doors = tuple(doors)
        self.verdicts: dict[tuple[object, ...], tuple[dict[int, int], dict[int, SwarmState]]] = {}
        self._comparable: dict[tuple[object, ...], tuple[_core.control.HeardNotes, dict[int, Bests]]] = {}

    def comparable(self, own: RdpsoUpdate) -> tuple[_core.control.HeardNotes, dict[int, Bests]]:
        """Return what those hear, and by swarm report as bests, who have a robot's task and agree with it on doors."""
        key = _BASIS(own)
        found = self._comparable.get(key)
        if found is None:
            reports = self._by_basis[key]
            heard = _core.control.HeardNotes(list(map(_HEARD, reports)))
            found = heard, {swarm_id: _bests_of(swarm_id, reports) for swarm_id in set(map(_SWARM_ID, reports))}
            self._comparable[key] = found
        return found


def common_view(reports: tuple[RdpsoUpdate, ...]) -> CommonView:
    """Return the view of reports that are in the order of robot ids.

    Robots of one process that heard each other hold the same objects, and share one view: it keeps them, so that their
    identities stay theirs while it is there.
    """
    key = tuple(map(id, reports))
    view = _views.get(key)
    if view is None:
        while len(_views) >= _KEPT_VIEWS:
            del _views[next(iter(_views))]
        view = _views[key] = CommonView(reports)
    return view


def _bests_of(swarm_id: int, reports: Iterable[RdpsoUpdate]) -> Bests:
    known: dict[Best, None] = {}  # as sets, in an order
    local: dict[Best, None] = {}
    for _, _, _, _, _, local_best, known_best, its_swarm_id, _, _ in reports:
        if its_swarm_id not in (swarm_id, OUTSIDE):
            continue
        if known_best:
            known[known_best] = None
        if local_best and (its_swarm_id != OUTSIDE or local_best.is_voice):
            local[local_best] = None
    return Bests(_highest_first(known), _highest_first(local))


def _highest_first(bests: Iterable[Best]) -> tuple[Best, ...]:
    """Return bests in falling order; equal values in the order given."""
    return tuple(sorted(bests, key=_VALUE, reverse=True))

"""What a robot knows of its team: the updates of the robots, the last one of each, and values derived from them."""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Annotated, NamedTuple

import msgspec

from robotteamsim import _core
from robotteamsim.control.driving.places import OtherPlaces, Places
from robotteamsim.interface import OUTSIDE
from robotteamsim.interface.payload import Index, Point, Update, update_reader
from robotteamsim.network.messages import Batch, Message
from robotteamsim.swarm import SwarmState, Vector

NOTHING = float("-inf")
"""Value of a missing local best: below any other."""


class Best(msgspec.Struct, frozen=True):
    """A place in `map` [m] and its value: larger is better; a voice is better than any distance."""

    value: Annotated[float, msgspec.Meta(ge=-1e9, le=1e9)]
    position: Point

    @property
    def is_voice(self) -> bool:
        """Whether the value is a voice level; otherwise it is the negative distance to the area."""
        return self.value > 0.0


class Sighting(msgspec.Struct, frozen=True):
    """A door, whether it was closed, and the iteration in which a robot saw that."""

    door: str
    closed: bool
    iteration: Index


class RdpsoUpdate(Update, frozen=True, cache_hash=True, tag="rdpso"):
    """One robot's view at the start of an iteration; positions in `map` [m].

    epoch:      of the task; bests of different epochs, or of robots that disagree on doors, are not comparable.
    loudest:    the loudest cell that it hears; None if it hears no voice.
    local_best: None if there is neither a voice nor an area.
    known_best: the best known before this iteration, since bests were last reset.
    swarm_id:   its swarm before this iteration; OUTSIDE if it is socially excluded.
    swarm:      its copy of that swarm's memory, before this iteration.
    doors:      sightings of doors, sorted by name.
    hot:        blocks of hot places that the robot sees, sorted; left out by a robot that sees none.
    closed_area: centre of the area of the task, if the robot knows no path to it; else left out.
    nearer:     whether it came nearer to the global best of the last iteration than before; left out if not.
    """

    robot_id: Index
    iteration: Index
    epoch: Index
    position: Point
    loudest: Point | None
    local_best: Best | None
    known_best: Best | None
    swarm_id: Annotated[int, msgspec.Meta(ge=OUTSIDE, le=2**31 - 1)]
    swarm: SwarmState
    doors: tuple[Sighting, ...] = ()
    hot: tuple[tuple[Index, Index], ...] | msgspec.UnsetType = msgspec.UNSET
    closed_area: Point | msgspec.UnsetType = msgspec.UNSET
    nearer: bool | msgspec.UnsetType = msgspec.UNSET

    @property
    def value(self) -> float:
        """Value of the local best; below any other if there is none."""
        return NOTHING if self.local_best is None else self.local_best.value


parse_update = update_reader(RdpsoUpdate, kept=4096)
"""Return the update in a message; None if it is another message."""


def update_of(message: Message) -> RdpsoUpdate | None:
    """Return the update in a message; None if it is another message, or the update of another robot than its sender."""
    update = parse_update(message.payload)
    return update if update is not None and update.robot_id == message.sender else None


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
    places:    of the robots, for each swarm.
    states:    each swarm's memory, as sent by its member with the lowest id.
    nearing:   swarms of which a member came nearer to the global best.
    doors, hot: all sightings of doors, and all hot blocks, in the updates.
    verdicts:  cached results of `Membership`: the swarm of each robot that changes, and the swarms' memories.
    """

    def __init__(self, updates: tuple[RdpsoUpdate, ...]) -> None:
        """Args: updates: at least one, in the order of robot ids."""
        self.updates = updates
        self.iteration = updates[0].iteration
        self.values: dict[int, dict[int, float]] = {}
        places: dict[int, dict[int, Vector]] = {}
        self.states: dict[int, SwarmState] = {}
        doors: dict[Sighting, None] = {}
        self._by_basis: dict[tuple[int, tuple[Sighting, ...]], list[RdpsoUpdate]] = {}
        for update in updates:
            swarm_id = update.swarm_id
            if swarm_id not in self.states:
                self.states[swarm_id], self.values[swarm_id], places[swarm_id] = update.swarm, {}, {}
            self.values[swarm_id][update.robot_id] = update.value
            places[swarm_id][update.robot_id] = update.position
            doors |= dict.fromkeys(update.doors)
            self._by_basis.setdefault((update.epoch, update.doors), []).append(update)
        self.places = {swarm_id: Places(by_id) for swarm_id, by_id in places.items()}
        self.hot = tuple({block for update in updates for block in update.hot or ()})
        self.nearing = frozenset(update.swarm_id for update in updates if update.nearer is True)
        self.doors = tuple(doors)
        self.verdicts: dict[tuple[object, ...], tuple[dict[int, int], dict[int, SwarmState]]] = {}
        self._comparable: dict[tuple[int, tuple[Sighting, ...]], Comparable] = {}

    def others(self, swarm_id: int, own_id: int) -> OtherPlaces:
        """Return the places of the other members of a swarm, none if it is not in the updates."""
        return OtherPlaces(self.places.get(swarm_id, Places({})), own_id)

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


class TeamMemory:
    """The last update of each known robot. It is immutable, so that robots can share it.

    Robots that heard the same updates have equal memories, and derived values are computed once for all of them. A
    robot's own update may be included, because the network delivers it to its teammates in the same batch.
    """

    def __init__(self, by_id: Mapping[int, RdpsoUpdate] = MappingProxyType({})) -> None:
        """Args: by_id: the last update of each robot."""
        self.by_id = by_id
        self.updates = tuple([by_id[robot_id] for robot_id in sorted(by_id)])
        """The updates in the order of ids."""
        self._hash = hash(self.updates)
        self._views: dict[int, CommonView] = {}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TeamMemory) and self.updates == other.updates

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def swarm_ids(self) -> frozenset[int]:
        """Numbers of the swarms to which robots belonged according to their last updates."""
        return frozenset(update.swarm_id for update in self.updates)

    @cached_property
    def _num_of_iteration(self) -> Counter[int]:
        return Counter(update.iteration for update in self.updates)

    def after(self, batch: Batch) -> TeamMemory:
        """Return the memory after the messages of a batch."""
        return _after(self, batch)

    def with_update(self, update: RdpsoUpdate) -> TeamMemory:
        """Return the memory after an update."""
        if self.by_id.get(update.robot_id) == update:
            return self
        return TeamMemory({**self.by_id, update.robot_id: update})

    def has_others_of(self, iteration: int, robot_id: int) -> bool:
        """Whether the last update of any other robot is from an iteration."""
        own = self.by_id.get(robot_id)
        return self._num_of_iteration[iteration] > (own is not None and own.iteration == iteration)

    def view(self, iteration: int) -> CommonView:
        """Return the view of the updates of an iteration; there must be at least one."""
        if iteration not in self._views:
            self._views[iteration] = CommonView(tuple(u for u in self.updates if u.iteration == iteration))
        return self._views[iteration]

    @cached_property
    def places(self) -> Places:
        """The last known position of each robot."""
        return Places({update.robot_id: update.position for update in self.updates})


# Cached, because all robots in one part of the network ask for the same values.
@functools.lru_cache(maxsize=256)
def _after(team: TeamMemory, batch: Batch) -> TeamMemory:
    arrived = {update.robot_id: update for update in map(update_of, batch.messages) if update is not None}
    return TeamMemory({**team.by_id, **arrived}) if arrived else team

"""A robot's memory of its team: the last update of each robot."""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType

from robotteamsim.control.rdpso.common_view import CommonView
from robotteamsim.control.rdpso.update import RdpsoUpdate, update_of
from robotteamsim.network.messages import Batch
from robotteamsim.swarm import Vector


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

    def positions(self, without: int) -> dict[int, Vector]:
        """Return the last known position of each robot except one, in `map` [m], by id."""
        return {update.robot_id: update.position for update in self.updates if update.robot_id != without}


# Cached, because all robots in one part of the network ask for the same values.
@functools.lru_cache(maxsize=256)
def _after(team: TeamMemory, batch: Batch) -> TeamMemory:
    arrived = {update.robot_id: update for update in map(update_of, batch.messages) if update is not None}
    return TeamMemory({**team.by_id, **arrived}) if arrived else team

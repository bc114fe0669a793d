"""What a robot remembers of its team: the last update of each robot."""

from __future__ import annotations

import functools
from collections import Counter
from functools import cached_property

from robotteamsim.control.rdpso.common_view import CommonView
from robotteamsim.control.rdpso.update import RdpsoUpdate, update_of
from robotteamsim.network.messages import Batch
from robotteamsim.swarm import Vector


class TeamMemory:
    """The last update of each robot that was heard of. A value that never changes, so that robots can share it.

    Robots that heard the same have equal memories, and what follows from it is computed once for all of them. A robot's
    own update may be among the others: the network delivers it to its teammates in the same batch.
    """

    def __init__(self, updates: tuple[RdpsoUpdate, ...] = ()) -> None:
        """Args: updates: one per robot, in the order of ids."""
        self.updates = updates
        self._hash = hash(updates)
        self._views: dict[int, CommonView] = {}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TeamMemory) and self.updates == other.updates

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def by_id(self) -> dict[int, RdpsoUpdate]:
        """The updates by robot id."""
        return {update.robot_id: update for update in self.updates}

    @cached_property
    def swarm_ids(self) -> frozenset[int]:
        """Numbers of the swarms that robots were last heard to belong to."""
        return frozenset(update.swarm_id for update in self.updates)

    @cached_property
    def _num_of_iteration(self) -> Counter[int]:
        return Counter(update.iteration for update in self.updates)

    def after(self, batch: Batch) -> TeamMemory:
        """Return the team after the messages of a batch have arrived."""
        return _after(self, batch)

    def with_update(self, update: RdpsoUpdate) -> TeamMemory:
        """Return the team after an update."""
        if self.by_id.get(update.robot_id) == update:
            return self
        return _of({**self.by_id, update.robot_id: update})

    def has_others_of(self, iteration: int, robot_id: int) -> bool:
        """Whether the last update of any robot but this one is of an iteration."""
        own = self.by_id.get(robot_id)
        return self._num_of_iteration[iteration] > (own is not None and own.iteration == iteration)

    def view(self, iteration: int) -> CommonView:
        """Return the view of the updates of an iteration, of which there must be one."""
        if iteration not in self._views:
            self._views[iteration] = CommonView(tuple(u for u in self.updates if u.iteration == iteration))
        return self._views[iteration]

    def positions(self, without: int) -> dict[int, Vector]:
        """Return where each robot was when it was last heard, in `map` [m], by id, without one of them."""
        return {update.robot_id: update.position for update in self.updates if update.robot_id != without}


def _of(updates: dict[int, RdpsoUpdate]) -> TeamMemory:
    return TeamMemory(tuple(updates[robot_id] for robot_id in sorted(updates)))


# A function of values that all robots in one part of the network ask for.
@functools.lru_cache(maxsize=256)
def _after(team: TeamMemory, batch: Batch) -> TeamMemory:
    arrived = {update.robot_id: update for update in map(update_of, batch.messages) if update is not None}
    return _of(team.by_id | arrived) if arrived else team

"""The message of a swarm robot to its team, sent once per iteration."""

from typing import Annotated

import msgspec

from robotteamsim.interface import OUTSIDE
from robotteamsim.interface.payload import Index, Point, Update, update_reader
from robotteamsim.network.messages import Message
from robotteamsim.swarm import SwarmState

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

"""The message of a robot that searches, sent once per iteration."""

from typing import Annotated, Literal

import msgspec

from robotteamsim.control.rdpso.team import Sighting
from robotteamsim.interface.payload import Index, Point, Update, update_reader
from robotteamsim.network.messages import Message

Work = Literal["search", "voice", "area", "wait"]
"""What a robot does: it listens at places, approaches a voice, explores an area, or has nothing to do."""

Level = Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
"""A voice level, or the noise below which none is heard [dB]."""


LONGEST_PATH_M = 1e6
"""A longer path is announced as this [m]."""


class HeardVoice(msgspec.Struct, frozen=True):
    """A voice that a robot approaches: where the victim seems to be, in `map` [m], and the length of the path [m]."""

    source: Point
    path_m: Annotated[float, msgspec.Meta(ge=0.0, le=LONGEST_PATH_M)]


CellNumber = Annotated[int, msgspec.Meta(ge=-1, le=65_535)]
"""A cell; -1 for none."""


class SearchUpdate(Update, frozen=True, tag="search"):
    """What one robot does and knows.

    position:  in `map` [m].
    at:        the cell where it is; -1 if it is far from all free cells.
    work:      what it does.
    goal:      cell to which it drives; -1 if it has none.
    voice:     the voice that it approaches; None if it approaches none.
    noise_db:  its estimate of the noise; None if no voice has shown it.
    elapsed_s: time of the mission, as far as it knows [s].
    found:     places of victims whom the team has reached, in `map` [m].
    listened:  entries of `ListeningLog`.
    doors:     sightings of doors, sorted by name.
    """

    robot_id: Index
    position: Point
    at: CellNumber
    work: Work
    goal: CellNumber
    voice: HeardVoice | None
    noise_db: Level | None
    elapsed_s: Annotated[float, msgspec.Meta(ge=0.0, le=1e9)]
    found: tuple[Point, ...]
    listened: str
    doors: tuple[Sighting, ...] = ()


_parse = update_reader(SearchUpdate, kept=1024)


def update_of(message: Message) -> SearchUpdate | None:
    """Return the update in a message; None if it is another message, or the update of another robot than its sender."""
    update = _parse(message.payload)
    return update if update is not None and update.robot_id == message.sender else None

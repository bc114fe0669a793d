"""The message of robots that cover a floor, sent once per iteration."""

from __future__ import annotations

import functools

import msgspec

from robotteamsim.interface.discovery import Discovery
from robotteamsim.interface.payload import Index, Point, read_payload, to_payload


class CoverUpdate(msgspec.Struct, frozen=True, gc=False, tag="cover"):
    """Position and goal of a robot, in `map` [m], the cells that it knows to be covered, and its known victims.

    discoveries: of victims, without names; `time_s` is simulated time. The mission reads them, too.
    """

    robot_id: Index
    position: Point
    goal: Point | None
    covered: str
    discoveries: tuple[Discovery, ...]

    def to_json(self) -> str:
        """Return the update as one line of JSON; numbers are exact."""
        return to_payload(self)


_decoder = msgspec.json.Decoder(CoverUpdate)


# The robots of one process receive the same payloads.
@functools.lru_cache(maxsize=1024)
def parse_cover_update(payload: str) -> CoverUpdate | None:
    """Return the update in a message; None if it is another message."""
    return read_payload(_decoder, payload)

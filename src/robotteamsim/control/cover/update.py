"""What robots that cover a floor send each other, once per iteration."""

import functools

import msgspec

from robotteamsim.interface.discovery import Discovery
from robotteamsim.interface.payload import Index, Point, read_payload, to_payload


class CoverUpdate(msgspec.Struct, frozen=True, gc=False, tag="cover"):
    """Where a robot is and goes, in `map` [m], what it knows to be covered, and all victims that it knows of.

    discoveries: of victims, without names; `time_s` is simulated time. The mission reads them, too.
    """

    robot_id: Index
    position: Point
    goal: Point | None
    covered: str
    discoveries: tuple[Discovery, ...]

    def to_json(self) -> str:
        """Return the update as one line of JSON; numbers keep every bit."""
        return to_payload(self)


_decoder = msgspec.json.Decoder(CoverUpdate)


# The robots of one process receive the same payloads.
@functools.lru_cache(maxsize=1024)
def parse_cover_update(payload: str) -> CoverUpdate | None:
    """Return the update that a message carries; None where it carries something else."""
    return read_payload(_decoder, payload)

"""Payloads of messages: typed JSON, written and read by msgspec. Floats are exact."""

import functools
from collections.abc import Callable
from typing import Annotated, Any, TypeVar

import msgspec

Content = TypeVar("Content")

Index = Annotated[int, msgspec.Meta(ge=0, le=2**31 - 1)]
"""An id, a count or a number of iterations."""

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
"""A coordinate in `map` [m]; plans reach at most 1000 km."""

Point = tuple[Coordinate, Coordinate]
"""x and y in `map` [m]."""

Time = Annotated[float, msgspec.Meta(ge=0.0, le=1e9)]
"""Time of the mission [s]."""

_encoder = msgspec.json.Encoder()


def to_payload(content: Any) -> str:
    """Return a record as one line of JSON."""
    return _encoder.encode(content).decode()


def read_payload(decoder: msgspec.json.Decoder[Content], payload: str) -> Content | None:
    """Return the record in a payload; None if the payload is not JSON of this type. All numbers are finite."""
    try:
        return decoder.decode(payload)
    except (ValueError, RecursionError):  # nested too deeply
        return None


class Update(msgspec.Struct, frozen=True):
    """The message of a robot to its team."""

    def to_json(self) -> str:
        """Return it as one line of JSON; numbers are exact."""
        return to_payload(self)


def update_reader(kind: type[Content], kept: int) -> Callable[[str], Content | None]:
    """Return `read_payload` for one kind of update.

    Args: kept: number of payloads whose results are cached, because the robots of one process receive the same ones.
    """
    decoder = msgspec.json.Decoder(kind)
    return functools.lru_cache(maxsize=kept)(lambda payload: read_payload(decoder, payload))

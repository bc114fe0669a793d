"""Payloads of messages: typed JSON, written and read by msgspec. Floats keep every bit."""

import functools
from collections.abc import Callable
from typing import Annotated, Any, TypeVar

import msgspec

Content = TypeVar("Content")

Index = Annotated[int, msgspec.Meta(ge=0, le=2**31 - 1)]
"""An id, a count or a number of iterations."""

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
"""A coordinate in `map` [m]; no plan reaches farther than 1000 km."""

Point = tuple[Coordinate, Coordinate]
"""x and y in `map` [m]."""

_encoder = msgspec.json.Encoder()


def to_payload(content: Any) -> str:
    """Return a record as one line of JSON."""
    return _encoder.encode(content).decode()


def read_payload(decoder: msgspec.json.Decoder[Content], payload: str) -> Content | None:
    """Return what a payload says; None where it is no JSON or says something else. Its numbers are finite."""
    try:
        return decoder.decode(payload)
    except (ValueError, RecursionError):  # nested too deep
        return None


class Update(msgspec.Struct, frozen=True, gc=False):
    """What a robot sends its team."""

    def to_json(self) -> str:
        """Return it as one line of JSON; numbers keep every bit."""
        return to_payload(self)


def update_reader(kind: type[Content], kept: int) -> Callable[[str], Content | None]:
    """Return what `read_payload` does for one kind of update.

    Args: kept: of so many payloads the answers are kept, as the robots of one process receive the same ones.
    """
    decoder = msgspec.json.Decoder(kind)
    return functools.lru_cache(maxsize=kept)(lambda payload: read_payload(decoder, payload))

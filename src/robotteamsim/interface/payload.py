"""Payloads of messages: typed JSON, written and read by msgspec. Floats are exact."""

from __future__ import annotations

from typing import Annotated, Any, TypeVar

import msgspec

Content = TypeVar("Content")

Index = Annotated[int, msgspec.Meta(ge=0, le=2**31 - 1)]
"""An id, a count or a number of iterations."""

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
"""A coordinate in `map` [m]; plans reach at most 1000 km."""

Point = tuple[Coordinate, Coordinate]
"""x and y in `map` [m]."""

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

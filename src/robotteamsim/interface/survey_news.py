"""The messages by which robots share where they are and what they have found of the building."""

from __future__ import annotations

import base64
import binascii
import zlib
from collections.abc import Iterator

import msgspec
import numpy as np

from robotteamsim.interface.payload import Index, Point, read_payload, to_payload

SAME, IS_UNKNOWN, IS_FREE, IS_OCCUPIED = 0, 1, 2, 3
"""Symbols of cells in a message: not changed, or what they have become."""


class Cells(msgspec.Struct, frozen=True, array_like=True):
    """What a rectangle of cells has become: compressed symbols, row by row, as text of base 85."""

    row: Index
    column: Index
    rows: Index
    columns: Index
    packed: str


class SurveyNews(msgspec.Struct, frozen=True, omit_defaults=True):
    """What one robot knows.

    position: of the sender, as it believes [m]; left out while it does not know it.
    number:   how many messages with cells it had sent before this one: a receiver notices that it lost some.
    cells:    what it has found since then.
    is_all:   whether this and the messages after it have all that it knows.
    wanted:   ids of robots of whom it has lost messages: they send all that they know.
    moving:   where it sees something move that is no teammate whose position it knows [m]; left out while it knows the
              positions of all.
    """

    position: Point | None = None
    number: Index = 0
    cells: Cells | None = None
    is_all: bool = False
    wanted: tuple[Index, ...] = ()
    moving: tuple[Point, ...] = ()


class _Message(msgspec.Struct, frozen=True):
    survey: SurveyNews


_messages = msgspec.json.Decoder(_Message)


def survey_news(news: SurveyNews) -> str:
    """Return the payload that shares it."""
    return to_payload(_Message(news))


def survey_news_in(payload: str) -> SurveyNews | None:
    """Return the news in a message; None if it is another message."""
    if '"survey"' not in payload:
        return None
    found = read_payload(_messages, payload)
    return found.survey if found else None


def bounds(mask: np.ndarray) -> tuple[slice, slice]:
    """Return the rectangle, as an index, that contains all true cells of a grid; an empty one without any."""
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        return slice(0, 0), slice(0, 0)
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)


def packed(symbols: np.ndarray, longest: int, row: int = 0, column: int = 0) -> Iterator[Cells]:
    """Yield messages that contain all symbols of a grid that are not SAME.

    Args: symbols:     uint8, shape (rows, cols).
          longest:     of the text of one message; one cell may exceed it.
          row, column: of the first symbol.
    """
    rows, columns = bounds(symbols != SAME)
    part = symbols[rows, columns]
    if not part.size:
        return
    row, column = row + rows.start, column + columns.start
    text = base64.b85encode(zlib.compress(part.tobytes(), level=9)).decode()
    if len(text) <= longest or part.size == 1:
        yield Cells(row, column, part.shape[0], part.shape[1], text)
    elif part.shape[0] >= part.shape[1]:
        middle = part.shape[0] // 2
        yield from packed(part[:middle], longest, row, column)
        yield from packed(part[middle:], longest, row + middle, column)
    else:
        middle = part.shape[1] // 2
        yield from packed(part[:, :middle], longest, row, column)
        yield from packed(part[:, middle:], longest, row, column + middle)


def unpacked(cells: Cells, most: int) -> np.ndarray | None:
    """Return the symbols of a rectangle, uint8, shape (rows, cols); None if the text has others.

    Args: most: number of cells of the receiver's own map; no message has more.
    """
    size = cells.rows * cells.columns
    if not 0 < size <= most:
        return None
    try:
        unzip = zlib.decompressobj()
        data = unzip.decompress(base64.b85decode(cells.packed), size + 1)
    except (ValueError, binascii.Error, zlib.error):
        return None
    symbols = np.frombuffer(data, dtype=np.uint8)
    if len(symbols) != size or symbols.max() > IS_OCCUPIED:
        return None
    return symbols.reshape(cells.rows, cells.columns)

"""Messages of many robots, kept as the bytes that rospy would send: a step fills in what has changed.

A world that builds and serializes every message anew is five times as busy (bench/ros_bench.py, 30 robots). So it
writes the numbers of all robots at once into NumPy records that lie on the bytes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import BytesIO
from itertools import groupby
from typing import Any

import numpy as np
from genmsg.msgs import parse_type
from genpy import Message

_NUMBERS = {f"{kind}int{8 * size}": f"<{kind or 'i'}{size}" for kind in ("", "u") for size in (1, 2, 4, 8)}
_NUMBERS |= {"float32": "<f4", "float64": "<f8", "bool": "u1"}


def layout(message: Message) -> list[Any]:
    """Return how the bytes of a message lie, for `np.dtype`: a record with the names of its fields.

    Strings and arrays without a fixed length are records of `count` and `data`; an array of messages has a field per
    message: "0", "1", ...
    """
    kinds = zip(message.__slots__, message._slot_types, strict=True)
    return [(name, _layout_of(kind, getattr(message, name))) for name, kind in kinds]


def _layout_of(kind: str, value: Any) -> Any:
    element, is_array, length = parse_type(kind)
    if is_array:
        data = (_NUMBERS[element], (len(value),)) if element in _NUMBERS else _row_layout(value)
        return data if length is not None else [("count", "<u4"), ("data", data)]
    if element == "string":
        return [("count", "<u4"), ("data", f"S{len(value.encode())}")] if value else [("count", "<u4")]
    if element == "time":
        return [("secs", "<u4"), ("nsecs", "<u4")]
    return _NUMBERS[element] if element in _NUMBERS else layout(value)


def _row_layout(messages: Sequence[Message]) -> list[Any]:
    return [(str(index), layout(message)) for index, message in enumerate(messages)]


class PackedRows:
    """The same kind of messages of every robot, as one row each; numbers are set for all robots at once."""

    def __init__(self, examples: Sequence[Sequence[Message]], *, with_length: bool) -> None:
        """Begin with these messages, in id order.

        Args: with_length: each row has its length in front, as a message has on its way between nodes.
        """
        lengths = [("length", "<u4")] if with_length else []
        kinds = [np.dtype([*lengths, ("row", _row_layout(example))]) for example in examples]
        self.data = bytearray().join(serialized(example, with_length=with_length) for example in examples)
        self._lengths = [len(example) for example in examples]
        self.rows: list[memoryview] = []
        """The bytes of each robot's row, which the next `set` changes."""
        self._groups: list[tuple[slice, np.ndarray]] = []
        first, start = 0, 0
        # Names differ in length, and lasers in their beams: 300 robots of one kind are three groups.
        for kind, equals in groupby(kinds):
            ids, size = slice(first, first + len(list(equals))), kind.itemsize
            count = ids.stop - ids.start
            self._groups.append((ids, np.frombuffer(self.data, kind, count, start)["row"]))
            self.rows += [memoryview(self.data)[at : at + size] for at in range(start, start + count * size, size)]
            first, start = ids.stop, start + count * size
        assert start == len(self.data), "a layout does not fit its messages"
        self._headers = [header for _, row in self._groups for header in _headers(row)]

    def set(self, path: str, values: Any) -> None:
        """Set a field of all robots' rows.

        Args:
            path:   number of the message in its row and names of fields, as in "0.pose.pose.position.x"; an array
                    without a fixed length is called as in "0.ranges.data".
            values: one per robot, in id order.
        """
        for ids, field in self._groups:
            for name in path.split("."):
                field = field[name]
            field[...] = values[ids]

    def chosen(self, present: np.ndarray | None) -> tuple[int, bytes | bytearray]:
        """Return how many messages the robots have that are there (None: all), and their bytes."""
        if present is None:
            return sum(self._lengths), self.data
        ids = np.flatnonzero(present).tolist()
        return sum(self._lengths[i] for i in ids), b"".join(self.rows[i] for i in ids)

    def stamp(self, time_ns: int, seq: int) -> None:
        """Set all headers to a time and a number."""
        secs, nsecs = divmod(time_ns, 10**9)
        for header in self._headers:
            header["seq"] = seq
            header["stamp"]["secs"] = secs
            header["stamp"]["nsecs"] = nsecs


def _headers(field: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the headers in a record, at whatever depth."""
    for name in field.dtype.names or ():
        if name == "header":
            yield field[name]
        else:
            yield from _headers(field[name])


class Serialized(Message):
    """A message that is bytes already; rospy keeps it for late subscribers."""

    __slots__ = ("data",)
    _slot_types = ("uint8[]",)

    def __init__(self, data: bytes) -> None:
        self.data = data

    def serialize(self, buff: Any) -> None:
        """Write the bytes."""
        buff.write(self.data)


def serialized(messages: Sequence[Message], *, with_length: bool) -> bytes:
    """Return the bytes of messages one after the other, and on demand their length in front."""
    buffer = BytesIO()
    for message in messages:
        message.serialize(buffer)
    data = buffer.getvalue()
    return len(data).to_bytes(4, "little") + data if with_length else data

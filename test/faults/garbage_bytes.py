"""Garbage messages: real ones with wrong bytes, lengths, numbers, array sizes, texts and stamps, or bytes at random."""

from __future__ import annotations

import math
import random
import struct
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import genpy
from input_fuzz import changed

ODD_FLOATS = (
    *(math.nan, math.inf, -math.inf, 0.0, -0.0, 1e300, -1e300, 1.7e308, 1e9, -1e9, 1e6, 1e38, 3.5e38),
    *(5e-324, -5e-324, 1e-310, 1e-45, 1e-300),
)
ODD_INTEGERS = (0, 1, -1, 2, 255, -128, 2**15, 2**31 - 1, -(2**31), 2**32 - 1, 2**63 - 1)
ODD_TEXTS = (
    "",
    "x" * 5000,
    "robot_0",
    "é\u2028\x00\x1b[31m",
    "{}",
    '{"a": [1e999]}',
    "[" * 200,
    "NaN",
    "../../x",
    "%s%n",
)
ARRAY_SIZES = (0, 1, 2, 3, 5, 64, 1000)
MAX_KEPT = 50
"""Real messages kept of each type; old ones are sent again, so that stamps come in random order."""
RANGES = {"int8": (-(2**7), 2**7 - 1), "uint8": (0, 2**8 - 1), "byte": (-(2**7), 2**7 - 1), "char": (0, 2**8 - 1)} | {
    f"{sign}int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for bits in (16, 32, 64)
    for sign in ("u", "")
}


class GarbageMaker:
    """Makes garbage of one type from a seed and from the real messages seen so far."""

    def __init__(self, message_class: Any, generator: random.Random) -> None:
        self._class = message_class
        self._random = generator
        self._real: list[bytes] = [_serialized(message_class())]
        self._kinds = (
            *((self._noise, 12), (self._truncated, 12), (self._lengthened, 8), (self._changed, 20)),
            *((self._with_odd_values, 38), (self._with_odd_stamp, 6), (self._repeated, 4)),
        )

    def learn(self, data: bytes) -> None:
        """Keep a real message."""
        if len(self._real) == MAX_KEPT:
            del self._real[self._random.randrange(MAX_KEPT)]
        self._real.append(data)

    def make(self) -> bytes:
        """Return the bytes of a message."""
        kinds, weights = zip(*self._kinds, strict=True)
        return self._random.choices(kinds, weights)[0]()

    def _noise(self) -> bytes:
        return self._random.randbytes(self._random.choice((0, 1, 4, 12, 16, 100, 700)))

    def _truncated(self) -> bytes:
        data = self._repeated()
        return data[: self._random.randrange(len(data) + 1)]

    def _lengthened(self) -> bytes:
        return self._repeated() + self._random.choice((b"\0", self._random.randbytes(5), b"\xff" * 3000))

    def _changed(self) -> bytes:
        return changed(self._repeated(), self._random)

    def _repeated(self) -> bytes:
        return self._random.choice(self._real)

    def _with_odd_stamp(self) -> bytes:
        data = self._repeated()
        if not self._class._has_header:
            return data
        secs = struct.unpack_from("<I", data, 4)[0]
        near = min(max(0, secs + self._random.randint(-2, 2)), 2**32 - 1)
        secs = self._random.choice((near, near, near, near, 0, 2**32 - 1, self._random.randrange(10**6)))
        nanoseconds = self._random.choice((10**8 * self._random.randrange(10), self._random.randrange(2**32)))
        return data[:4] + struct.pack("<II", secs, nanoseconds) + data[12:]

    def _with_odd_values(self) -> bytes:
        message = self._class().deserialize(self._repeated())
        places = list(_places(message))
        for owner, name, kind in self._random.sample(places, min(len(places), self._random.randint(1, 3))):
            setattr(owner, name, self._value(kind, getattr(owner, name)))
        try:
            return _serialized(message)
        except (genpy.SerializationError, struct.error, OverflowError):
            return self._changed()  # genpy refuses some values

    def _value(self, kind: str, value: Any) -> Any:
        element, is_array, size = _array(kind)
        if not is_array:
            return self._number(kind) if kind != "string" else self._random.choice(ODD_TEXTS)
        if size or (len(value) and self._random.random() < 0.5):  # one entry
            entries = list(value)
            entries[self._random.randrange(len(entries))] = self._entry(element)
            return entries
        count = self._random.choice((*ARRAY_SIZES, len(value) + 1, max(0, len(value) - 1)))
        return [value[i % len(value)] if len(value) else self._entry(element) for i in range(count)]

    def _entry(self, element: str) -> Any:
        if "/" in element:
            return genpy.message.get_message_class(element)() if element != "time" else genpy.Time()
        return self._random.choice(ODD_TEXTS) if element == "string" else self._number(element)

    def _number(self, kind: str) -> Any:
        if kind in ("float32", "float64"):
            value = self._random.choice(ODD_FLOATS)
            return value if kind == "float64" or abs(value) < 3.4e38 or not math.isfinite(value) else math.inf
        if kind == "bool":
            return self._random.random() < 0.5
        low, high = RANGES[kind]
        return min(max(self._random.choice(ODD_INTEGERS), low), high)


def _array(kind: str) -> tuple[str, bool, str]:
    """Return the type of the entries, whether it is an array, and its fixed size or ""."""
    element, bracket, size = kind.partition("[")
    return element, bool(bracket), size.rstrip("]")


def _places(message: Any) -> Iterator[tuple[Any, str, str]]:
    """Yield each attribute that may get another value, in nested messages, too: its owner, name and type."""
    for name, kind in zip(message.__slots__, message._slot_types, strict=True):
        value = getattr(message, name)
        element, is_array, _ = _array(kind)
        if is_array:
            yield message, name, kind
            if "/" in element:
                for entry in value:
                    yield from _places(entry)
        elif isinstance(value, genpy.Message):
            yield from _places(value)
        elif kind not in ("time", "duration"):
            yield message, name, kind


def _serialized(message: genpy.Message) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()

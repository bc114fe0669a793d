"""Where the team has listened, as far as one robot knows, and how robots tell each other."""

from __future__ import annotations

import functools
import struct
from collections.abc import Iterable

_ENTRY = struct.Struct(">HB")
"""The cell, and the loudness that would have been noticed; three bytes, as hexadecimal digits in a message."""

_LARGEST = 255


class ListeningLog:
    """The cells at which robots of the team listened, and the faintest voice that they would have noticed there.

    A message contains the sender's own new entries, and some of all that it knows, in turn. Entries may arrive twice,
    late or not at all: for each cell the smallest value counts, so all robots that know the same entries agree, and
    robots of a split team agree after they have met for some time.
    """

    def __init__(self) -> None:
        self._above: dict[int, int] = {}
        """Steps over the noise above which a voice would have been noticed, by cell."""
        self._texts: dict[int, str] = {}
        self._order: list[int] = []
        """The cells in the order in which the robot learned of them."""
        self._unsent: dict[int, None] = {}
        self._next = 0
        """Index in `_order` of the next old entry to send."""

    def __len__(self) -> int:
        return len(self._order)

    def add(self, cell: int, above: int, *, own: bool) -> bool:
        """Add an entry, of the robot itself or of a teammate; return whether it is news."""
        known = self._above.get(cell)
        if known is not None and known <= above:
            return False
        if known is None:
            self._order.append(cell)
        self._above[cell] = above
        self._texts[cell] = f"{cell:04x}{above:02x}"
        if own:
            self._unsent[cell] = None
        return True

    def merge(self, entries: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
        """Add entries of a teammate; return those that are news."""
        known = self._above
        news = [(cell, above) for cell, above in entries if above < known.get(cell, _LARGEST + 1)]
        return [(cell, above) for cell, above in news if self.add(cell, above, own=False)]

    def to_text(self, most: int, repeated: int) -> str:
        """Return at most `most` of the robot's own news, and `repeated` of all entries, in turn."""
        news = list(self._unsent)[-most:]
        for cell in news:
            del self._unsent[cell]
        if self._next >= len(self._order):
            self._next = 0
        old = self._order[self._next : self._next + repeated]
        self._next += repeated
        return "".join(map(self._texts.__getitem__, dict.fromkeys([*news, *old])))


# The robots of one process receive the same messages.
@functools.lru_cache(maxsize=1024)
def entries_in(text: str, num_cells: int) -> tuple[tuple[int, int], ...] | None:
    """Return the entries in a text from `to_text`; None if it does not fit a grid of so many cells."""
    try:
        data = bytes.fromhex(text)
    except ValueError:
        return None
    if len(data) % _ENTRY.size:
        return None
    entries = tuple(_ENTRY.iter_unpack(data))
    return entries if max(entries, default=(0, 0))[0] < num_cells else None


def limited(above: float) -> int:
    """Return a number of steps over the noise as an entry holds it: a whole number from 0 to 255, rounded up."""
    return min(max(-int(-above // 1), 0), _LARGEST)

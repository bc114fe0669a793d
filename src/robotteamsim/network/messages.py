"""Messages between robots, and the state of the network in one step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import overload

import msgspec
import numpy as np

from robotteamsim import _core

EVERYBODY = -1
"""Receiver of a broadcast, to all robots to which a path of links exists."""


class Message(msgspec.Struct, frozen=True):
    """One message; the payload is text (JSON by convention), so that it can be read in a bag."""

    sender: int
    receiver: int
    payload: str

    @property
    def num_bytes(self) -> int:
        """Size of the payload in UTF-8; a character that UTF-8 cannot encode counts as one byte."""
        return len(self.payload) if self.payload.isascii() else len(self.payload.encode(errors="replace"))


class Batch(msgspec.Struct, frozen=True, cache_hash=True):
    """Messages that arrive together, sorted by sender, then in the order of sending."""

    messages: tuple[Message, ...]


class Inbox(Sequence[Message]):
    """The messages that one robot receives in one step: a batch without its own messages.

    Connected robots share the batch, so that results derived from it need to be computed only once.
    """

    __slots__ = ("_begin", "_end", "batch")

    def __init__(self, batch: Batch, begin: int, end: int) -> None:
        """Args: begin, end: the messages of the batch from `begin` to before `end` are the robot's own."""
        self.batch = batch
        self._begin, self._end = begin, end

    def __len__(self) -> int:
        return len(self.batch.messages) - (self._end - self._begin)

    @overload
    def __getitem__(self, index: int) -> Message: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Message]: ...
    def __getitem__(self, index: int | slice) -> Message | Sequence[Message]:
        return self._received()[index]

    def __iter__(self) -> Iterator[Message]:
        return iter(self._received())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self._received() == tuple(other)

    def __hash__(self) -> int:
        return hash(self._received())

    def __repr__(self) -> str:
        return f"Inbox{self._received()}"

    def _received(self) -> tuple[Message, ...]:
        return self.batch.messages[: self._begin] + self.batch.messages[self._end :]


def batch_of(inbox: Sequence[Message]) -> Batch:
    """Return the batch of an inbox; the inbox itself if it was not made by the network."""
    return inbox.batch if isinstance(inbox, Inbox) else Batch(tuple(inbox))


class Refusal(msgspec.Struct, frozen=True):
    """A message that was not sent because it is larger than the limit, `network.max_message_bytes`."""

    sender: int
    num_bytes: int
    limit_bytes: int


class Traffic(msgspec.Struct, frozen=True):
    """Numbers of messages in one step, counted per receiver.

    delivered:    arrived in this step.
    lost:         lost on weak links, or because their path broke during the transfer.
    cut_off:      given up because no path of links led to the receiver.
    mean_delay_s: of those delivered, from the step of sending to this one [s]; 0 if nothing arrived.
    refused:      too large to be sent.
    """

    delivered: int = 0
    lost: int = 0
    cut_off: int = 0
    mean_delay_s: float = 0.0
    refused: tuple[Refusal, ...] = ()


NO_TRAFFIC = Traffic()


class NetworkState(msgspec.Struct, frozen=True, eq=False):
    """The network of n robots in one step: the links in a state, and the traffic.

    An absent robot has no links, is on no path and does not count; its rows and columns are 0, but -inf in `rssi_dbm`
    and -1 in `hop_count`, including the diagonal.
    """

    state: _core.state.State
    traffic: Traffic = NO_TRAFFIC
    """Numbers of messages delivered, lost, cut off and refused."""

    @property
    def rssi_dbm(self) -> np.ndarray:
        """Signals, float64, shape (n, n), symmetric; 0 on the diagonal."""
        return self.state.rssi_dbm

    @property
    def link(self) -> np.ndarray:
        """L of eq. (16), float64, shape (n, n): distance [m] or rssi [dBm]; 0 on the diagonal."""
        return self.state.link

    @property
    def adjacency(self) -> np.ndarray:
        """A of eq. (17), bool, shape (n, n)."""
        return self.state.adjacency

    @property
    def hop_count(self) -> np.ndarray:
        """C of eq. (18-20), int32, shape (n, n); 0 on the diagonal, -1 unreachable."""
        return self.state.hop_count

    @property
    def fiedler_value(self) -> float:
        """Algebraic connectivity, eq. (33); 0 exactly when the team is split."""
        return self.state.fiedler_value

    @property
    def endangered(self) -> np.ndarray:
        """Links that exist but are below the endangered threshold, bool, shape (n, n)."""
        return self.state.endangered

    @property
    def version(self) -> int:
        """Grows with each change of the links, of their dangers, and of who is present."""
        return self.state.links_version

    @property
    def break_matrix(self) -> np.ndarray:
        """C_break after eq. (21): `link` for pairs without a path, else 0; float64, shape (n, n)."""
        if self.fiedler_value > 0.0:  # All have paths.
            return np.zeros_like(self.link)
        is_there = np.diagonal(self.hop_count) == 0
        return np.where((self.hop_count < 0) & is_there & is_there[:, np.newaxis], self.link, 0.0)

    @property
    def num_endangered(self) -> int:
        """Number of endangered links."""
        return int(np.count_nonzero(self.endangered)) // 2

    @property
    def swarm_connectivity(self) -> float:
        """C_s of eq. (34): Fiedler value over the number of robots present."""
        return self.fiedler_value / max(int(np.count_nonzero(np.diagonal(self.hop_count) == 0)), 1)

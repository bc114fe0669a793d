"""What robots say to each other and what is known of the network in one step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

EVERYBODY = -1
"""Receiver of a message that all reachable robots get."""


@dataclass(frozen=True, slots=True)
class Message:
    """One message; the payload is text (JSON by custom), so that it can be read in a bag."""

    sender: int
    receiver: int
    payload: str

    @property
    def num_bytes(self) -> int:
        """Size of the payload in UTF-8; what no UTF-8 has counts as one byte."""
        return len(self.payload) if self.payload.isascii() else len(self.payload.encode(errors="replace"))


@dataclass(frozen=True, slots=True)
class Refusal:
    """A message that was not sent, as it is larger than `network.max_message_bytes`, the limit."""

    sender: int
    num_bytes: int
    limit_bytes: int


@dataclass(frozen=True, slots=True)
class Traffic:
    """What became of messages in one step, counted per receiver.

    delivered:    arrived in this step.
    lost:         lost on weak links, or on a path that broke while they were on their way.
    cut_off:      given up because no path of links led to the receiver.
    mean_delay_s: of those delivered, from the step of sending to this one [s]; 0 where nothing arrived.
    refused:      too large to be sent.
    """

    delivered: int = 0
    lost: int = 0
    cut_off: int = 0
    mean_delay_s: float = 0.0
    refused: tuple[Refusal, ...] = ()


NO_TRAFFIC = Traffic()


class NetworkState(NamedTuple):
    """The network of n robots in one step. Arrays may be those of the step before, and are to be read only.

    rssi_dbm:            float64, shape (n, n), symmetric; 0 on the diagonal.
    link:                float64, shape (n, n), L of eq. (16): distance [m] or rssi [dBm]; 0 on the diagonal.
    adjacency:           bool, shape (n, n), A of eq. (17).
    hop_count:           int32, shape (n, n), C of eq. (18-20); 0 on the diagonal, -1 unreachable.
    break_matrix:        float64, shape (n, n), `link` where no path exists, else 0.
    fiedler_value:       algebraic connectivity, eq. (33); 0 exactly when the team is split.
    endangered:          bool, shape (n, n): links that exist but are below the endangered threshold.
    traffic:             what became of messages.

    A robot that is not there has no link, is on no path and counts in no figure; its rows and columns are 0, but -inf
    in `rssi_dbm` and -1 in `hop_count`, the diagonal included.
    """

    rssi_dbm: np.ndarray
    link: np.ndarray
    adjacency: np.ndarray
    hop_count: np.ndarray
    break_matrix: np.ndarray
    fiedler_value: float
    endangered: np.ndarray
    traffic: Traffic = NO_TRAFFIC

    @property
    def num_endangered(self) -> int:
        """Number of endangered links."""
        return int(np.count_nonzero(np.triu(self.endangered, 1)))

    @property
    def swarm_connectivity(self) -> float:
        """C_s of eq. (34): Fiedler value over the number of robots that are there."""
        return self.fiedler_value / max(int(np.count_nonzero(np.diagonal(self.hop_count) == 0)), 1)

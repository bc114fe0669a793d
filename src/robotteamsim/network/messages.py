"""What robots say to each other and what is known of the network in one step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

EVERYBODY = -1
"""Receiver of a message that all reachable robots get."""


@dataclass(frozen=True, slots=True)
class Message:
    """One message; the payload is text (JSON by custom), so that it can be read in a bag."""

    sender: int
    receiver: int
    payload: str


@dataclass(frozen=True, slots=True)
class NetworkState:
    """The network of n robots in one step.

    rssi_dbm:            float64, shape (n, n), symmetric; 0 on the diagonal.
    link:                float64, shape (n, n), L of eq. (16): distance [m] or rssi [dBm]; 0 on the diagonal.
    adjacency:           bool, shape (n, n), A of eq. (17).
    hop_count:           int32, shape (n, n), C of eq. (18-20); 0 on the diagonal, -1 unreachable.
    break_matrix:        float64, shape (n, n), `link` where no path exists, else 0.
    fiedler_value:       algebraic connectivity, eq. (33); 0 exactly when the team is split.
    endangered:          bool, shape (n, n): links that exist but are below the endangered threshold.
    """

    rssi_dbm: np.ndarray
    link: np.ndarray
    adjacency: np.ndarray
    hop_count: np.ndarray
    break_matrix: np.ndarray
    fiedler_value: float
    endangered: np.ndarray

    @property
    def num_endangered(self) -> int:
        """Number of endangered links."""
        return int(np.count_nonzero(np.triu(self.endangered, 1)))

    @property
    def swarm_connectivity(self) -> float:
        """C_s of eq. (34): Fiedler value over the number of robots."""
        return self.fiedler_value / len(self.adjacency)

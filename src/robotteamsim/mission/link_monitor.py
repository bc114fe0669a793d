"""Watches the links of the team for those that become weak [5.3]."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.network.graph import newly_endangered
from robotteamsim.network.messages import NetworkState


class LinkMonitor:
    """Compares the network of each step with that of the step before."""

    def __init__(self) -> None:
        self._network: NetworkState | None = None
        self.num_endangered = 0
        """How often a link fell below the threshold of endangered links so far, lost or not."""

    def news(self, network: NetworkState) -> list[tuple[str, str]]:
        """Return the links that are newly endangered or lost, as "0-1", and what has happened to each."""
        before, self._network = self._network, network
        if before and network.endangered is before.endangered and network.adjacency is before.adjacency:
            return []
        states = [before, network] if before else [network]
        adjacency = np.stack([state.adjacency for state in states])
        endangered = np.stack([state.endangered for state in states])
        hops = np.stack([state.hop_count for state in states])
        pairs = np.argwhere(np.triu(newly_endangered(adjacency, endangered, hops)[-1], 1)).tolist()
        self.num_endangered += len(pairs)
        return [(f"{i}-{j}", _detail(network, i, j)) for i, j in pairs]


def _detail(network: NetworkState, i: int, j: int) -> str:
    what, rssi_dbm = "endangered" if network.adjacency[i, j] else "lost", network.rssi_dbm[i, j]
    at = "" if math.isnan(rssi_dbm) else f" at {rssi_dbm:.1f} dBm"
    return f"link {i}-{j} is {what}{at}"

"""Watches the links of the team for those that become weak [5.3]."""

from __future__ import annotations

import numpy as np

from robotteamsim.mission.events import LinkEndangered
from robotteamsim.network.graph import newly_endangered
from robotteamsim.network.messages import NetworkState


class LinkMonitor:
    """Compares the network of each step with that of the step before."""

    def __init__(self) -> None:
        self._network: NetworkState | None = None
        self.num_endangered = 0
        """How often a link fell below the threshold of endangered links so far, lost or not."""

    def news(self, network: NetworkState) -> list[LinkEndangered]:
        """Return the links that are newly endangered or lost."""
        before, self._network = self._network, network
        if before and network.endangered is before.endangered and network.adjacency is before.adjacency:
            return []
        states = [before, network] if before else [network]
        adjacency = np.stack([state.adjacency for state in states])
        endangered = np.stack([state.endangered for state in states])
        hops = np.stack([state.hop_count for state in states])
        pairs = np.argwhere(np.triu(newly_endangered(adjacency, endangered, hops)[-1], 1)).tolist()
        self.num_endangered += len(pairs)
        return [
            LinkEndangered(i, j, not network.adjacency[i, j], float(network.rssi_dbm[i, j]))  # as of this step
            for i, j in pairs
        ]

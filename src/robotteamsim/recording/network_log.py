"""What a trial did to the network of its team: time split, time with endangered links, breaks, lost messages."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np

from robotteamsim.network import NetworkState
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, StepRecord


class NetworkTotals(msgspec.Struct, frozen=True):
    """The network of a team while its mission ran.

    split_s:       time in which the present robots were not all connected.
    endangered_s:  time in which at least one link was endangered.
    breaks:        how often a link broke: it existed in one step and not in the next.
    messages_lost: copies that did not arrive: lost on weak links, or without a path to their receiver.
    base_areas, base_victims: explored areas and reached victims that the base knows; None without a base.
    """

    split_s: float
    endangered_s: float
    breaks: int
    messages_lost: int
    base_areas: int | None = None
    base_victims: int | None = None


class NetworkLog(Observer):
    """An observer that adds up the network of a trial."""

    def begin(self, setup: Setup) -> None:
        """Discard an earlier trial."""
        mission = setup.scenario.mission
        self._step_s = setup.scenario.run.step_s
        self._area_names = {area.name for area in mission.areas}
        self._has_base = setup.scenario.base is not None
        self._split = self._endangered = self._breaks = self._lost = 0
        self._known_areas = self._known_victims = 0
        self._before: NetworkState | None = None

    def step(self, record: StepRecord) -> None:
        """Add one step; links that break because a robot leaves do not count."""
        network, is_running = record.network, record.mission.state == "running"
        for event in record.events:
            if event.kind == "discovery_delivered":
                is_area = event.subject in self._area_names
                self._known_areas += is_area
                self._known_victims += not is_area
        if self._before is None or self._before.version != network.version:
            there = np.diagonal(network.hop_count) == 0
            self._is_split = bool(network.fiedler_value == 0.0 and np.count_nonzero(there) > 1)
            self._has_endangered = bool(network.endangered.any())
            if self._before is not None and is_running:
                broken = self._before.adjacency & ~network.adjacency & there & there[:, np.newaxis]
                self._breaks += int(np.count_nonzero(broken)) // 2
        self._before = network
        if is_running:
            self._split += self._is_split
            self._endangered += self._has_endangered
            self._lost += network.traffic.lost + network.traffic.cut_off

    @property
    def totals(self) -> NetworkTotals:
        """The totals so far."""
        return NetworkTotals(
            split_s=round(self._split * self._step_s, 6),
            endangered_s=round(self._endangered * self._step_s, 6),
            breaks=self._breaks,
            messages_lost=self._lost,
            base_areas=self._known_areas if self._has_base else None,
            base_victims=self._known_victims if self._has_base else None,
        )

    def values(self) -> dict[str, Any]:
        """Return the totals as plain values for JSON."""
        return {"network": msgspec.to_builtins(self.totals)}

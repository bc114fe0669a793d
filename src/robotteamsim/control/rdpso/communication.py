"""What one robot can know of its links, and where they draw it."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.network import fiedler_value
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Radio
from robotteamsim.swarm import (
    Vector,
    communication_attractor,
    communication_weight,
    robot_proximity_by_distance,
    robot_proximity_by_signal,
    swarm_connectivity,
)


class LinkKeeper:
    """The communication term of eq. (22) for one robot, silent while its link to the swarm is safe.

    With `control.communication.gated: false` it acts always, as printed.

    A robot knows the plan, the radio and where its teammates said they were; from these it predicts the link to keep:
    that to the nearest one, or (`control.kept_link: tree`) the weakest of its own links in the strongest tree that
    holds the team together. A team whose robots all keep their nearest neighbour can still fall into pairs. The range
    that x_CB keeps is d_max for links by distance. For links by signal it is the distance at which this link, with the
    walls that it crosses now, would be at the endangered threshold.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._c4 = scenario.control.c4
        self._is_gated = scenario.control.communication.gated
        self._keeps_tree = scenario.control.kept_link == "tree"
        self._network = scenario.network
        self._endangered_fraction = scenario.control.communication.endangered_fraction
        self._links_by_distance = scenario.network.link == "distance"
        self._tx_power_dbm, self._slope_db = scenario.radio.tx_power_dbm, scenario.radio.slope_db
        lost_dbm, endangered_dbm = scenario.network.lost_below_dbm, scenario.network.endangered_below_dbm
        self._lost_dbm, self._endangered_dbm = lost_dbm, endangered_dbm
        signal_at_1_m_dbm = scenario.radio.tx_power_dbm - scenario.radio.constant_loss_db
        # A hair above the limit keeps P_n defined where both thresholds, or q_1m and q_min, are one number.
        self._reference_dbm = max(signal_at_1_m_dbm, endangered_dbm, lost_dbm + 1e-9)
        at_risk_dbm = max(endangered_dbm, lost_dbm + 1e-9)
        self._endangered_proximity = robot_proximity_by_signal(at_risk_dbm, lost_dbm, self._reference_dbm)
        needs_field = self._c4 > 0.0 or scenario.control.adaptation != "none"
        self._field = _radio_field(scenario.plan, scenario.radio.model_dump_json()) if needs_field else None

    def pull(
        self, position: Vector, heard: Mapping[int, Vector], missing: Mapping[int, Vector], c4: float | None = None
    ) -> tuple[Vector, float]:
        """Return x_CB and the weight of the term; where that is 0, the robot's own position stands for x_CB.

        Args: heard: where the other members of the swarm are that reported in this iteration, by robot id.
              missing: where those were that did not; the swarm is split if there are any (C_s = 0 as far as known).
              c4: the weight of the term where it acts fully; None: that of the scenario.
        """
        members = missing or heard
        if self._field is None or not members:
            return position, 0.0
        if self._keeps_tree and not missing:
            neighbour = self._weakest_of_tree(position, list(heard.values()))
        else:
            neighbour = _core.base.nearest_point(position, list(members.values()))
        proximity, endangered, signal_dbm = self._link_to(position, neighbour)
        weight = self._c4 if c4 is None else c4
        if self._is_gated:
            weight = communication_weight(weight, proximity, endangered, not missing)
        if weight == 0.0:
            return position, 0.0
        return communication_attractor(position, neighbour, self._range_m(position, neighbour, signal_dbm)), weight

    def proximity(self, position: Vector, others: Sequence[Vector]) -> float:
        """Return P_n of eq. (31) or (32) for the nearest of the others, of which there is at least one."""
        return self._link_to(position, _core.base.nearest_point(position, others))[0]

    def connectivity(self, places: Sequence[Vector]) -> float:
        """Return C_s of eq. (34) for robots at these places, with the links that are predicted between them."""
        positions_m = np.array(places)
        if self._links_by_distance:
            is_link = _distances_m(positions_m) <= self._network.max_distance_m
        else:
            assert self._field is not None
            is_link = self._field.rssi_matrix_dbm(positions_m) >= self._lost_dbm
        np.fill_diagonal(is_link, False)
        return swarm_connectivity(fiedler_value(is_link), len(places))

    def in_reach(self, places: Sequence[Vector], resolution_m: float) -> np.ndarray | None:
        """Return the cells of the plan that have a good enough link to one of some places, bool, shape (rows, cols).

        Good enough is a signal down to the first third of the band between endangered and lost, or a distance that is
        not endangered. None where the term is switched off or there are no places: then no link is asked for.
        """
        if self._field is None or not places:
            return None
        if not self._links_by_distance:
            weakest_dbm = (2.0 * self._network.endangered_below_dbm + self._network.lost_below_dbm) / 3.0
            return self._field.best_rssi_map_dbm(places, resolution_m).values >= weakest_dbm
        cells = self._field.best_rssi_map_dbm(places[:1], resolution_m)
        rows, columns = cells.values.shape
        x_m = cells.origin_m[0] + (np.arange(columns) + 0.5) * resolution_m
        y_m = cells.origin_m[1] + (np.arange(rows) + 0.5) * resolution_m
        near = [np.hypot(x_m[None, :] - x, y_m[:, None] - y) for x, y in places]
        in_reach: np.ndarray = np.min(near, axis=0) <= self._endangered_fraction * self._network.max_distance_m
        return in_reach

    def _weakest_of_tree(self, position: Vector, places: list[Vector]) -> Vector:
        """Return the other end of the weakest link that a robot has in the strongest tree of it and these places."""
        positions_m = np.array([position, *places])
        if self._links_by_distance:
            strength = -_distances_m(positions_m)
        else:
            assert self._field is not None
            strength = self._field.rssi_matrix_dbm(positions_m)
        own = [(strength[a, b], max(a, b)) for a, b in strongest_tree(strength) if min(a, b) == 0]
        return places[min(own)[1] - 1]

    def _link_to(self, position: Vector, neighbour: Vector) -> tuple[float, float, float]:
        """Return P_n of a link, that of an endangered one, and its signal [dBm]; 0 for links by distance."""
        if self._links_by_distance:
            away_m = math.dist(position, neighbour)
            proximity = robot_proximity_by_distance(away_m, self._network.max_distance_m)
            return proximity, 1.0 - self._endangered_fraction, 0.0
        assert self._field is not None
        signal_dbm = self._tx_power_dbm - self._field.path_loss_db(position, neighbour)
        proximity = robot_proximity_by_signal(signal_dbm, self._lost_dbm, self._reference_dbm)
        return proximity, self._endangered_proximity, signal_dbm

    def _range_m(self, position: Vector, neighbour: Vector, signal_dbm: float) -> float:
        """Return the range that x_CB keeps on a link [m]."""
        if self._links_by_distance:
            return self._endangered_fraction * self._network.max_distance_m
        return float(math.dist(position, neighbour) * 10.0 ** ((signal_dbm - self._endangered_dbm) / self._slope_db))


def _distances_m(positions_m: np.ndarray) -> np.ndarray:
    """Return the distances between all pairs of points, shape (n, 2) [m]."""
    distances_m: np.ndarray = np.hypot(*(positions_m[:, None, :] - positions_m[None, :, :]).transpose(2, 0, 1))
    return distances_m


def strongest_tree(strength: np.ndarray) -> list[tuple[int, int]]:
    """Return the links of the tree over n nodes whose links are together the strongest, by Prim's algorithm [prim1957].

    Its weakest link is as strong as a tree's can be: while it stands, the nodes are connected.
    Args: strength: float64, shape (n, n), symmetric. Of equal links the one to the node of lower index is taken.
    """
    best, parent = strength[0].copy(), np.zeros(len(strength), dtype=np.int64)
    best[0] = -math.inf
    links = []
    for _ in range(len(strength) - 1):
        node = int(np.argmax(best))
        links.append((int(parent[node]), node))
        best[node] = -math.inf
        stronger = (strength[node] > best) & (best > -math.inf)
        best[stronger] = strength[node][stronger]
        parent[stronger] = node
    return links


@functools.lru_cache(maxsize=8)
def _radio_field(plan: FloorPlan, radio_json: str) -> RadioField:
    """Return the radio field that all robots of a plan share; nobody changes its doors."""
    return RadioField(plan, Radio.model_validate_json(radio_json))

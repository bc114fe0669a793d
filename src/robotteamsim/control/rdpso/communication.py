"""The links of one robot, as far as it knows them, and the attractor x_CB."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from robotteamsim import _core, swarm
from robotteamsim.network import fiedler_value
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.sections import Radio
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


class LinkKeeper:
    """The communication term of eq. (22) for one robot; it is zero while the link to the swarm is safe.

    With `control.communication.gated: false` it always acts, as in the printed equation.

    From the plan, the radio model and the positions that teammates sent, a robot predicts the link to keep: that to the
    nearest teammate, or (`control.kept_link: tree`) the weakest of its own links in the strongest spanning tree of the
    team. A team whose robots all keep their nearest neighbour can still split into pairs. The range that x_CB keeps is
    d_max for links by distance. For links by signal it is the distance at which this link, with the walls that it
    crosses now, would be at the endangered threshold.
    """

    def __init__(self, setup: Setup) -> None:
        scenario = setup.scenario
        control = scenario.control.as_kind(RdpsoControl)
        self._c4 = control.c4
        self._is_gated = control.communication.gated
        self._keeps_tree = control.kept_link == "tree"
        self._network = scenario.network
        self._endangered_fraction = control.communication.endangered_fraction
        self._links_by_distance = scenario.network.link == "distance"
        self._tx_power_dbm, self._slope_db = scenario.radio.tx_power_dbm, scenario.radio.slope_db
        lost_dbm, endangered_dbm = scenario.network.lost_below_dbm, scenario.network.endangered_below_dbm
        self._lost_dbm, self._endangered_dbm = lost_dbm, endangered_dbm
        signal_at_1_m_dbm = scenario.radio.tx_power_dbm - scenario.radio.constant_loss_db
        # Slightly above the limit, so that P_n is defined even if both thresholds, or q_1m and q_min, are equal.
        self._reference_dbm = max(signal_at_1_m_dbm, endangered_dbm, lost_dbm + 1e-9)
        at_risk_dbm = max(endangered_dbm, lost_dbm + 1e-9)
        self._endangered_proximity = swarm.robot_proximity_by_signal(at_risk_dbm, lost_dbm, self._reference_dbm)
        needs_field = self._c4 > 0.0 or control.adaptation != "none"
        self._field = setup.building.shared(_radio_field, scenario.radio.model_dump_json()) if needs_field else None

    def pull(
        self, position: Vector, heard: Mapping[int, Vector], missing: Mapping[int, Vector], c4: float | None = None
    ) -> tuple[Vector, float]:
        """Return x_CB and the weight of the term; if the weight is 0, x_CB is the robot's own position.

        Args: heard: positions of the other members of the swarm that sent an update in this iteration, by robot id.
              missing: last positions of those that did not; if there are any, the swarm counts as split (C_s = 0).
              c4: the largest weight of the term; None: that of the scenario.
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
            weight = swarm.communication_weight(weight, proximity, endangered, not missing)
        if weight == 0.0:
            return position, 0.0
        if self._links_by_distance:
            range_m = self._endangered_fraction * self._network.max_distance_m
        else:
            range_m = math.dist(position, neighbour) * 10.0 ** ((signal_dbm - self._endangered_dbm) / self._slope_db)
        return swarm.communication_attractor(position, neighbour, range_m), weight

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
        return swarm.swarm_connectivity(fiedler_value(is_link), len(places))

    def in_reach(self, places: Sequence[Vector], resolution_m: float) -> np.ndarray | None:
        """Return the cells of the plan with a good enough link to one of some places, bool, shape (rows, cols).

        Good enough is a signal in the upper third of the band between endangered and lost or above it, or a distance
        that is not endangered. None if the term is switched off or there are no places: then no link is required.
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
        """Return the other end of a robot's weakest link in the strongest spanning tree of it and these places."""
        positions_m = np.array([position, *places])
        if self._links_by_distance:
            strength = -_distances_m(positions_m)
        else:
            assert self._field is not None
            strength = self._field.rssi_matrix_dbm(positions_m)
        own = [(strength[a, b], max(a, b)) for a, b in strongest_tree(strength) if min(a, b) == 0]
        return places[min(own)[1] - 1]

    def _link_to(self, position: Vector, neighbour: Vector) -> tuple[float, float, float]:
        """Return P_n of a link, P_n at the endangered threshold, and the signal [dBm], 0 for links by distance."""
        if self._links_by_distance:
            away_m = math.dist(position, neighbour)
            proximity = swarm.robot_proximity_by_distance(away_m, self._network.max_distance_m)
            return proximity, 1.0 - self._endangered_fraction, 0.0
        assert self._field is not None
        signal_dbm = self._tx_power_dbm - self._field.path_loss_db(position, neighbour)
        proximity = swarm.robot_proximity_by_signal(signal_dbm, self._lost_dbm, self._reference_dbm)
        return proximity, self._endangered_proximity, signal_dbm


def _distances_m(positions_m: np.ndarray) -> np.ndarray:
    """Return the distances between all pairs of points, shape (n, 2) [m]."""
    distances_m: np.ndarray = np.hypot(*(positions_m[:, None, :] - positions_m[None, :, :]).transpose(2, 0, 1))
    return distances_m


def strongest_tree(strength: np.ndarray) -> list[tuple[int, int]]:
    """Return the links of the maximum spanning tree over n nodes, by Prim's algorithm [prim1957].

    No spanning tree has a stronger weakest link; while it exists, the nodes are connected.
    Args: strength: float64, shape (n, n), symmetric. Among equal links, that to the node with the lower index counts.
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


def _radio_field(building: Building, radio_json: str) -> RadioField:
    """Return the radio field that all robots share; its doors must not be changed."""
    return RadioField(building.plan, Radio.model_validate_json(radio_json))

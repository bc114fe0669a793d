"""The terms of eq. (22) and (25): memory, local best, obstacles and communication, each for one robot."""

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np

from robotteamsim import _core, swarm
from robotteamsim.control.driving.known_map import GRID_RESOLUTION_M, KnownMap
from robotteamsim.control.driving.navigation import laser_layout
from robotteamsim.control.driving.places import OtherPlaces
from robotteamsim.control.rdpso.team import Best
from robotteamsim.network import fiedler_value
from robotteamsim.propagation import RadioField, shared_radio_field
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Laser
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector, memory_term


class Momentum:
    """The velocities of a robot in the last iterations, and their weighted sum."""

    def __init__(self, coefficients: tuple[float, ...], of: Literal["motion", "commands"] = "motion") -> None:
        """Args: coefficients: the weights of v[t], v[t-1], ...

        of: `motion` remembers the velocities that the robot really had: a blocked robot had none. `commands` remembers
        the velocities that it chose, as in the printed equations.
        """
        self.coefficients = coefficients
        self._of = of
        self._velocities: deque[Vector] = deque(maxlen=len(coefficients))
        """Newest first [m per iteration]."""
        self._position: Vector | None = None

    def note(self, position: Vector) -> None:
        """Note the robot's position, in `map` [m], once per iteration."""
        if self._of == "motion" and self._position is not None:
            self._velocities.appendleft((position[0] - self._position[0], position[1] - self._position[1]))
        self._position = position

    def note_command(self, velocity: Vector) -> None:
        """Note the velocity that the robot chose [m per iteration]."""
        if self._of == "commands":
            self._velocities.appendleft(velocity)

    def forget(self) -> None:
        """Restart from rest."""
        self._position = None
        self._velocities.clear()

    def term(self) -> Vector:
        """Return the weighted sum of the past velocities [m per iteration]."""
        return memory_term(self.coefficients, self._velocities)


class Approach:
    """Notes whether a robot comes nearer to the global best than it was since that place became the best.

    The best of a particle is a place where it was. A robot hears a voice from afar and drives to its loudest cell; on
    the way the best cannot improve, but the swarm does not stagnate (ours).
    """

    def __init__(self) -> None:
        self.nearer = False
        """Whether it did in the last call of `note`."""
        self._place: Vector | None = None
        self._nearest_m = math.inf

    def note(self, place: Vector, path_m: float) -> None:
        """Note the global best and the length of the path to it [m], once per iteration.

        Less than a cell of the map is not nearer: a robot that converges to a place does not arrive.
        """
        if place != self._place:
            self._place, self._nearest_m = place, path_m
            self.nearer = False
            return
        self.nearer = path_m <= self._nearest_m - GRID_RESOLUTION_M
        if self.nearer:
            self._nearest_m = path_m

    def forget(self) -> None:
        """Forget the place."""
        self.nearer, self._place = False, None


class RuledOut(_core.control.RuledOut):
    """The places that the team has ruled out since the voice map last changed.

    Within the local-best radius of a robot, a victim can only be at the loudest cell that it hears, and not even there
    once a robot was next to it, because the victim would then be saved and silent [5.3]. Otherwise a voice behind a
    wall, loudest at that wall, would hold the swarm there until all robots are excluded.

    `add` notes the loudest cell that a robot hears at its position, or None; of robots that hear the same within 0.25 m
    of each other, only the first counts. `covers` is whether no victim can be at a cell, although a voice is heard
    there; never with `control.rule_out_places: false`. `clear` discards everything, because the voice map has changed.
    A robot's own note takes its place among those of `add_all` that contain it.
    """

    def __init__(self, scenario: Scenario, is_on: bool = True) -> None:
        """Args: is_on: `control.rule_out_places`."""
        cell_m = scenario.voice.map_resolution_m
        # A victim may be anywhere in a cell of the voice map.
        save_m = scenario.mission.save_distance_m
        next_to_m = max(0.5 * save_m, save_m - cell_m)
        super().__init__(radius_m=scenario.voice.local_best_radius_m, cell_m=cell_m, next_to_m=next_to_m)
        self._is_on = is_on

    def covers(self, place: Vector) -> bool:
        """Whether no victim can be at a cell, although a voice is heard there."""
        return self._is_on and super().covers(place)


class LocalBestFinder:
    """Finds the best place around a robot."""

    def __init__(self, scenario: Scenario) -> None:
        self._radius_m = scenario.voice.local_best_radius_m
        self._by_path = scenario.control.navigation == "path"

    def find(
        self,
        known_map: KnownMap,
        is_vain: Callable[[Vector], bool],
        voice: VoiceReading,
        area: Vector | None,
        position: Vector,
    ) -> Best | None:
        """Return the loudest cell nearby; if no voice is heard, the cell with the shortest path to the area [5.3].

        None if there is neither a voice nor an area. Places in `map` [m].

        Args: is_vain: whether a voice whose loudest place is this one is ignored.
        """
        if voice.heard and not is_vain(voice.local_best_m):
            return Best(voice.local_best_level_db, voice.local_best_m)
        if area is None:
            return None
        if not self._by_path:
            cell = known_map.nearest_by_sight(area, position, self._radius_m)
            return Best(-math.dist(area, cell), cell)
        cell, length_m = known_map.nearest_by_path(area, position, self._radius_m)
        return Best(-length_m, cell)


_BEAMS = 60
"""At least this many beams are used: with a field of view of 270 degrees, one every 4.5 degrees."""

_HEADINGS = 13
"""Number of equal sectors of the field of view whose borders are the compared directions."""


class Surroundings(_core.control.Surroundings):
    """Finds x_OB: the place with the best clearance within the sensing radius r_s that the laser sees as free.

    `clearest_place` returns the place farthest from all hits [m, map], of the robot's own and those along 13 headings
    at half the radius and at the full radius; None if no obstacle is within the sensing radius (then c3 = 0).
    """

    def __init__(self, laser: Laser, sensing_radius_m: float) -> None:
        stride = max(1, laser.beams // _BEAMS)
        beams = len(range(0, laser.beams, stride))
        low_rad = last_rad = laser.angle_min_rad
        if laser.beams > 1:
            last_rad += (beams - 1) * stride * (laser.angle_max_rad - low_rad) / (laser.beams - 1)
        angles_rad = np.linspace(low_rad, laser.angle_max_rad, laser.beams)
        self._cos, self._sin = np.cos(angles_rad), np.sin(angles_rad)
        self._mount_m, self._longest_m = (laser.forward_m, laser.left_m), laser.range_max_m * (1.0 - 1e-6)
        super().__init__(
            laser=laser_layout(laser.model_copy(update={"beams": beams, "angle_max_rad": last_rad})),
            stride=stride,
            sensing_radius_m=sensing_radius_m,
            headings_rad=np.linspace(low_rad, laser.angle_max_rad, _HEADINGS).tolist(),
        )

    def clearance_m(self, ranges_m: np.ndarray) -> float:
        """Return the distance from base_link to the nearest obstacle that the laser sees [m]; infinite if none."""
        seen = ranges_m < self._longest_m
        if not seen.any():
            return math.inf
        ranges_m = ranges_m[seen]
        x_m, y_m = self._mount_m[0] + ranges_m * self._cos[seen], self._mount_m[1] + ranges_m * self._sin[seen]
        return float(np.hypot(x_m, y_m).min())


_OLDEST = 10
"""The walls that a robot finds change its radio field after so many versions of its map: a field takes 0.1 s."""


class LinkKeeper:
    """The communication term of eq. (22) for one robot; it is zero while the link to the swarm is safe.

    With `control.communication.gated: false` it always acts, as in the printed equation.

    From the plan, the radio model and the positions that teammates sent, a robot predicts the link to keep: that to the
    nearest teammate, or (`control.kept_link: tree`) the weakest of its own links in the strongest spanning tree of the
    team. A team whose robots all keep their nearest neighbour can still split into pairs. The range that x_CB keeps is
    d_max for links by distance. For links by signal it is the distance at which this link, with the walls that it
    crosses now, would be at the endangered threshold.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
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
        self._needs_field = self._c4 > 0.0 or control.adaptation != "none"
        self._building, self._radio = setup.map_of(robot_id), scenario.radio
        self._known_field: RadioField | None = None
        self._next_version = 0

    @property
    def _field(self) -> RadioField | None:
        """The radio field of the building as known, at most _OLDEST versions ago; None: the term does not need one."""
        if self._needs_field and self._building.version >= self._next_version:
            self._next_version = self._building.version + _OLDEST
            self._known_field = shared_radio_field(self._building, self._radio)
        return self._known_field

    def pull(
        self, position: Vector, heard: Mapping[int, Vector], missing: Mapping[int, Vector], c4: float | None = None
    ) -> tuple[Vector, float]:
        """Return x_CB and the weight of the term; if the weight is 0, x_CB is the robot's own position.

        Args: heard: positions of the other members of the swarm that sent an update in this iteration, by robot id.
              missing: last positions of those that did not; if there are any, the swarm counts as split (C_s = 0),
              unless the term is gated and the link to the nearest of these positions would be safe.
              c4: the largest weight of the term; None: that of the scenario.
        """
        members = missing or heard
        if self._field is None or not members:
            return position, 0.0
        if self._keeps_tree and not missing:
            neighbour = self._weakest_of_tree(position, list(heard.values()))
        else:
            neighbour = (
                members.nearest(position)
                if isinstance(members, OtherPlaces)
                else _core.base.nearest_point(position, list(members.values()))
            )
        proximity, endangered, signal_dbm = self._link_to(position, neighbour)
        if missing and self._is_gated and proximity >= endangered:
            # No place has a better link to it: it is lost, or somewhere else.
            return self.pull(position, heard, {}, c4)
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

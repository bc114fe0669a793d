"""What one robot can know of its links, and where they draw it."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping

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
)

ENDANGERED_FRACTION = 0.8
"""With links by distance, one longer than this part of d_max is endangered (ours; no source says)."""


class LinkKeeper:
    """The communication term of eq. (22) for one robot, silent while its link to the swarm is safe.

    A robot knows the plan, the radio and where its teammates said they were; from these it predicts its link to the
    nearest one. The range that x_CB keeps is d_max for links by distance. For links by signal it is the distance at
    which this link, with the walls that it crosses now, would be at the endangered threshold.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._c4 = scenario.control.c4
        self._network = scenario.network
        self._radio = scenario.radio
        self._field = _radio_field(scenario.plan, scenario.radio.model_dump_json()) if self._c4 > 0.0 else None

    def pull(
        self, position: Vector, heard: Mapping[int, Vector], missing: Mapping[int, Vector]
    ) -> tuple[Vector, float]:
        """Return x_CB and the weight of the term.

        Args: heard: where the other members of the swarm are that reported in this iteration, by robot id.
              missing: where those were that did not; the swarm is split if there are any (C_s = 0 as far as known).
        """
        members = missing or heard
        if self._field is None or not members:
            return position, 0.0
        neighbour = min(members.values(), key=functools.partial(math.dist, position))
        if self._network.link == "distance":
            proximity, endangered, range_m = self._by_distance(position, neighbour)
        else:
            proximity, endangered, range_m = self._by_signal(position, neighbour)
        weight = communication_weight(self._c4, proximity, endangered, connected=not missing)
        return communication_attractor(position, neighbour, range_m), weight

    def _by_distance(self, position: Vector, neighbour: Vector) -> tuple[float, float, float]:
        d_max_m = self._network.max_distance_m
        proximity = robot_proximity_by_distance(math.dist(position, neighbour), d_max_m)
        return proximity, 1.0 - ENDANGERED_FRACTION, ENDANGERED_FRACTION * d_max_m

    def _by_signal(self, position: Vector, neighbour: Vector) -> tuple[float, float, float]:
        assert self._field is not None
        signal_dbm = self._radio.tx_power_dbm - self._field.path_loss_db(position, neighbour)
        signal_at_1_m_dbm = self._radio.tx_power_dbm - self._radio.constant_loss_db
        lost_dbm, endangered_dbm = self._network.lost_below_dbm, self._network.endangered_below_dbm
        # A hair above the limit keeps P_n defined where both thresholds, or q_1m and q_min, are one number.
        reference_dbm = max(signal_at_1_m_dbm, endangered_dbm, lost_dbm + 1e-9)
        proximity = robot_proximity_by_signal(signal_dbm, lost_dbm, reference_dbm)
        endangered = robot_proximity_by_signal(max(endangered_dbm, lost_dbm + 1e-9), lost_dbm, reference_dbm)
        range_m = math.dist(position, neighbour) * 10.0 ** ((signal_dbm - endangered_dbm) / self._radio.slope_db)
        return proximity, endangered, range_m


@functools.lru_cache(maxsize=8)
def _radio_field(plan: FloorPlan, radio_json: str) -> RadioField:
    """Return the radio field that all robots of a plan share; nobody changes its doors."""
    return RadioField(plan, Radio.model_validate_json(radio_json))

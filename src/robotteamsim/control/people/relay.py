"""A relay: a robot that stands where it connects the command centre, firefighters and searchers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.control.cover.floor_cover import CELL_M
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.driving.path_controller import PathController, Situation
from robotteamsim.control.people.messages import RelayUpdate, parse_relay, whereabouts_in
from robotteamsim.control.rdpso.terms import strongest_tree
from robotteamsim.interface import EVERYBODY, Decision, Message
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.sections import Radio
from robotteamsim.setup import Setup

_MARGIN_DB = 6.0
"""Links that are this much above the endangered threshold need no relay."""


class RelayController(PathController):
    """The controller of a relay.

    In each iteration it predicts, from the plan and the positions that teammates send, the strongest spanning tree of
    base, firefighters and searchers. The relays, in the order of their ids, are each placed where they help the weakest
    link of that tree most, given those before. A relay goes to its place as long as a link needs one, and then stays.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        super().__init__(robot_id, setup)
        scenario = setup.scenario
        self._iteration_ns = round(scenario.control.iteration_s * 1e9)
        self._iteration = -1
        self._heard: dict[int, tuple[float, Point]] = {}
        """The last position of each teammate, and when it was heard [s]."""
        self._relays = {robot_id}
        self._given_up_s = scenario.relays.given_up_s
        if scenario.base is not None and scenario.base != robot_id:
            self._heard[scenario.base] = float("inf"), setup.start_m(scenario.base)
        reach_m, start = setup.robots[robot_id].reach_m, setup.start_m(robot_id)
        self._links = setup.map_of(robot_id).shared(_LinkPredictor, scenario.radio.model_dump_json(), reach_m, start)
        self._needed_dbm = scenario.network.endangered_below_dbm + _MARGIN_DB
        self._goal: Point | None = None

    def note(self, now: Situation) -> None:
        """Note where teammates are."""
        for message in now.inbox:
            found = whereabouts_in(message.payload)
            if found is None or found[0] != message.sender or message.sender == self.scenario.base:
                continue
            self._heard[message.sender] = now.time_s, found[1]
            if parse_relay(message.payload) is not None:
                self._relays.add(message.sender)

    def decide(self, now: Situation) -> Decision:
        """Return the command towards the relay's place and, once per iteration, its position."""
        outbox: tuple[Message, ...] = ()
        iteration = now.observation.sim_time_ns // self._iteration_ns
        if iteration != self._iteration:
            self._iteration = iteration
            self._goal = self._place(now.time_s) or self._goal
            update = RelayUpdate(self.robot_id, now.position)
            outbox = (Message(self.robot_id, EVERYBODY, update.to_json()),)
        if self.scenario.base == self.robot_id:
            return Decision(outbox=outbox)
        if self._goal is None or self.driver.hot.is_hot(self._goal):
            return self.stand(now, outbox)
        return self.drive(now, self._goal, outbox)

    def _place(self, time_s: float) -> Point | None:
        """Return where to stand; None: no link needs this relay."""
        known = {i: place for i, (heard_s, place) in self._heard.items() if time_s - heard_s <= self._given_up_s}
        relays = sorted(i for i in self._relays if i in known or i == self.robot_id)
        places = [place for i, place in sorted(known.items()) if i not in self._relays]
        for relay in relays:
            if len(places) < 2:
                return None
            weakest_dbm, first, second = self._links.weakest(places)
            if weakest_dbm >= self._needed_dbm:
                return None
            best = self._links.between(places[first], places[second])
            if relay == self.robot_id or best is None:
                return best
            places.append(best)
        return None


class _LinkPredictor:
    """Predicted signals between places on a plan, and the places that a robot can reach from its start."""

    def __init__(self, building: MapSource, radio_json: str, radius_m: float, start: Point) -> None:
        plan = building.plan
        self._field = RadioField(plan, Radio.model_validate_json(radio_json))
        grid = known_map(building, radius_m).grid
        cells = self._field.rssi_map_dbm(plan.bounds.min, CELL_M)
        rows, columns = cells.values.shape
        self._middles = [[cells.cell_center(row, column) for column in range(columns)] for row in range(rows)]
        free_start = grid.nearest_free(start, 1.0)
        if free_start is None:
            self._is_free = np.zeros(cells.values.shape, dtype=bool)
        else:
            lengths = grid.distance_map(free_start)
            self._is_free = np.isfinite([[grid.value_at(lengths, place) for place in row] for row in self._middles])

    def weakest(self, places: Sequence[Point]) -> tuple[float, int, int]:
        """Return the weakest link of the strongest spanning tree: its signal [dBm] and its ends, by index."""
        signals_dbm = self._field.rssi_matrix_dbm(np.array(places))
        return min((float(signals_dbm[a, b]), a, b) for a, b in strongest_tree(signals_dbm))

    def between(self, first: Point, second: Point) -> Point | None:
        """Return the free place whose weaker link to two others is the strongest; None if no place is free."""
        maps = self._field.rssi_maps_dbm([first, second], CELL_M)
        weaker = np.where(self._is_free, np.minimum(maps[0].values, maps[1].values), -np.inf)
        row, column = np.unravel_index(int(np.argmax(weaker)), weaker.shape)
        return self._middles[int(row)][int(column)] if self._is_free[row, column] else None

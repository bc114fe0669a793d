"""A relay: a robot that stands where it connects the command centre, firefighters and searchers."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np

from robotteamsim.control.cover.floor_cover import CELL_M
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.driving.localisation import body_of
from robotteamsim.control.driving.path_controller import PathController
from robotteamsim.control.people.messages import RelayUpdate, parse_relay, whereabouts_in
from robotteamsim.control.rdpso.communication import strongest_tree
from robotteamsim.interface import EVERYBODY, Decision, Message, Observation, Task
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Radio
from robotteamsim.world.placement import placed_robots

_MARGIN_DB = 6.0
"""Links that are this much above the endangered threshold need no relay."""


class RelayController(PathController):
    """The controller of a relay.

    In each iteration it predicts, from the plan and the positions that teammates send, the strongest spanning tree of
    base, firefighters and searchers. The relays, in the order of their ids, are each placed where they help the weakest
    link of that tree most, given those before. A relay goes to its place as long as a link needs one, and then stays.
    """

    def __init__(self, robot_id: int, scenario: Scenario) -> None:
        super().__init__(robot_id, scenario)
        self._iteration_ns = round(scenario.control.iteration_s * 1e9)
        self._iteration = -1
        self._heard: dict[int, tuple[float, Point]] = {}
        """The last position of each teammate, and when it was heard [s]."""
        self._relays = {robot_id}
        self._given_up_s = scenario.control.cover.given_up_s
        if scenario.base is not None and scenario.base != robot_id:
            x, y, _ = placed_robots(scenario)[scenario.base].start_pose
            self._heard[scenario.base] = float("inf"), (x, y)
        start = placed_robots(scenario)[robot_id].start_pose[:2]
        radius_m = body_of(robot_id, scenario).reach_m
        self._links = _predictor(scenario.plan, scenario.radio.model_dump_json(), radius_m, start)
        self._needed_dbm = scenario.network.endangered_below_dbm + _MARGIN_DB
        self._goal: Point | None = None

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Note where teammates are."""
        super().observe(observation, inbox, task)
        for message in inbox:
            found = whereabouts_in(message.payload)
            if found is None or found[0] != message.sender or message.sender == self.scenario.base:
                continue
            self._heard[message.sender] = self.time_s, found[1]
            if parse_relay(message.payload) is not None:
                self._relays.add(message.sender)

    def decide(self) -> Decision:
        """Return the command towards the relay's place and, once per iteration, its position."""
        if not self.is_running:
            return Decision()
        pose = self.pose()
        position = (pose.x_m, pose.y_m)
        outbox: tuple[Message, ...] = ()
        iteration = self.observation.sim_time_ns // self._iteration_ns
        if iteration != self._iteration:
            self._iteration = iteration
            self._goal = self._place() or self._goal
            update = RelayUpdate(self.robot_id, position)
            outbox = (Message(self.robot_id, EVERYBODY, update.to_json()),)
        if self.scenario.base == self.robot_id:
            return Decision(outbox=outbox)
        if self._goal is None or self._hot.is_hot(self._goal):
            return self.stand(pose, outbox)
        return self.drive(pose, self._goal, outbox)

    def _place(self) -> Point | None:
        """Return where to stand; None: no link needs this relay."""
        known = {i: place for i, (heard_s, place) in self._heard.items() if self.time_s - heard_s <= self._given_up_s}
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

    def __init__(self, plan: FloorPlan, radio_json: str, radius_m: float, start: Point) -> None:
        self._field = RadioField(plan, Radio.model_validate_json(radio_json))
        grid = known_map(plan, radius_m).grid
        cells = self._field.rssi_map_dbm(plan.bounds.min, CELL_M)
        rows, columns = cells.values.shape
        x_m, y_m = (cells.origin_m[axis] + (np.arange(n) + 0.5) * CELL_M for axis, n in enumerate((columns, rows)))
        self._middles: list[list[Point]] = [[(x, y) for x in x_m.tolist()] for y in y_m.tolist()]
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


# Relays and trials share it: it depends only on these values.
_predictor = functools.lru_cache(maxsize=8)(_LinkPredictor)

"""The command centre: it gathers what is reported, and sends firefighters to victims by the shortest total path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.control.cover.floor_cover import parse_cover_update
from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.control.driving.known_map import UNREACHABLE_M, known_map
from robotteamsim.control.people.floor_search import FloorSearch
from robotteamsim.control.people.messages import Order, Orders
from robotteamsim.errors import ScenarioError
from robotteamsim.extras import missing_extra
from robotteamsim.interface import EVERYBODY, Decision, Message, Observation, Task
from robotteamsim.interface.discovery import announced_in
from robotteamsim.interface.firefighter import FirefighterUpdate, parse_firefighter_update
from robotteamsim.scenario.base import Point
from robotteamsim.setup import Setup

PRICE_STEP_M = 0.1
"""The total of an auction is at most this much above the shortest [m]."""


def hungarian(costs: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs (row, column) with the least total cost, by SciPy's `linear_sum_assignment` [crouse2016].

    Args:   costs: float64, shape (n, m), finite; min(n, m) pairs are assigned.
    Raises: ScenarioError: SciPy is not installed.
    """
    try:
        from scipy.optimize import linear_sum_assignment
    except ImportError as error:
        text = missing_extra(error) or str(error)
        raise ScenarioError(f"firefighters.dispatch.method: hungarian: {text}; or choose auction") from None
    rows, columns = linear_sum_assignment(costs)
    return list(zip(rows.tolist(), columns.tolist(), strict=True))


def auction(costs: np.ndarray) -> list[tuple[int, int]]:
    """Return pairs (row, column) whose total is at most PRICE_STEP_M above the least, by an auction [bertsekas1988].

    Each bidder without an object raises the price of the object that is best for them until it is only just so. The
    smaller side bids. Args: as `hungarian`.
    """
    if costs.shape[0] > costs.shape[1]:
        return sorted((row, column) for column, row in auction(costs.T))
    num_bidders, num_objects = costs.shape
    if num_bidders == 0:
        return []
    step_m = PRICE_STEP_M / num_bidders
    prices = np.zeros(num_objects)
    owner = np.full(num_objects, -1)
    waiting = list(range(num_bidders))[::-1]
    while waiting:
        bidder = waiting.pop()
        values = -costs[bidder] - prices
        best = int(np.argmax(values))
        second = np.max(np.delete(values, best)) if num_objects > 1 else values[best]
        prices[best] += values[best] - second + step_m
        if owner[best] >= 0:
            waiting.append(int(owner[best]))
        owner[best] = bidder
    return sorted((int(bidder), column) for column, bidder in enumerate(owner.tolist()) if bidder >= 0)


METHODS = {"hungarian": hungarian, "auction": auction}
"""By the name in `firefighters.dispatch.method`."""


@dataclass(frozen=True, slots=True)
class _News:
    """Where a victim was, and when [s of the mission]."""

    position: Point
    time_s: float


class DispatchController:
    """The controller of the command centre, which stands still.

    In each iteration, and as soon as news arrives, it assigns the firefighters who are free to the victims who wait, by
    the shortest total of paths on the map that it knows, and sends all orders to everybody. A victim to whom no path is
    open waits for better news; one whom somebody did not find comes after all others. A firefighter out of contact
    keeps the last order, until they are given up.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        """Raises: ScenarioError: the method needs a package that is not installed."""
        scenario = setup.scenario
        assert scenario.firefighters is not None
        self._robot_id = robot_id
        self._section = scenario.firefighters.dispatch
        self._assign = METHODS[self._section.method]
        try:
            self._assign(np.zeros((1, 1)))
        except ScenarioError as error:
            raise ScenarioError(scenario.origin.line(str(error), "firefighters.dispatch.method")) from None
        self._iteration_ns = round(scenario.control.iteration_s * 1e9)
        self._iteration = -1
        self._position = setup.start_m(robot_id)
        self._search = FloorSearch(robot_id, setup, scenario.firefighters.floor_search)
        """Which floor has been searched, passed on to those who have not heard it from each other."""
        self._building, self._reach_m = setup.map_of(robot_id), scenario.firefighters.reach_m
        self._map = known_map(self._building, self._reach_m, by="people")
        self._hot = HotPlaces(scenario.plan, scenario.firefighters.block_c)
        self._news: dict[str, _News] = {}
        """Of the victims who wait, by name."""
        self._missed: set[str] = set()
        """Victims whom somebody did not find, by name."""
        # A voice is located at the loudest place near the listener, who stands on free floor.
        self._near_m = max(scenario.mission.save_distance_m, scenario.voice.local_best_radius_m)
        self._closed_s: dict[str, float] = {}
        """Victims who are safe (for good) or were not found, and until when news of them does not count [s]."""
        self._reports: dict[int, tuple[float, FirefighterUpdate]] = {}
        """The last report of each firefighter, and when it arrived [s]."""
        self._orders: dict[int, Order] = {}
        self._has_news = False

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Note what has arrived, and return the orders if they are due."""
        time_s = observation.sim_time_ns * 1e-9
        self._note(inbox, task, time_s)
        if self._hot.update(observation.sim_time_ns):
            self._map = known_map(self._building, self._reach_m, (), self._hot.blocked, by="people")
            self._has_news = True
        iteration = observation.sim_time_ns // self._iteration_ns
        is_due = self._has_news or iteration != self._iteration
        self._iteration = iteration
        if not (task.running and is_due):
            return Decision()
        self._has_news = False
        self._assign_all(time_s)
        orders = Orders(self._robot_id, self._position, tuple(order for _, order in sorted(self._orders.items())))
        updates = orders.to_json(), self._search.update(self._position).to_json()
        return Decision(outbox=tuple(Message(self._robot_id, EVERYBODY, payload) for payload in updates))

    def _note(self, inbox: Sequence[Message], task: Task, time_s: float) -> None:
        """Note the discoveries and reports that have arrived, and what the centre itself has discovered."""
        for own in task.undelivered:
            if own.robot_id == self._robot_id and own.kind == "victim":
                self._hear_of(own.name, own.position_m, own.time_s)
        for message in inbox:
            for found in announced_in(message.payload):
                if found.kind == "victim" and found.name and found.position_m is not None:
                    self._hear_of(found.name, found.position_m, found.time_s or 0.0)
            update = parse_cover_update(message.payload)
            if update is not None:
                self._search.hear(update)
                self._hot.hear_temperatures(update.hot or ())
            report = parse_firefighter_update(message.payload)
            if report is not None and report.robot_id == message.sender:
                self._note_report(report, time_s)

    def _hear_of(self, name: str, position: Point, time_s: float) -> None:
        known = self._news.get(name)
        if (known is None or time_s > known.time_s) and time_s > self._closed_s.get(name, -1.0):
            self._news[name] = _News(position, time_s)
            self._has_news = True

    def _note_report(self, report: FirefighterUpdate, time_s: float) -> None:
        before = self._reports.get(report.robot_id)
        self._reports[report.robot_id] = time_s, report
        for name in report.safe:
            self._close(name, math.inf)
        for name, seen_s in report.missing:
            if name in self._news and self._news[name].time_s <= seen_s:
                self._close(name, seen_s)
                self._missed.add(name)
        self._has_news |= before is None or before[1].helping != report.helping

    def _close(self, name: str, until_s: float) -> None:
        self._closed_s[name] = until_s
        self._has_news |= self._news.pop(name, None) is not None

    def _assign_all(self, time_s: float) -> None:
        """Choose the orders from now on."""
        ages_s = {i: time_s - heard_s for i, (heard_s, _) in self._reports.items()}
        # Whoever is given up is not in contact, either.
        timeout_s = min(self._section.contact_timeout_s, self._section.given_up_s)
        in_contact = [i for i, age_s in sorted(ages_s.items()) if age_s <= timeout_s]
        kept = {
            i: order
            for i, order in self._orders.items()
            if i not in in_contact and ages_s[i] <= self._section.given_up_s and order.victim in self._news
        }
        reports = {i: self._reports[i][1] for i in ages_s if ages_s[i] <= self._section.given_up_s}
        helped = {report.victim for report in reports.values() if report.helping}
        taken = helped | {order.victim for order in kept.values()}
        free = [i for i in in_contact if not reports[i].helping]
        waiting = [name for name in sorted(self._news) if name not in taken]
        first = self._best(free, [name for name in waiting if name not in self._missed])
        left = [i for i in free if i not in first]
        self._orders = kept | first | self._best(left, [name for name in waiting if name in self._missed])

    def _best(self, free: Sequence[int], waiting: Sequence[str]) -> dict[int, Order]:
        """Return the orders of free firefighters, to those of the waiting victims whom they can reach."""
        lengths = np.array(
            [[self._length_m(self._place(i), self._news[name].position) for name in waiting] for i in free]
        ).reshape(len(free), len(waiting))
        reached: np.ndarray = np.any(lengths < UNREACHABLE_M, axis=0)
        lengths, names = lengths[:, reached], [name for name, can in zip(waiting, reached.tolist(), strict=True) if can]
        costs = lengths.copy()
        for row, firefighter in enumerate(free):
            order = self._orders.get(firefighter)
            if order is not None and order.victim in names:
                costs[row, names.index(order.victim)] -= self._section.keep_m
        pairs = [(free[r], names[c]) for r, c in self._assign(costs) if lengths[r, c] < UNREACHABLE_M]
        return {i: Order(i, name, self._news[name].position, self._news[name].time_s) for i, name in pairs}

    def _length_m(self, position: Point, victim: Point) -> float:
        """Return the length of the path to a victim [m]; at least UNREACHABLE_M if it does not lead near enough."""
        start = self._map.grid.nearest_free(position, 1.0)
        if start is None or not self._map.reaches(start, victim, self._near_m):
            return UNREACHABLE_M + math.dist(position, victim)
        return self._map.distance_m(victim, position)

    def _place(self, firefighter: int) -> Point:
        return self._reports[firefighter][1].position

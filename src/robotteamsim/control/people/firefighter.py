"""A firefighter: searches, follows the orders of the command centre, and brings victims to safety."""

from __future__ import annotations

import math

from robotteamsim.control.cover.floor_cover import parse_cover_update
from robotteamsim.control.driving.path_controller import PathController, Situation
from robotteamsim.control.people.felt_floor import FeltFloor
from robotteamsim.control.people.floor_search import FloorSearch
from robotteamsim.control.people.messages import Order, parse_orders
from robotteamsim.control.rdpso.terms import RuledOut
from robotteamsim.interface import EVERYBODY, Assistance, Decision, Discovery, Message
from robotteamsim.interface.firefighter import FirefighterUpdate
from robotteamsim.scenario.base import Point
from robotteamsim.setup import Setup

_ARRIVED_M = 0.3
"""At this distance from where contact was lost, a firefighter has returned."""
_FELT_SHARE = 0.6
"""Of the distance at which a victim is reached; the rest is for a victim between the points that are felt."""


class FirefighterController(PathController):
    """The controller of a firefighter.

    A firefighter with a victim goes to the nearest safe place. One with an order goes to its victim, to the position of
    the order or, if they have seen the victim themselves since then, where they saw them. Near it, they feel their way
    over the floor, and report who was not found. Without contact to the command centre, a firefighter finishes the last
    order, returns to where contact was lost, and then to the centre. Everybody else searches the floor, and follows
    voices, but not to places that are too hot or where nobody can be.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        super().__init__(robot_id, setup)
        scenario = setup.scenario
        assert scenario.firefighters is not None
        assert scenario.base is not None
        self._section, self._dispatch = scenario.firefighters, scenario.firefighters.dispatch
        self._walking_mps = scenario.firefighters.drive.max_speed_mps
        self._iteration_ns = round(scenario.control.iteration_s * 1e9)
        self._iteration = -1
        self._centre_id, self._centre = scenario.base, setup.start_m(scenario.base)
        self._safe_places = [self._centre, *(way_out.center for way_out in scenario.mission.exits)]
        self._search = FloorSearch(robot_id, setup, scenario.firefighters.floor_search)
        self._ruled_out, self._epoch = RuledOut(scenario), -1
        self._order: Order | None = None
        self._looking_since_s: float | None = None
        """Since when the firefighter has looked around near the place of the order; None: not there yet."""
        self._felt: FeltFloor | None = None
        """The floor near that place."""
        self._assistance: Assistance | None = None
        self._seen: dict[str, Discovery] = {}
        """Own discoveries of victims who may still wait, by name."""
        self._safe: tuple[str, ...] = ()
        self._missing: tuple[tuple[str, float], ...] = ()
        self._contact_s = 0.0
        self._contact_place: Point | None = None
        self._returns = False
        """Whether the firefighter is on the way back to where contact was lost."""

    def note(self, now: Situation) -> None:
        """Note own discoveries, the victim in their care, orders, and what others have searched."""
        for found in now.task.undelivered:
            is_own_victim = found.robot_id == self.robot_id and found.kind == "victim"
            if is_own_victim and not self._is_settled(found.name, found.time_s):
                self._seen[found.name] = found
        own = [assistance for assistance in now.task.assistance if assistance.robot_id == self.robot_id]
        if self._assistance is not None and not own:
            self._finish(self._assistance.victim, now.time_s)
        self._assistance = own[0] if own else None
        for message in now.inbox:
            update = parse_cover_update(message.payload)
            if update is not None and update.robot_id == message.sender:
                self._search.hear(update)
                self.driver.hot.hear_temperatures(update.hot or ())
            orders = parse_orders(message.payload) if message.sender == self._centre_id else None
            if orders is not None:
                self._follow({order.firefighter: order for order in orders.orders}.get(self.robot_id), now)

    def decide(self, now: Situation) -> Decision:
        """Return the command and, once per iteration, the messages of this step."""
        goal = self._goal(now)
        outbox = self._messages(now)
        if goal is None or math.dist(now.position, goal) < self.scenario.control.navigator.arrived_m:
            return self.stand(now, outbox) if self._assistance is None else Decision(outbox=outbox)
        return self.drive(now, goal, outbox)

    def _follow(self, order: Order | None, now: Situation) -> None:
        """Take an order, or none, which has just arrived."""
        self._contact_s, self._returns = now.time_s, False
        self._contact_place = now.position
        if order is not None and self._is_settled(order.victim, order.time_s):
            order = None  # the centre has not heard yet
        if order != self._order:
            self._order, self._looking_since_s, self._felt = order, None, None

    def _is_settled(self, victim: str, news_s: float) -> bool:
        """Whether a victim is safe, or was not found by news of this time or later ones [s]."""
        return victim in self._safe or any(name == victim and missed_s >= news_s for name, missed_s in self._missing)

    def _finish(self, victim: str, time_s: float) -> None:
        """Note that a victim is in no need of help any more."""
        self._safe = (*self._safe, victim)
        self._seen.pop(victim, None)
        if self._order is not None and self._order.victim == victim:
            self._order = None
        self._returns = not self._is_in_contact(time_s)

    def _is_in_contact(self, time_s: float) -> bool:
        return time_s - self._contact_s <= self._dispatch.contact_timeout_s

    def _goal(self, now: Situation) -> Point | None:
        """Return where to go in this step; None: stay."""
        position, time_s = now.position, now.time_s
        self.speed_mps = self._walking_mps
        if self._assistance is not None:
            self._search.pause()
            self.speed_mps = self._section.escort_speed_mps
            return self._nearest_safe_place(position) if self._assistance.moving else None
        target = self._target(position, time_s)
        if target is not None:
            self._search.pause()
            return target
        if time_s - self._contact_s > self._dispatch.alone_s:
            self._returns = True
        if self._returns and self._contact_place is not None:
            self._search.pause()
            if math.dist(position, self._contact_place) <= _ARRIVED_M:
                self._contact_place = self._centre
            return self._contact_place
        if not self._section.searches:
            return None
        return self._voice(now) or self._search.choose(position, time_s, self.driver.hot)

    def _voice(self, now: Situation) -> Point | None:
        """Return where a voice leads; None if none is heard, or only from where nobody can be or go."""
        voice = now.observation.voice
        if now.task.epoch != self._epoch:
            self._epoch = now.task.epoch
            self._ruled_out.clear()
        self._ruled_out.add(now.position, voice.local_best_m if voice.heard else None)
        place = voice.local_best_m
        if voice.heard and (self._ruled_out.covers(place) or self.driver.hot.is_hot(place)):
            self._search.leave_voice()
            return None
        return self._search.follow(now.position, voice, now.time_s)

    def _target(self, position: Point, time_s: float) -> Point | None:
        """Return the place of the victim to go to: that of the order or, without contact, the nearest one seen."""
        if self._order is None and self._seen and not self._is_in_contact(time_s):
            found = self._seen.values()
            nearest = min(found, key=lambda one: (self.driver.map.distance_m(one.position_m, position), one.name))
            self._order = Order(self.robot_id, nearest.name, nearest.position_m, nearest.time_s)
        order = self._order
        if order is None:
            return None
        own = self._seen.get(order.victim)
        place = order.position if own is None or own.time_s < order.time_s else own.position_m
        if self._felt is None and math.dist(position, place) <= self._dispatch.feel_m:
            near_m = _FELT_SHARE * self.scenario.mission.save_distance_m
            self._looking_since_s = time_s
            self._felt = FeltFloor(self.driver.map, place, self._dispatch.feel_m, near_m)
        if self._looking_since_s is None or self._felt is None:
            return place
        looking_s = time_s - self._looking_since_s
        point = self._felt.next_point(position, time_s, self.driver.hot)
        if looking_s > self._dispatch.feel_s or (point is None and looking_s > self._dispatch.look_around_s):
            self._give_up(order, own)
            return None
        return point or place

    def _give_up(self, order: Order, own: Discovery | None) -> None:
        """Note that the victim of the order was not found."""
        news_s = order.time_s if own is None else max(order.time_s, own.time_s)
        self._missing = (*self._missing, (order.victim, news_s))
        self._seen.pop(order.victim, None)
        self._order = self._looking_since_s = self._felt = None

    def _nearest_safe_place(self, position: Point) -> Point:
        return min(self._safe_places, key=lambda place: self.driver.map.distance_m(place, position))

    def _messages(self, now: Situation) -> tuple[Message, ...]:
        """Return the report to the command centre and the update for those who search, once per iteration."""
        iteration = now.observation.sim_time_ns // self._iteration_ns
        if iteration == self._iteration:
            return ()
        self._iteration, position = iteration, now.position
        self._search.look(position)
        helped = "" if self._assistance is None else self._assistance.victim
        victim = helped or ("" if self._order is None else self._order.victim)
        report = FirefighterUpdate(self.robot_id, position, victim, helped != "", self._safe, self._missing)
        updates = report.to_json(), self._search.update(position, self.driver.hot.seen).to_json()
        return tuple(Message(self.robot_id, EVERYBODY, payload) for payload in updates)

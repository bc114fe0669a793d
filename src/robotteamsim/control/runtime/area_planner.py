"""Which area a robot explores next, with another `mission.area_order` than given: it chooses, and shares its choice.

It is the future work of 6.2 of the dissertation, for all controllers: they drive to the area of their task as before.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import msgspec

from robotteamsim.control.baselines.sebs import gain, visit_probability
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.interface import EVERYBODY, Controller, Decision, Message, Observation, Task
from robotteamsim.interface.area_news import AreaNews, area_news, area_news_in
from robotteamsim.interface.closed_area import closed_area_in
from robotteamsim.scenario.controllers.patrolling import SebsControl
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

BestArea = Callable[[Sequence[int], Vector], int]
"""Returns the best of some areas, by their indices, for a robot at a position in `map` [m]."""


class AreaPlanner:
    """Runs a robot's controller with a task of the robot's own: the area that it has chosen, and those that it knows.

    It learns from the mission of the areas that it has explored itself, and in its next area whether somebody else has
    explored that one; of all others it learns from the messages of its team, which it repeats. It chooses again when
    its area is explored or closed; with `sebs` and `search` also when a teammate with a lower id announces the same
    area, so that a team that starts together spreads. It announces its choice at once and then every
    `control.iteration_s`.
    """

    def __init__(self, controller: Controller, robot_id: int, setup: Setup, best_area: BestArea | None = None) -> None:
        """Args: best_area: needed for the order `search`."""
        scenario, control = setup.scenario, setup.scenario.control
        self.controller = controller
        self._robot_id, self._team_size = robot_id, scenario.num_robots
        self._areas, self._order = scenario.mission.areas, scenario.mission.area_order
        self._drives_to_areas, self._ends_in_last = control.drives_to_areas, control.values_areas
        self._best_area = best_area
        self._sebs = control.as_kind(SebsControl)
        self._map = known_map(setup.map_of(robot_id), setup.robots[robot_id].reach_m)
        self._period_ns = round(control.iteration_s * 1e9)
        self._due_ns = 0
        self._began_ns: int | None = None
        """The stamp of the first step in which the mission ran."""
        self._explored: set[int] = set()
        self._closed: set[int] = set()
        """The areas to which the controller has reported no path since an area was explored."""
        self._intended: dict[int, int | None] = {}
        """The area to which each teammate goes, by robot id."""
        self._next: int | None = None

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision for the robot's own area, with the announcements that are due."""
        before = self._next, len(self._explored)
        inbox = self._read(inbox)
        self._learn(i for i, finder in enumerate(task.explored_by[: len(self._areas)]) if finder == self._robot_id)
        self._look_around(observation, task)
        if task.running and self._began_ns is None:
            self._began_ns = observation.sim_time_ns
        left = [index for index in range(len(self._areas)) if index not in self._explored]
        if self._next not in left or self._next in self._closed:
            self._choose(observation, left)
        decision = self.controller.step(observation, inbox, self._own_task(task, left))
        # The guard reports a result that is not a Decision.
        if not isinstance(decision, Decision) or not isinstance(decision.outbox, (tuple, list)) or not task.running:
            return decision
        self._note_closed(decision)
        outbox = tuple(decision.outbox)
        if observation.sim_time_ns >= self._due_ns or before != (self._next, len(self._explored)):
            self._due_ns = observation.sim_time_ns + self._period_ns
            news = AreaNews(tuple(sorted(self._explored)), self._announced)
            outbox = (*outbox, Message(self._robot_id, EVERYBODY, area_news(news)))
        area = -1 if self._announced is None else self._announced
        return msgspec.structs.replace(decision, outbox=outbox, area=area)

    @property
    def _announced(self) -> int | None:
        """The area to which the robot goes; None for controllers that do not drive to areas."""
        return self._next if self._drives_to_areas else None

    def _read(self, inbox: Sequence[Message]) -> Sequence[Message]:
        """Process the news in an inbox, and return the other messages."""
        found = [area_news_in(message.payload) for message in inbox]
        if not any(found):
            return inbox
        for message, news in zip(inbox, found, strict=True):
            if news is None or message.sender == self._robot_id:
                continue
            if any(index >= len(self._areas) for index in (*news.explored, news.next or 0)):
                continue  # of another scenario
            self._learn(news.explored)
            is_new = self._intended.get(message.sender) != news.next
            self._intended[message.sender] = news.next
            if is_new and news.next == self._next and message.sender < self._robot_id and self._spreads:
                self._next = None
        return [message for message, news in zip(inbox, found, strict=True) if news is None]

    def _look_around(self, observation: Observation, task: Task) -> None:
        """Learn in the next area whether somebody else has explored it, without a message of them."""
        if self._next is None or self._next >= len(task.explored_by) or task.explored_by[self._next] < 0:
            return
        area, pose = self._areas[self._next], observation.pose
        if math.dist((pose.x_m, pose.y_m), area.center) <= area.radius_m:
            self._learn((self._next,))

    def _learn(self, explored: Iterable[int]) -> None:
        new = set(explored) - self._explored
        if new:
            self._explored |= new
            self._closed.clear()

    @property
    def _spreads(self) -> bool:
        """Whether robots avoid the areas of others."""
        return self._order in ("sebs", "search")

    def _note_closed(self, decision: Decision) -> None:
        for message in decision.outbox:
            if self._next is not None and isinstance(message, Message):
                center = closed_area_in(message.payload)
                if center is not None and center == self._areas[self._next].center:
                    self._closed.add(self._next)

    def _choose(self, observation: Observation, left: Sequence[int]) -> None:
        """Choose the next area of those that are left; those that are closed come last."""
        if not self._drives_to_areas:
            self._next = next((index for index in left if index not in self._closed), left[0] if left else None)
            return
        # A team that searches enters the last area of all when the search is over, so all must agree which that is.
        open_areas = [index for index in (left[:-1] if self._ends_in_last else left) if index not in self._closed]
        candidates = open_areas or [index for index in left if index not in self._closed] or left
        if self._next not in candidates:
            self._next = self._best(candidates, observation) if candidates else None

    def _best(self, candidates: Sequence[int], observation: Observation) -> int:
        pose = observation.pose
        position = pose.x_m, pose.y_m
        intended = [index for index in self._intended.values() if index is not None]
        if self._order == "search" and self._best_area is not None:
            free = [index for index in candidates if index not in intended]
            return self._best_area(free or candidates, position)
        lengths_m = {index: self._map.distance_m(self._areas[index].center, position) for index in candidates}
        if self._order == "nearest":
            return min(candidates, key=lambda index: (lengths_m[index], index))
        idle_s = 0.0 if self._began_ns is None else 1e-9 * (observation.sim_time_ns - self._began_ns)
        worth = {
            index: visit_probability(
                gain(idle_s, lengths_m[index], self._sebs), intended.count(index), self._team_size, self._sebs
            )
            for index in candidates
        }
        return max(candidates, key=lambda index: (worth[index], -lengths_m[index], -index))

    def _own_task(self, task: Task, left: Sequence[int]) -> Task:
        """Return the task with the robot's own area; robots that go to the same area have the same epoch."""
        area = None if self._next is None else self._areas[self._next]
        number = 0 if self._next is None else self._next + 1
        return msgspec.structs.replace(
            task,
            epoch=task.epoch * (len(self._areas) + 1) + number,
            area_center_m=None if area is None else area.center,
            area_radius_m=0.0 if area is None else area.radius_m,
            rivals=tuple(sorted(i for i, area in self._intended.items() if area is not None and area == self._next)),
            areas_left=(*(() if self._next is None else (self._next,)), *(i for i in left if i != self._next)),
        )

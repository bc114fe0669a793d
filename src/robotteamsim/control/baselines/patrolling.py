"""Base class of the controllers that patrol a graph: they go from vertex to vertex."""

from __future__ import annotations

import abc
import math
from collections.abc import Sequence

from robotteamsim.control.baselines.patrol_graph import patrol_graph
from robotteamsim.control.driving.path_controller import PathController, Situation
from robotteamsim.interface import Decision
from robotteamsim.network.messages import Message
from robotteamsim.scenario.controllers.patrolling import PatrolControl
from robotteamsim.setup import Setup

LONGEST_TIMED_M = 1000.0
"""Limit of the length in the timeout [m]: places without a free path have a huge length, but must time out as well."""


class PatrolController(PathController, abc.ABC):
    """Starts at the nearest vertex and then goes to the one that `_next_vertex` returns; it gives up after a timeout.

    `_visited_s` is when each vertex was last visited, as far as this robot knows. Voices and areas have no influence.
    """

    def __init__(self, robot_id: int, setup: Setup, control: PatrolControl, arrival: int = 1) -> None:
        super().__init__(robot_id, setup, arrival)
        self._timeout_factor, self._timeout_s = control.timeout_factor, control.timeout_s
        self._arrived_m = setup.scenario.mission.patrol.arrived_m
        self._graph = patrol_graph(setup, setup.robots[robot_id].reach_m)
        self._visited_s = [0.0] * len(self._graph.places)
        self._at = -1
        self._goal = -1
        self._until_s = 0.0

    def decide(self, now: Situation) -> Decision:
        """Return the command towards the chosen vertex, and messages if a vertex is reached."""
        self._listen(now.inbox, now.time_s)
        if self._goal < 0:
            vertex = self._graph.nearest(now.position)
        elif math.dist(now.position, self._graph.places[self._goal]) < self._arrived_m:
            self._visited_s[self._goal] = now.time_s
            self._at = self._goal
            vertex = self._next_vertex(self._at, now.time_s)
        elif now.time_s > self._until_s:
            # The path is blocked: choose the next vertex as if this one had been reached.
            vertex = self._next_vertex(self._goal, now.time_s)
        else:
            return self.drive(now, self._graph.places[self._goal])
        self._go_to(vertex, now)
        return self.drive(now, self._graph.places[vertex], self._announced(vertex))

    @abc.abstractmethod
    def _next_vertex(self, vertex: int, time_s: float) -> int:
        """Return the vertex to visit after this one. Args: time_s: of this step [s]."""

    def _listen(self, inbox: Sequence[Message], time_s: float) -> None:
        """Process the messages of this step [s]; none by default."""

    def _announced(self, vertex: int) -> tuple[Message, ...]:
        """Return the messages about the vertex that was reached and the next one; none by default."""
        return ()

    def _go_to(self, vertex: int, now: Situation) -> None:
        self._goal = vertex
        distance_m = self.driver.map.distance_m(self._graph.places[vertex], now.position)
        travel_s = self._timeout_factor * min(distance_m, LONGEST_TIMED_M) / self.speed_mps
        self._until_s = now.time_s + self._timeout_s + travel_s

"""Base class of the controllers that patrol a graph: they go from vertex to vertex."""

from __future__ import annotations

import abc
import math

from robotteamsim.control.baselines.patrol_graph import patrol_graph
from robotteamsim.control.driving.localisation import body_of
from robotteamsim.control.driving.path_controller import PathController
from robotteamsim.interface import Decision
from robotteamsim.network.messages import Message
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector

LONGEST_TIMED_M = 1000.0
"""Limit of the length in the timeout [m]: places without a free path have a huge length, but must time out as well."""


class PatrolController(PathController, abc.ABC):
    """Starts at the nearest vertex and then goes to the one that `_next_vertex` returns; it gives up after a timeout.

    `_visited_s` is when each vertex was last visited, as far as this robot knows. Voices and areas have no influence.
    """

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, scenario, arrival)
        self._patrol = scenario.control.patrol
        self._graph = patrol_graph(scenario, body_of(robot_id, scenario).reach_m)
        self._visited_s = [0.0] * len(self._graph.places)
        self._at = -1
        self._goal = -1
        self._until_s = 0.0

    def decide(self) -> Decision:
        """Return the command towards the chosen vertex, and messages if a vertex is reached."""
        if not self.is_running:
            return Decision()
        self._listen()
        pose = self.pose()
        position = (pose.x_m, pose.y_m)
        if self._goal < 0:
            vertex = self._graph.nearest(position)
        elif math.dist(position, self._graph.places[self._goal]) < self._patrol.arrived_m:
            self._visited_s[self._goal] = self.time_s
            self._at = self._goal
            vertex = self._next_vertex(self._at)
        elif self.time_s > self._until_s:
            # The path is blocked: choose the next vertex as if this one had been reached.
            vertex = self._next_vertex(self._goal)
        else:
            return self.drive(pose, self._graph.places[self._goal])
        self._go_to(vertex, position)
        return self.drive(pose, self._graph.places[vertex], self._announced(vertex))

    @abc.abstractmethod
    def _next_vertex(self, vertex: int) -> int:
        """Return the vertex to visit after this one."""

    def _listen(self) -> None:
        """Process the messages of this step; none by default."""

    def _announced(self, vertex: int) -> tuple[Message, ...]:
        """Return the messages about the vertex that was reached and the next one; none by default."""
        return ()

    def _go_to(self, vertex: int, position: Vector) -> None:
        self._goal = vertex
        distance_m = self.map.distance_m(self._graph.places[vertex], position)
        travel_s = self._patrol.timeout_factor * min(distance_m, LONGEST_TIMED_M) / self.speed_mps
        self._until_s = self.time_s + self._patrol.timeout_s + travel_s

"""SEBS: patrol of a graph by state exchange [portugal2013]."""

import math
from typing import Annotated

import msgspec

from robotteamsim.control.baselines.patrol_graph import patrol_graph
from robotteamsim.control.driving.localisation import body_of
from robotteamsim.control.driving.path_controller import PathController
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.interface import Decision
from robotteamsim.interface.payload import Index, Update, update_reader
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.patrol import Patrol
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector

LONGEST_TIMED_M = 1000.0
"""Limit of the length in the timeout [m]: places without a free path have a huge length, but must time out as well."""


class Visit(Update, frozen=True, gc=False, tag="sebs"):
    """The message of a robot to its team: the vertex that it has reached (-1: none yet) and the next one."""

    robot_id: Index
    reached: Annotated[int, msgspec.Meta(ge=-1, le=2**31 - 1)]
    intends: Index


parse_visit = update_reader(Visit, kept=8192)
"""Return the visit in a message; None if it is another message."""


def gain(idleness_s: float, length_m: float, patrol: Patrol) -> float:
    """Return the gain of visiting a vertex: its idleness over the length of the edge [s/m]."""
    return idleness_s / max(length_m, patrol.edge_min_m)


def visit_probability(gain_s_per_m: float, num_intending: int, team_size: int, patrol: Patrol) -> float:
    """Return the posterior of visiting a vertex, up to a factor that is the same for all vertices.

    G1 exp(ln(1/G1) gain / G2), 1 where gain >= G2, times 2^(R - count) / (2^R - 1): it decreases with the number of
    teammates that intend to go there.

    Args: num_intending: count, the number of teammates that announced it.  team_size: R.
    """
    probability = 1.0
    if gain_s_per_m < patrol.g2:
        probability = patrol.g1 * math.exp(math.log(1.0 / patrol.g1) * gain_s_per_m / patrol.g2)
    # Simplified, because 2^R of a thousand robots exceeds the range of a float.
    return probability * 2.0**-num_intending / (1.0 - 2.0**-team_size)


class SebsController(PathController):
    """Goes from vertex to vertex, each time to the neighbour with the highest posterior, and announces each visit.

    It computes idleness and intentions from its own visits and those that it received. It ignores voices and areas, and
    finds victims only by passing them.
    """

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, scenario, arrival)
        self._patrol = scenario.control.patrol
        self._graph = patrol_graph(scenario, body_of(robot_id, scenario).reach_m)
        self._team_size = scenario.num_robots
        self._rng = robot_stream(scenario, "sebs", robot_id, arrival)
        self._visited_s = [0.0] * len(self._graph.places)
        self._intentions: dict[int, int] = {}
        """The vertex that each teammate announced as its next one, by robot id."""
        self._at = -1
        self._goal = -1
        self._until_s = 0.0

    def decide(self) -> Decision:
        """Return the command towards the chosen vertex, and the visit if one is reached."""
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
        visit = Message(self.robot_id, EVERYBODY, Visit(self.robot_id, self._at, vertex).to_json())
        return self.drive(pose, self._graph.places[vertex], (visit,))

    def _listen(self) -> None:
        last = len(self._visited_s) - 1
        for message in self.inbox:
            visit = parse_visit(message.payload)
            if visit is None or visit.reached > last or visit.intends > last:
                continue
            self._intentions[visit.robot_id] = visit.intends
            if visit.reached >= 0:
                self._visited_s[visit.reached] = self.time_s

    def _next_vertex(self, vertex: int) -> int:
        """Return the neighbour with the highest posterior; ties are broken at random."""
        edges = self._graph.edges[vertex]
        if not edges:
            return vertex
        intended = list(self._intentions.values())
        worth = [
            visit_probability(
                gain(self.time_s - self._visited_s[other], length_m, self._patrol),
                intended.count(other),
                self._team_size,
                self._patrol,
            )
            for other, length_m in edges
        ]
        best = [other for (other, _), value in zip(edges, worth, strict=True) if value == max(worth)]
        return best[int(self._rng.integers(len(best)))]

    def _go_to(self, vertex: int, position: Vector) -> None:
        self._goal = vertex
        distance_m = self.map.distance_m(self._graph.places[vertex], position)
        travel_s = self._patrol.timeout_factor * min(distance_m, LONGEST_TIMED_M) / self.speed_mps
        self._until_s = self.time_s + self._patrol.timeout_s + travel_s

"""SEBS: patrol of a graph by state exchange [portugal2013]."""

import math
from collections.abc import Sequence
from typing import Annotated

import msgspec

from robotteamsim.control.baselines.patrolling import PatrolController
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.interface.payload import Index, Update, update_reader
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.controllers.patrolling import SebsControl
from robotteamsim.setup import Setup


class Visit(Update, frozen=True, tag="sebs"):
    """The message of a robot to its team: the vertex that it has reached (-1: none yet) and the next one."""

    robot_id: Index
    reached: Annotated[int, msgspec.Meta(ge=-1, le=2**31 - 1)]
    intends: Index


parse_visit = update_reader(Visit, kept=8192)
"""Return the visit in a message; None if it is another message."""


def gain(idleness_s: float, length_m: float, keys: SebsControl) -> float:
    """Return the gain of visiting a vertex: its idleness over the length of the edge [s/m]."""
    return idleness_s / max(length_m, keys.edge_min_m)


def visit_probability(gain_s_per_m: float, num_intending: int, team_size: int, keys: SebsControl) -> float:
    """Return the posterior of visiting a vertex, up to a factor that is the same for all vertices.

    G1 exp(ln(1/G1) gain / G2), 1 where gain >= G2, times 2^(R - count) / (2^R - 1): it decreases with the number of
    teammates that intend to go there.

    Args: num_intending: count, the number of teammates that announced it.  team_size: R.
    """
    probability = 1.0
    if gain_s_per_m < keys.g2:
        probability = keys.g1 * math.exp(math.log(1.0 / keys.g1) * gain_s_per_m / keys.g2)
    # Simplified, because 2^R of a thousand robots exceeds the range of a float.
    return probability * 2.0**-num_intending / (1.0 - 2.0**-team_size)


class SebsController(PatrolController):
    """Goes from vertex to vertex, each time to the neighbour with the highest posterior, and announces each visit.

    It computes idleness and intentions from its own visits and those that it received. It ignores voices and areas, and
    finds victims only by passing them.
    """

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        self._keys = setup.scenario.control.as_kind(SebsControl)
        super().__init__(robot_id, setup, self._keys, arrival)
        self._team_size = setup.scenario.num_robots
        self._rng = robot_stream(setup.scenario, "sebs", robot_id, arrival)
        self._intentions: dict[int, int] = {}
        """The vertex that each teammate announced as its next one, by robot id."""

    def _announced(self, vertex: int) -> tuple[Message, ...]:
        return (Message(self.robot_id, EVERYBODY, Visit(self.robot_id, self._at, vertex).to_json()),)

    def _listen(self, inbox: Sequence[Message], time_s: float) -> None:
        last = len(self._visited_s) - 1
        for message in inbox:
            visit = parse_visit(message.payload)
            if visit is None or visit.reached > last or visit.intends > last:
                continue
            self._intentions[visit.robot_id] = visit.intends
            if visit.reached >= 0:
                self._visited_s[visit.reached] = time_s

    def _next_vertex(self, vertex: int, time_s: float) -> int:
        """Return the neighbour with the highest posterior; ties are broken at random."""
        edges = self._graph.edges[vertex]
        if not edges:
            return vertex
        intended = list(self._intentions.values())
        worth = [
            visit_probability(
                gain(time_s - self._visited_s[other], length_m, self._keys),
                intended.count(other),
                self._team_size,
                self._keys,
            )
            for other, length_m in edges
        ]
        best = [other for (other, _), value in zip(edges, worth, strict=True) if value == max(worth)]
        return best[int(self._rng.integers(len(best)))]

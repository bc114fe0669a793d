"""Conscientious Reactive: patrol of a graph without communication [machado2002]."""

from robotteamsim.control.baselines.patrolling import PatrolController
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.scenario.controllers.patrolling import ConscientiousReactiveControl
from robotteamsim.setup import Setup


class ConscientiousReactiveController(PatrolController):
    """Goes to the neighbour that it has itself not visited for the longest time; ties are broken at random.

    It neither sends nor reads messages, and knows only its own visits.
    """

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        control = setup.scenario.control.as_kind(ConscientiousReactiveControl)
        super().__init__(robot_id, setup, control, arrival)
        self._rng = robot_stream(setup.scenario, "conscientious_reactive", robot_id, arrival)

    def _next_vertex(self, vertex: int, time_s: float) -> int:
        neighbours = [other for other, _ in self._graph.edges[vertex]]
        if not neighbours:
            return vertex
        oldest_s = min(self._visited_s[other] for other in neighbours)
        best = [other for other in neighbours if self._visited_s[other] == oldest_s]
        return best[int(self._rng.integers(len(best)))]

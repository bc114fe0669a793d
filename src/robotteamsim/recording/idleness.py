"""The idleness of the vertices of a patrol: for how long none of the robots has visited them."""

from __future__ import annotations

import msgspec
import numpy as np

from robotteamsim.control.baselines.patrol_graph import Graph, patrol_graph
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result, StepRecord


class VertexIdleness(msgspec.Struct, frozen=True):
    """The idleness of one vertex in a trial.

    visits:  how often a robot came to it.
    mean_s:  mean over time [machado2002].     max_s: the greatest value.
    visit_s: mean idleness that visits ended, as patrolling_sim reports it [portugal2013]; None without a visit.
    """

    visits: int
    mean_s: float
    max_s: float
    visit_s: float | None


class Idleness(msgspec.Struct, frozen=True):
    """The idleness of a graph in a trial.

    mean_s:   mean over time and vertices [machado2002].     max_s: the greatest value of any vertex.
    vertices: of each vertex, by index.
    """

    mean_s: float
    max_s: float
    vertices: tuple[VertexIdleness, ...]


def patrols(scenario: Scenario) -> bool:
    """Whether the robots of a scenario patrol a graph."""
    return scenario.control.patrols or scenario.mission.patrol.graph is not None


class IdlenessLog(Observer):
    """An observer that measures the idleness of the vertices of `mission.patrol` from the robots' true positions.

    The idleness of a vertex is 0 while a robot is within `mission.patrol.arrived_m` of it and at the start of the
    mission; otherwise it is the mission's time since then. It grows until the end of the mission, which is no visit.
    """

    def __init__(self) -> None:
        self.idleness: Idleness | None = None
        """The result, once the mission has ended."""

    def begin(self, setup: Setup) -> None:
        """Discard an earlier trial. Raises: ScenarioError: the plan has no room for a graph."""
        self._graph: Graph = patrol_graph(setup)
        self._places_m = np.array(self._graph.places)
        self._reach_m = setup.scenario.mission.patrol.arrived_m
        count = len(self._graph.places)
        self._since_s = np.zeros(count)
        """When each vertex was last visited."""
        self._is_visited = np.zeros(count, dtype=bool)
        self._visits = np.zeros(count, dtype=int)
        self._ended_s, self._area_s2, self._max_s = np.zeros(count), np.zeros(count), np.zeros(count)
        self._now_s = 0.0
        self.idleness = None

    @property
    def idle_s(self) -> np.ndarray:
        """The idleness of each vertex after the last step [s]."""
        return np.asarray(self._now_s - self._since_s)

    def step(self, record: StepRecord) -> None:
        """Process one step; time does not pass while the mission waits or is paused."""
        time_s, positions_m = record.mission.time_s, record.state.positions_m
        positions_m = positions_m[record.present]
        away_m = self._places_m[:, None, :] - positions_m[None, :, :]
        near = (np.hypot(away_m[..., 0], away_m[..., 1]) < self._reach_m).any(axis=1)
        idle_s = time_s - self._since_s
        come = near & ~self._is_visited & (idle_s > 0.0)  # A robot that starts at a vertex has not come to it.
        self._visits[come] += 1
        self._ended_s[come] += idle_s[come]
        self._area_s2[come] += 0.5 * idle_s[come] ** 2
        self._max_s[come] = np.maximum(self._max_s[come], idle_s[come])
        self._since_s[near] = time_s
        self._is_visited, self._now_s = near, time_s

    def end(self, result: Result) -> None:
        """Compute the result."""
        duration_s = max(result.time_s, 1e-9)
        last_s = result.time_s - self._since_s
        mean_s = (self._area_s2 + 0.5 * last_s**2) / duration_s
        max_s = np.maximum(self._max_s, last_s)
        self.idleness = Idleness(
            mean_s=float(mean_s.mean()),
            max_s=float(max_s.max()),
            vertices=tuple(
                VertexIdleness(visits, mean, most, ended / visits if visits else None)
                for visits, mean, most, ended in zip(
                    self._visits.tolist(), mean_s.tolist(), max_s.tolist(), self._ended_s.tolist(), strict=True
                )
            ),
        )

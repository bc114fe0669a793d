"""What agents remember of a mission: the floor that they know to be covered, heat, the idleness of vertices."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.control.baselines.patrol_graph import Graph, patrol_graph
from robotteamsim.control.cover.floor_cover import FloorCover
from robotteamsim.learning.observe import Memory, Percepts, seen_from
from robotteamsim.scenario.controllers.cover import FloorSearchTuning
from robotteamsim.scenario.sections import Coverage
from robotteamsim.scenario.sensors.heat import HeatReading
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.setup import Setup

IDLE_S = 300.0
"""Idleness becomes 0 to 1 up to this [s]."""

HOTTEST_C = 300.0
"""Temperatures become 0 to 1 up to this [degC]."""

HEAT_M = 10.0
"""Distances of hot places are divided by this [m]."""


class FloorMemory(Memory):
    """The floor that each agent knows to be covered: by itself, and from the places that teammates have sent.

    The place to cover next is the one that covers the most new floor for its distance, as for the controller `cover`.
    """

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """See `Memory`."""
        super().__init__(setup, robot_ids)
        radius_m = (setup.scenario.mission.coverage or Coverage()).radius_m
        reach_m, bounds = setup.smallest_reach_m, setup.plan.bounds
        self._covers = [FloorCover(setup.building, reach_m, setup.start_m(i), radius_m) for i in robot_ids]
        self._seen: list[set[tuple[float, float]]] = [set() for _ in robot_ids]
        """Per agent: the places that teammates have sent last."""
        self._nearness_m = FloorSearchTuning().nearness_m
        self._diagonal_m = math.dist(bounds.min, bounds.max)

    @classmethod
    def parts_of(cls, setup: Setup) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part of the numbers."""
        place = "there is a place to cover, its x and y from the robot / diagonal"
        return [("floor", 4, f"share known to be covered; {place}")]

    def after(self, percepts: Percepts, time_s: float) -> np.ndarray:
        """See `Memory`."""
        places_m, known = percepts.poses[:, None, :2].copy(), np.zeros((len(self._covers), 2))
        for i, (cover, heard) in enumerate(zip(self._covers, percepts.heard, strict=True)):
            own_m, *sent_m = map(tuple, [percepts.poses[i, :2].tolist(), *heard[heard[:, 0] > 0.0, 1:3].tolist()])
            for place_m in (own_m, *(place_m for place_m in sent_m if place_m not in self._seen[i])):
                cover.look(place_m)
            self._seen[i] = set(sent_m)
            goal_m = cover.best_place(own_m, (), self._nearness_m)
            known[i] = cover.share, goal_m is not None
            if goal_m is not None:
                places_m[i, 0] = goal_m
        return np.concatenate((known, seen_from(percepts.poses, places_m)[:, 0] / self._diagonal_m), -1)


class RescueMemory(FloorMemory):
    """Also the last image of each agent's thermal camera; 0 without one."""

    looks = True

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """See `Memory`."""
        super().__init__(setup, robot_ids)
        self._heat = [HeatReading(0.0)] * len(robot_ids)

    @classmethod
    def parts_of(cls, setup: Setup) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part of the numbers."""
        hottest = "a hot place is in sight; x and y of the hottest from the robot / 10 m, its temperature / 300 degC"
        return [*super().parts_of(setup), ("heat", 5, f"temperature of the air / 300 degC; {hottest}")]

    def look(self, readings: Sequence[RobotReading]) -> None:
        """See `Memory`."""
        for i, robot in enumerate(readings):
            for reading in robot.sensors.values():
                if isinstance(reading, HeatReading):
                    self._heat[i] = reading

    def after(self, percepts: Percepts, time_s: float) -> np.ndarray:
        """See `Memory`."""
        hottest = [max(zip(heat.hot_c, heat.hot_m, strict=True), default=(0.0, None)) for heat in self._heat]
        own_m = percepts.poses[:, :2].tolist()
        places_m = [place_m or here_m for (_, place_m), here_m in zip(hottest, own_m, strict=True)]
        numbers = (
            np.array([[heat.temperature_c / HOTTEST_C, bool(heat.hot_c)] for heat in self._heat]),
            seen_from(percepts.poses, np.array(places_m)[:, None])[:, 0] / HEAT_M,
            np.array([[temperature_c / HOTTEST_C] for temperature_c, _ in hottest]),
        )
        return np.concatenate((super().after(percepts, time_s), *numbers), -1)


class PatrolMemory(Memory):
    """When each agent knows each vertex of `mission.patrol` to have been visited: by itself, or by teammates.

    Of the vertex that it visited last (at first the nearest one) and of its neighbours, it knows place and idleness.
    """

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """See `Memory`."""
        super().__init__(setup, robot_ids)
        graph, bounds = patrol_graph(setup), setup.plan.bounds
        self._places_m = np.array(graph.places)
        self._arrived_m = setup.scenario.mission.patrol.arrived_m
        self._diagonal_m = math.dist(bounds.min, bounds.max)
        self._near = np.full((len(graph.places), most_vertices(graph)), -1)
        """By vertex: the vertex and its neighbours, -1 for none."""
        for vertex, edges in enumerate(graph.edges):
            self._near[vertex, : len(edges) + 1] = vertex, *(other for other, _ in edges)
        self._visited_s = np.zeros((0, 0))
        self._at = np.zeros(len(robot_ids), int)

    @classmethod
    def parts_of(cls, setup: Setup) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part of the numbers."""
        each = "there is one, x and y from the robot / diagonal, idleness / 300 s"
        size = 4 * most_vertices(patrol_graph(setup))
        return [("vertices", size, f"the vertex visited last, then its neighbours: {each}")]

    def after(self, percepts: Percepts, time_s: float) -> np.ndarray:
        """See `Memory`."""
        away_m = np.linalg.norm(percepts.poses[:, None, :2] - self._places_m, axis=-1)
        if not self._visited_s.size:
            self._visited_s = np.full(away_m.shape, time_s)
            self._at = away_m.argmin(-1)
        is_at = away_m < self._arrived_m
        self._visited_s[is_at] = time_s
        self._at = np.where(is_at.any(-1), away_m.argmin(-1), self._at)
        sent_m = np.linalg.norm(percepts.heard[:, :, None, 1:3] - self._places_m, axis=-1)
        were_at = (sent_m < self._arrived_m) & (percepts.heard[..., :1] > 0.0)
        sent_s = time_s - percepts.heard[..., 3:4]
        self._visited_s = np.maximum(self._visited_s, np.where(were_at, sent_s, -np.inf).max(1, initial=-np.inf))
        near = self._near[self._at]
        idle = (time_s - np.take_along_axis(self._visited_s, near, -1)) / IDLE_S
        seen_m = seen_from(percepts.poses, self._places_m[near]) / self._diagonal_m
        numbers = np.concatenate((np.ones((*near.shape, 1)), seen_m, idle[..., None]), -1) * (near >= 0)[..., None]
        return numbers.reshape(len(near), -1)


def most_vertices(graph: Graph) -> int:
    """Return how many vertices an agent knows at once: one, and its neighbours."""
    return 1 + max(map(len, graph.edges))

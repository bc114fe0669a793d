"""Idleness: of robots that move by hand, of a patrol against a second method, and where it is reported."""

from __future__ import annotations

import json
import math

import networkx as nx
import numpy as np
import pytest

from robotteamsim.recording.idleness import IdlenessLog, patrols
from robotteamsim.recording.results import ResultWriter
from robotteamsim.scenario.patrol import Patrol, PatrolGraph, PatrolVertex
from robotteamsim.scenario.sections import Mission, PlacedRobot
from robotteamsim.simulation import Observer, Simulation

PLACES = ((3.0, 5.0), (9.0, 5.0), (15.0, 5.0))
LINE = Patrol(
    graph=PatrolGraph(
        vertices=(
            PatrolVertex(position=PLACES[0], neighbours=(1,), lengths_m=(6.0,)),
            PatrolVertex(position=PLACES[1], neighbours=(0, 2), lengths_m=(6.0, 6.0)),
            PatrolVertex(position=PLACES[2], neighbours=(1,), lengths_m=(6.0,)),
        )
    )
)


def scenario_of(hall_scenario, algorithm: str = "sebs", duration_s: float = 120.0, robots: int = 1):
    return hall_scenario(
        robots=tuple(PlacedRobot(start_pose=(3.0 + i, 5.0, 0.0)) for i in range(robots)),
        control={"algorithm": algorithm},
        mission=Mission(time_limit_s=duration_s, patrol=LINE),
    )


class Places(Observer):
    """An observer that keeps the time and the true positions of every step."""

    def begin(self, scenario):
        self.steps = []

    def step(self, record):
        self.steps.append((record.mission.time_s, [(r.ground_truth.x_m, r.ground_truth.y_m) for r in record.readings]))


def driven(scenario):
    log, seen = IdlenessLog(), Places()
    Simulation(scenario).run([log, seen])
    return log.idleness, seen.steps


def test_vertex_that_is_never_visited_is_idle_for_the_whole_mission(hall_scenario):
    idleness, _ = driven(scenario_of(hall_scenario, duration_s=5.0))
    # In 5 s the robot gets at most 3.5 m from vertex 0, where it starts.
    never = idleness.vertices[2]
    assert (never.visits, never.visit_s) == (0, None)
    assert never.max_s == pytest.approx(5.0)
    assert never.mean_s == pytest.approx(2.5)
    assert idleness.max_s == pytest.approx(5.0)


def test_idleness_is_the_time_since_a_robot_was_there(hall_scenario):
    idleness, steps = driven(scenario_of(hall_scenario, robots=2))
    times_s = np.array([time_s for time_s, _ in steps])
    for vertex, place in zip(idleness.vertices, PLACES, strict=True):
        near = np.array([any(math.dist(at, place) < LINE.arrived_m for at in robots) for _, robots in steps])
        # Sampled in every step, instead of added up at every visit.
        since_s = np.maximum.accumulate(np.where(near, times_s, 0.0))
        idle_s = times_s - since_s
        assert vertex.mean_s == pytest.approx(float(idle_s.mean()), abs=0.15)
        # The visit ends the idleness one step after the last sample.
        assert vertex.max_s == pytest.approx(float(idle_s.max()), abs=0.11)
        starts = near[1:] & ~near[:-1] & (times_s[1:] > 0.0)
        assert vertex.visits == int(starts.sum())
    assert idleness.mean_s == pytest.approx(np.mean([vertex.mean_s for vertex in idleness.vertices]))


@pytest.mark.slow
def test_idleness_on_a_line_is_at_least_that_of_its_shortest_closed_walk(hall_scenario):
    idleness, _ = driven(scenario_of(hall_scenario, duration_s=400.0))
    graph = nx.Graph()
    for index, vertex in enumerate(LINE.graph.vertices):
        graph.add_weighted_edges_from((index, i, m) for i, m in zip(vertex.neighbours, vertex.lengths_m, strict=True))
    # One robot must drive each edge of a tree twice between two visits of an end.
    walk_m = 2.0 * nx.minimum_spanning_tree(graph).size(weight="weight")
    fastest_s = (walk_m - 4.0 * LINE.arrived_m) / 0.7
    ends = (idleness.vertices[0], idleness.vertices[2])
    assert all(vertex.max_s >= fastest_s for vertex in ends)
    assert idleness.vertices[1].mean_s < min(vertex.mean_s for vertex in ends)


def test_patrol_writes_its_idleness_into_mission_json(hall_scenario, tmp_path):
    scenario = scenario_of(hall_scenario, "conscientious_reactive", duration_s=20.0)
    log = IdlenessLog()
    Simulation(scenario).run([log, ResultWriter(tmp_path)])
    document = json.loads((tmp_path / "mission.json").read_text())
    assert document["idleness"]["mean_s"] == log.idleness.mean_s
    assert len(document["idleness"]["vertices"]) == 3


def test_other_controllers_report_no_idleness(hall_scenario, tmp_path):
    scenario = hall_scenario(mission=Mission(time_limit_s=1.0))
    assert not patrols(scenario)
    Simulation(scenario).run([ResultWriter(tmp_path)])
    assert "idleness" not in json.loads((tmp_path / "mission.json").read_text())

"""Patrol graphs: files of patrolling_sim, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import load
from robotteamsim.scenario.patrol import PatrolGraph, read_patrol_graph
from robotteamsim.scenario.problems import checked

THREE = Path(__file__).parents[2] / "data" / "patrol" / "three.graph"


def read(text: str, folder: Path) -> PatrolGraph:
    path = folder / "x.graph"
    path.write_text(text)
    return PatrolGraph.model_validate(read_patrol_graph(path, path.name))


def test_pixels_become_metres_in_the_map_frame():
    graph = PatrolGraph.model_validate(read_patrol_graph(THREE, THREE.name))
    assert [vertex.position for vertex in graph.vertices] == [(1.0, 3.0), (4.0, 3.0), (4.0, 5.0)]
    assert [vertex.neighbours for vertex in graph.vertices] == [(1,), (0, 2), (1,)]
    assert [vertex.lengths_m for vertex in graph.vertices] == [(3.0,), (3.0, 2.0), (2.0,)]


def test_scenario_names_the_file_and_holds_the_graph():
    scenario = load("garage_sar", [f"mission.patrol.graph={THREE}", "control.algorithm=sebs"])
    assert len(scenario.mission.patrol.graph.vertices) == 3


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("3\n200", "x\n200", "x.graph:1: 'x' is not a whole number; expected the number of vertices"),
        ("3\n200", "0\n200", "x.graph:1: 0 vertices; expected 1 to 10000"),
        ("0.05", "nan", "x.graph:4: 'nan' is not a number; expected the resolution [m]"),
        ("0.05", "0", "x.graph:4: resolution 0 is not above 0"),
        ("E\n60", "E\nfar", "x.graph:14: 'far' is not a number; expected the cost of an edge of vertex 0 [px]"),
        ("\n2\n100\n60", "\n7\n100\n60", "x.graph:27: vertex 7; expected 2: ids count from 0"),
        ("S\n40\n", "S\n", "x.graph:32: the file ends here; expected the cost of an edge of vertex 2 [px]"),
        ("S\n40\n", "S\n40\n9\n", "x.graph:34: '9' follows the last vertex; expected the end of the file"),
    ],
)
def test_error_in_a_graph_file_names_its_line(old, new, line, tmp_path):
    text = THREE.read_text()
    assert text.count(old) >= 1
    with pytest.raises(ScenarioError) as raised:
        read(text.replace(old, new, 1), tmp_path)
    assert str(raised.value) == line


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("1\nE", "5\nE", "12: 5 is not another vertex; expected 0 to 2"),
        ("1\nE", "0\nE", "12: 0 is not another vertex; expected 0 to 2"),
        ("E\n60", "E\n0", "14: an edge of 0 m; expected a cost above 0"),
        ("E\n60", "E\n1e-323", "14: an edge of 0 m; expected a cost above 0"),
        ("1\n1\nE\n60\n", "0\n", "11: degree 0; a robot could never leave vertex 0"),
        ("1\n1\nE\n60\n", "-1\n", "11: degree -1; a robot could never leave vertex 0"),
    ],
)
def test_graph_that_cannot_be_patrolled_is_rejected_with_file_and_line(old, new, line, tmp_path):
    path = tmp_path / "x.graph"
    path.write_text(THREE.read_text().replace(old, new, 1))
    with pytest.raises(ScenarioError) as raised:
        load("garage_sar", [f"mission.patrol.graph={path}"])
    assert str(raised.value) == f"{path}:{line}"


@pytest.mark.parametrize(
    ("vertices", "line"),
    [
        ([([5], [1.0])], "neighbours.0: 5 is not another vertex; expected 0 to 1"),
        ([([1], [0.0])], "lengths_m.0: 0 is not above 0"),
        ([([], [])], "neighbours: a robot could never leave a vertex without neighbours"),
    ],
)
def test_graph_in_a_scenario_that_cannot_be_patrolled_is_rejected(vertices, line):
    edges = [*vertices, ([0], [1.0])]
    given = [{"position": [i, 0.0], "neighbours": to, "lengths_m": m} for i, (to, m) in enumerate(edges)]
    with pytest.raises(ScenarioError) as raised:
        checked(PatrolGraph, {"vertices": given}, ScenarioError)
    assert str(raised.value) == f"vertices.0.{line}"

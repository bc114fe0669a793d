"""Patrols: the gain and posterior of SEBS by hand, the graph, and robots that patrol with and without messages."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from robotteamsim.control import make_controller
from robotteamsim.control.baselines.patrol_graph import patrol_graph
from robotteamsim.control.baselines.sebs import Visit, gain, parse_visit, visit_probability
from robotteamsim.errors import ScenarioError
from robotteamsim.network.messages import Message
from robotteamsim.scenario.controllers.patrolling import SebsControl
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.patrol import Patrol, PatrolGraph, PatrolVertex
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot
from robotteamsim.setup import resolve

KEYS = SebsControl(algorithm="sebs")
SEBS, REACTIVE = {"algorithm": "sebs"}, {"algorithm": "conscientious_reactive"}
CORNERS = ((4.0, 3.0), (8.0, 3.0), (8.0, 7.0), (4.0, 7.0))


def square(**keys: object) -> Patrol:
    """A square of 4 m with one diagonal, 0-2."""
    return patrol_of(((1, 3, 2), (0, 2), (1, 3, 0), (0, 2)), **keys)


def patrol_of(neighbours: tuple[tuple[int, ...], ...], **keys: object) -> Patrol:
    vertices = tuple(
        PatrolVertex(position=place, neighbours=others, lengths_m=tuple(math.dist(place, CORNERS[i]) for i in others))
        for place, others in zip(CORNERS, neighbours, strict=True)
    )
    return Patrol(graph=PatrolGraph(vertices=vertices), **keys)


def mission_of(patrol: Patrol) -> Mission:
    return Mission(areas=(Area(name="east", center=(16.0, 5.0)),), patrol=patrol)


def test_gain_is_idleness_over_length_and_short_edges_count_as_the_shortest():
    assert gain(60.0, 4.0, KEYS) == 15.0
    assert gain(60.0, 0.2, KEYS) == 60.0


def test_posterior_of_gains_equals_the_hand_calculation():
    # 0.1 exp(ln(10) 50 / 100) = sqrt(0.1); a team of two: 2^2 / (2^2 - 1).
    assert visit_probability(50.0, 0, 2, KEYS) == pytest.approx(math.sqrt(0.1) * 4.0 / 3.0)
    assert visit_probability(0.0, 0, 2, KEYS) == pytest.approx(0.1 * 4.0 / 3.0)
    assert visit_probability(100.0, 1, 2, KEYS) == pytest.approx(2.0 / 3.0)
    assert visit_probability(1e9, 2, 2, KEYS) == pytest.approx(1.0 / 3.0)


def test_posterior_is_finite_for_any_team():
    assert visit_probability(200.0, 0, 3000, KEYS) == 1.0
    assert visit_probability(200.0, 3000, 3000, KEYS) == 0.0


def test_visit_survives_the_network_and_nonsense_does_not():
    assert parse_visit(Visit(2, -1, 7).to_json()) == Visit(2, -1, 7)
    assert all(parse_visit(text) is None for text in ("", "[]", "{}", '{"sebs": [1, 2]}', '{"sebs": "abc"}', "3"))


def test_lone_robot_visits_every_vertex_repeatedly_and_reports_each(team, hall_scenario):
    robots = (PlacedRobot(start_pose=(5.0, 3.0, 0.0)),)
    hall = team(hall_scenario(robots=robots, control=SEBS, mission=mission_of(square())))
    told = [parse_visit(m.payload) for _ in range(1500) for decision in hall.step() for m in decision.outbox]
    assert told[0] == Visit(0, -1, 0)
    reached = [visit.reached for visit in told[1:]]
    assert {reached.count(vertex) for vertex in range(4)} > {0} or min(map(reached.count, range(4))) >= 3
    neighbours = [vertex.neighbours for vertex in square().graph.vertices]
    assert all(after in neighbours[before] for before, after in pairwise(reached))
    assert [visit.intends for visit in told[:-1]] == reached


def test_vertex_that_a_teammate_goes_to_is_left_to_it(team, hall_scenario):
    # From corner 1, the corners 0 and 2 are equally far and idle.
    for other, chosen in ((0, 2), (2, 0)):
        robots = (PlacedRobot(start_pose=(8.0, 3.0, 0.0)),)
        hall = team(hall_scenario(robots=robots, control=SEBS, mission=mission_of(square())))
        told = [parse_visit(hall.step()[0].outbox[0].payload)]
        hall.hear_messages = [Message(1, -1, Visit(1, -1, other).to_json()), Message(1, -1, "hello")]
        told += [parse_visit(hall.step()[0].outbox[0].payload)]
        assert told == [Visit(0, -1, 1), Visit(0, 1, chosen)]


def test_robot_that_cannot_come_to_its_vertex_chooses_another(team, hall_scenario):
    robots = (PlacedRobot(start_pose=(5.0, 3.0, 0.0)),)
    patrol = square()
    in_the_wall = patrol.graph.vertices[0].model_copy(update={"position": (4.0, 0.0)})
    graph = patrol.graph.model_copy(update={"vertices": (in_the_wall, *patrol.graph.vertices[1:])})
    mission = mission_of(Patrol(graph=graph, arrived_m=0.1))
    hall = team(hall_scenario(robots=robots, control=SEBS, mission=mission))
    told = [parse_visit(m.payload) for _ in range(1200) for decision in hall.step() for m in decision.outbox]
    assert 0 in {visit.intends for visit in told}
    assert {visit.reached for visit in told} - {-1} == {1, 2, 3}


def test_graph_of_a_plan_covers_it_with_linked_places(hall_scenario):
    graph = patrol_graph(resolve(hall_scenario(mission=Mission(patrol=Patrol(spacing_m=4.0)))), 0.2)
    # 20 x 10 m by 4 m: five columns, two rows; 5 + 2 * 4 edges, each from both ends.
    assert len(graph.places) == 10
    assert sum(map(len, graph.edges)) == 2 * 13
    assert all(length_m == pytest.approx(4.0, abs=0.2) for edges in graph.edges for _, length_m in edges)
    assert all((i, length_m) in graph.edges[j] for i, edges in enumerate(graph.edges) for j, length_m in edges)


def test_no_edge_of_a_plan_leads_through_a_wall(hall_scenario):
    hall = hall_scenario().plan
    wall = Wall(name="middle", start=(10.0, 0.2), end=(10.0, 6.0))
    scenario = hall_scenario(plan=hall.model_copy(update={"walls": (*hall.walls, wall)}))
    graph = patrol_graph(resolve(scenario), 0.2)
    crossing = [
        (graph.places[i], graph.places[j])
        for i, edges in enumerate(graph.edges)
        for j, _ in edges
        if graph.places[i][0] < 10.0 < graph.places[j][0]
    ]
    assert crossing
    assert all(start[1] > 6.0 or end[1] > 6.0 for start, end in crossing)


def test_graph_of_a_plan_has_only_places_that_robots_can_reach(hall_scenario):
    hall = hall_scenario().plan
    wall = Wall(name="middle", start=(8.0, 0.0), end=(8.0, 10.0))
    scenario = hall_scenario(plan=hall.model_copy(update={"walls": (*hall.walls, wall)}))
    # The robots start in the smaller part.
    assert max(x for x, _ in patrol_graph(resolve(scenario), 0.2).places) < 8.0


def test_plan_without_room_for_two_places_is_rejected(hall_scenario):
    closet = FloorPlan(name="closet", bounds=Bounds(max=(2.0, 2.0)))
    robots = (PlacedRobot(start_pose=(1.0, 1.0, 0.0)),)
    scenario = hall_scenario(plan=closet, robots=robots, mission=Mission(), control=SEBS)
    with pytest.raises(ScenarioError, match=r"^mission.patrol.spacing_m: 6 m leaves no two places of the plan"):
        make_controller(0, resolve(scenario))


RING = patrol_of(((1, 3), (2, 0), (3, 1), (0, 2)))


def test_reactive_robot_drives_around_a_ring_in_one_direction_and_sends_nothing(team, hall_scenario):
    hall = team(
        hall_scenario(
            robots=(PlacedRobot(start_pose=(4.5, 3.0, 0.0)),),
            control=REACTIVE,
            mission=mission_of(RING),
        )
    )
    goals: list[tuple[float, float]] = []
    for _ in range(900):
        (decision,) = hall.step()
        assert decision.outbox == ()
        if not goals or decision.goal_m != goals[-1]:
            goals.append(decision.goal_m)
    corners = [CORNERS.index(goal) for goal in goals]
    assert len(corners) >= 8
    # Of the two neighbours, the one that it did not come from has always been unvisited for longer.
    turns = {(after - before) % 4 for before, after in pairwise(corners)}
    assert len(turns) == 1
    assert turns <= {1, 3}


def test_messages_of_teammates_have_no_influence_on_a_reactive_robot(team, hall_scenario):
    goals = []
    for messages in ([], [Message(1, -1, Visit(1, 1, 3).to_json())]):
        hall = team(
            hall_scenario(
                robots=(PlacedRobot(start_pose=(4.0, 3.0, 0.0)),),
                control=REACTIVE,
                mission=mission_of(RING),
            )
        )
        hall.hear_messages = messages
        goals.append([hall.step()[0].goal_m for _ in range(300)])
    assert goals[0] == goals[1]

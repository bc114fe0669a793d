"""Conscientious Reactive: the choice by hand, and a patrol without messages."""

from __future__ import annotations

from itertools import pairwise

from robotteamsim.control.baselines.sebs import Visit
from robotteamsim.network.messages import Message
from robotteamsim.scenario.patrol import Patrol, PatrolGraph, PatrolVertex
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot

CORNERS = ((4.0, 3.0), (8.0, 3.0), (8.0, 7.0), (4.0, 7.0))
RING = Patrol(
    graph=PatrolGraph(
        vertices=tuple(
            PatrolVertex(position=place, neighbours=((i + 1) % 4, (i - 1) % 4), lengths_m=(4.0, 4.0))
            for i, place in enumerate(CORNERS)
        )
    )
)
AREA = Area(name="east", center=(16.0, 5.0))
SECTIONS = {"control": {"algorithm": "conscientious_reactive"}, "mission": Mission(areas=(AREA,), patrol=RING)}


def test_lone_robot_drives_around_a_ring_in_one_direction_and_sends_nothing(team, hall_scenario):
    hall = team(hall_scenario(robots=(PlacedRobot(start_pose=(4.5, 3.0, 0.0)),), **SECTIONS))
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


def test_messages_of_teammates_have_no_influence(team, hall_scenario):
    goals = []
    for messages in ([], [Message(1, -1, Visit(1, 1, 3).to_json())]):
        hall = team(hall_scenario(robots=(PlacedRobot(start_pose=(4.0, 3.0, 0.0)),), **SECTIONS))
        hall.hear_messages = messages
        goals.append([hall.step()[0].goal_m for _ in range(300)])
    assert goals[0] == goals[1]

"""Tables 4 and 5 [dissertation] come out of the network of a running simulation."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pytest

from robotteamsim.control import Guard
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.network import EVERYBODY, Message
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Mission, Network, PlacedRobot
from robotteamsim.simulation import Simulation

PLACES_M = [(100, 100), (150, 160), (150, 255), (270, 60), (180, 90), (350, 100), (400, 275), (400, 180)]
"""In the open a link reaches 102 m (-94 dBm)."""

TABLE_4 = """
0 1 0 0 1 0 0 0
1 0 1 0 1 0 0 0
0 1 0 0 0 0 0 0
0 0 0 0 1 1 0 0
1 1 0 1 0 0 0 0
0 0 0 1 0 0 0 1
0 0 0 0 0 0 0 1
0 0 0 0 0 1 1 0
"""
TABLE_5 = """
0 1 2 2 1 3 5 4
1 0 1 2 1 3 5 4
2 1 0 3 2 4 6 5
2 2 3 0 1 1 3 2
1 1 2 1 0 2 4 3
3 3 4 1 2 0 2 1
5 5 6 3 4 2 0 1
4 4 5 2 3 1 1 0
"""


class Talker:
    """Stands still and, as robot 0, says one thing to everybody in its first step."""

    def __init__(self, robot_id: int) -> None:
        self._outbox = (Message(0, EVERYBODY, "hello"),) if robot_id == 0 else ()

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        outbox, self._outbox = self._outbox, ()
        return Decision(outbox=outbox)


def _matrix(table: str) -> np.ndarray:
    return np.array([row.split() for row in table.strip().splitlines()], dtype=int)


def _simulation(**keys) -> Simulation:
    scenario = Scenario(
        name="fig_11",
        plan=FloorPlan(name="field", bounds=Bounds(max=(450.0, 350.0))),
        robots=tuple(PlacedRobot(start_pose=(float(x), float(y), 0.0)) for x, y in PLACES_M),
        network=Network(**keys),
        mission=Mission(time_limit_s=60.0),
    )
    simulation = Simulation(scenario)
    simulation.controllers.guards = [Guard(robot_id, 8, partial(Talker, robot_id)) for robot_id in range(8)]
    return simulation


@pytest.mark.slow
def test_tables_4_and_5_come_out_of_the_running_network_of_8_placed_robots():
    simulation = _simulation()
    for _ in range(3):
        network = simulation.step().network
        assert np.array_equal(network.adjacency, _matrix(TABLE_4))
        assert np.array_equal(network.hop_count, _matrix(TABLE_5))


@pytest.mark.slow
def test_a_broadcast_reaches_the_8_robots_after_the_hops_of_table_5():
    simulation = _simulation(hop_delay_s=0.1)
    heard = {}
    for _ in range(10):
        record = simulation.step()
        heard.update({i: record.step_index - 1 for i, inbox in enumerate(record.inboxes) if inbox})
    assert [heard.get(i, 0) for i in range(8)] == _matrix(TABLE_5)[0].tolist()

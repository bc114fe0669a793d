"""The stepped simulation of a node, with a node that is not one of ROS."""

from __future__ import annotations

import threading
from contextlib import contextmanager
from types import SimpleNamespace

import numpy as np
import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.nodes import settings as settings_module
from robotteamsim.nodes.settings import Settings
from robotteamsim.nodes.simulation import SteppedSimulation
from robotteamsim.scenario import Scenario, load
from robotteamsim.simulation import Simulation


class Node:
    """Has no parameters, keeps services, and publishes to nobody."""

    last_words = ""

    def __init__(self, **parameters):
        self.parameters, self.services, self.has_ended = parameters, {}, threading.Event()

    def parameter(self, name, default):
        return self.parameters.get(name.removeprefix("~"), default)

    setting = parameter

    def setting_name(self, key):
        return key

    def change_setting(self, key, value):
        pass

    def output(self, *_, **__):
        return SimpleNamespace(wanted=False, publish=lambda _: None)

    def listen(self, *_, **__):
        pass

    def offer(self, name, _, serve):
        self.services[name] = serve

    def on_shutdown(self, close):
        pass

    def topics(self):
        return []

    def wait_for_subscribers(self, *_):
        pass

    def is_running(self):
        return not self.has_ended.is_set()


@contextmanager
def stepped(scenario: Scenario, **settings):
    """Serve a paused simulation without controllers in a thread; yields it, and its node."""
    node = Node(paused=True, speed=0.0)
    simulation = SteppedSimulation(node, Settings(scenario, controllers="none", **settings))
    server = threading.Thread(target=simulation.serve)
    server.start()
    try:
        yield simulation, node
    finally:
        node.has_ended.set()
        simulation.gate.close()
        server.join(60.0)
        assert not server.is_alive()


def test_robots_of_another_seed_start_where_they_do_without_ros():
    scenario = load("garage_sar", ["robots.formation=random", "run.seed=1"])
    with stepped(scenario) as (simulation, node):
        assert node.services["~reset_seed"](SimpleNamespace(seed=2))["success"]
        with simulation.between_steps() as now:
            begin_m = now.world.positions_m()
    expected = Simulation(load("garage_sar", ["robots.formation=random", "run.seed=2"]))
    np.testing.assert_array_equal(begin_m, expected.world.positions_m())


def test_seed_without_room_is_refused_and_the_last_one_stays(monkeypatch):
    def full(scenario):
        raise PlacementError(f"no room with seed {scenario.run.seed}")

    with stepped(load("garage_sar", ["run.seed=1"])) as (simulation, node):
        with monkeypatch.context() as patch:
            patch.setattr(settings_module, "resolve", full)
            answer = node.services["~reset_seed"](SimpleNamespace(seed=2))
        assert answer == {"success": False, "message": "no room with seed 2"}
        assert node.services["~reset"](None)["success"]
        with simulation.between_steps() as now:
            assert now.scenario.run.seed == 1


@pytest.mark.slow
def test_robots_here_feel_fire_though_others_are_elsewhere():
    scenario = load("garage_fire", ["control.algorithm=random_walk"])
    sensed = dict.fromkeys(range(scenario.num_robots), 0)
    with stepped(scenario, elsewhere=(1,)) as (simulation, _):
        for _ in range(30):
            simulation.make_steps(1)
            with simulation.between_steps():
                for robot_id in sensed:
                    sensed[robot_id] += "heat" in simulation._last.readings[robot_id].sensors
    assert sensed[0] > 0


def test_refusal_of_a_service_is_one_printable_line():
    with stepped(load("garage_sar")) as (_, node):
        answer = node.services["~set_door"](SimpleNamespace(name="a\nb\x1b[31m\x7f\u202e", closed=True))
    line = r"unknown door 'a\nb\x1b[31m\x7f\u202e'; known: plant_door, stair_door"
    assert answer == {"success": False, "message": line}

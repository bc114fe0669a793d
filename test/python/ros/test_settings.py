from __future__ import annotations

import re
from typing import Any

import pytest
import rospy

from robotteamsim.errors import RobotTeamSimError, ScenarioError
from robotteamsim.nodes.node import ParameterError
from robotteamsim.nodes.settings import read_seed, read_settings
from robotteamsim.ros.node import parameter
from robotteamsim.ros.ros1 import Ros1Node

NODE = Ros1Node()
TF = "control.localisation=tf"
ALONE = {"robots": 1, "controllers": "false", "mission": False, "prefix": False}
"""Names without a prefix, in a world that runs alone."""


@pytest.fixture
def parameters(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The parameter server."""
    values: dict[str, Any] = {"/robotteamsim/scenario": "garage_sar"}
    monkeypatch.setattr(rospy, "get_param", values.get)
    monkeypatch.setattr(rospy, "resolve_name", lambda name: name.replace("~", "/node/"))
    monkeypatch.setattr(Ros1Node, "wait_for_shutdown", staticmethod(lambda _: True))
    return values


@pytest.mark.parametrize(("value", "default", "expected"), [(2, 1.0, 2.0), (2.5, 1.0, 2.5), (7, "", "7"), (3, 0, 3)])
def test_parameter_takes_the_type_of_its_default(parameters, value, default, expected):
    parameters["~p"] = value
    assert parameter("~p", default) == expected
    assert type(parameter("~p", default)) is type(default)


@pytest.mark.parametrize(
    ("value", "default", "expected"),
    [
        ("fast", 1.0, "a number"),
        (1.5, 1, "a whole number"),
        (1, True, "true or false"),
        ("true", False, "true or false"),
        ([1], "x", "text"),
    ],
)
def test_parameter_of_another_type_is_rejected_by_its_full_name(parameters, value, default, expected):
    parameters["~p"] = value
    with pytest.raises(ParameterError, match=rf"^/node/p: {re.escape(repr(value))}; expected {expected}$"):
        parameter("~p", default)


def test_settings_follow_the_parameters(parameters):
    parameters |= {
        "/robotteamsim/set": " run.seed=7  voice.noise_db=20 ",
        "/robotteamsim/robots": 5,
        "/robotteamsim/lockstep": True,
        "/robotteamsim/teleop": 1,
    }
    read = read_settings(NODE)
    assert (read.scenario.run.seed, read.scenario.voice.noise_db) == (7, 20.0)
    assert (read.num_robots, read.lockstep, read.step_ns) == (5, True, 100_000_000)
    assert [read.is_driven_by_hand(robot_id) for robot_id in range(5)] == [False, True, False, False, False]


def test_names_without_a_prefix_are_for_a_single_robot_of_the_world_alone(parameters):
    parameters |= {f"/robotteamsim/{name}": value for name, value in ALONE.items()}
    assert not read_settings(NODE).prefix


def test_seed_of_a_reset_reaches_the_nodes_that_start_again(parameters):
    parameters["/robotteamsim/set"] = "run.seed=7 run.step_s=0.05"
    read = read_settings(NODE)
    assert read_seed(NODE, read) == read
    parameters["/robotteamsim/seed"] = str(2**40)
    assert read_seed(NODE, read).scenario.run.seed == read_settings(NODE).scenario.run.seed == 2**40
    assert read_seed(NODE, read).with_seed(7) == read


@pytest.mark.parametrize(
    ("hosted", "meant", "nodes"),
    [
        ("nodes", "nodes", 3),
        ("per_robot", "nodes", 3),
        ("team", "team", 3),
        ("inside", "inside", 0),
        ("none", "none", 0),
        ("false", "none", 0),
        (False, "none", 0),
    ],
)
def test_controllers_are_nodes_or_not_and_without_them_every_robot_is_driven_by_others(
    parameters, hosted, meant, nodes
):
    parameters["/robotteamsim/controllers"] = hosted
    read = read_settings(NODE)
    assert (read.controllers, len(read.controlled)) == (meant, nodes)
    assert read.is_driven_by_hand(0) == (meant == "none")


@pytest.mark.parametrize(("text", "ids"), [("", ()), ("all", (0, 1, 2)), ("2 0", (0, 2))])
def test_robots_elsewhere_are_all_or_listed(parameters, text, ids):
    parameters["/robotteamsim/elsewhere"] = text
    read = read_settings(NODE)
    assert (read.elsewhere, read.is_another_world) == (ids, text == "all")


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"scenario": ""}, "/robotteamsim/scenario: is not set; expected the name or file of a"),
        ({"set": "voice.noise_bd=20"}, "--set: voice.noise_bd: unknown key; did you mean 'noise_db'"),
        ({"robots": 0}, "--set: robots.count: 0 is below 1"),
        ({"seed": "-1"}, "/robotteamsim/seed: -1 is below 0"),
        ({"seed": "x"}, "/robotteamsim/seed: 'x' is not a whole number"),
        ({"seed": "--5"}, "/robotteamsim/seed: '--5' is not a whole number"),
        (
            {"controllers": "tema"},
            "/robotteamsim/controllers: tema; expected nodes, team, inside, none",
        ),
        ({"teleop": 3}, "/robotteamsim/teleop: 3; expected 0 to 2"),
        ({"silence_limit_s": float("nan")}, "/robotteamsim/silence_limit_s: nan; expected a finite number"),
        ({"silence_limit_s": -1.0}, "/robotteamsim/silence_limit_s: -1; expected a finite number of at least 0"),
        ({"elsewhere": "x"}, "/robotteamsim/elsewhere: 'x'; expected ids of robots"),
        ({"elsewhere": "3"}, "/robotteamsim/elsewhere: 3; expected 0 to 2"),
        ({"elsewhere": "1", "lockstep": True}, "/robotteamsim/lockstep: true; expected false with robots in another"),
        (
            {"set": TF, "lockstep": True},
            "/robotteamsim/lockstep: true; expected false with control.localisation=tf",
        ),
        (
            {"set": TF, "controllers": "inside"},
            "/robotteamsim/controllers: inside; expected nodes or team with control.localisation=tf",
        ),
        (
            {"set": TF + ' schedule=[{"at_s":9.0,"noise_db":20.0}]', "elsewhere": "all"},
            "/use_sim_time: false; expected true, because the scenario has a schedule",
        ),
        (
            {"set": TF + " mission.victims.0.path=[[29.0,5.0]]", "elsewhere": "all"},
            "/use_sim_time: false; expected true, because the scenario has a victim victim_1 who walks",
        ),
        ({**ALONE, "robots": 2}, "/robotteamsim/prefix: false; expected true unless"),
        ({**ALONE, "controllers": "team"}, "/robotteamsim/prefix: false; expected true unless"),
        ({**ALONE, "mission": True}, "/robotteamsim/prefix: false; expected true unless"),
    ],
)
def test_settings_that_are_wrong_or_do_not_fit_are_rejected(parameters, given, line):
    parameters |= {f"/robotteamsim/{name}": value for name, value in given.items()}
    with pytest.raises(RobotTeamSimError, match="^" + re.escape(line)):
        read_settings(NODE)


@pytest.mark.parametrize("given", [{}, {"/robotteamsim/elsewhere": "all", "/use_sim_time": True}])
def test_times_of_a_scenario_go_with_poses_from_tf_by_the_simulated_clock(parameters, given):
    parameters |= {"/robotteamsim/set": TF + ' schedule=[{"at_s":9.0,"noise_db":20.0}]'} | given
    assert read_settings(NODE).scenario.control.tf_timeout_s == 0.3


def test_other_nodes_leave_a_mistake_to_the_simulation(parameters, monkeypatch):
    waited_s: list[float] = []
    monkeypatch.setattr(Ros1Node, "wait_for_shutdown", staticmethod(waited_s.append))
    parameters["/robotteamsim/set"] = "voice.noise_db=99"
    with pytest.raises(ScenarioError, match="99 is above 80"):
        read_settings(NODE)
    assert waited_s == [10.0]


def test_number_of_robots_must_fit_a_list_of_robots(parameters, tmp_path):
    file = tmp_path / "two.yaml"
    file.write_text("name: two\nplan: garage\nrobots: [{start_pose: [4, 5, 0]}, {start_pose: [6, 5, 0]}]\n")
    parameters |= {"/robotteamsim/scenario": str(file), "/robotteamsim/robots": 3}
    with pytest.raises(ParameterError, match=r"/robotteamsim/robots: 3; expected 2, the length of the robots' list"):
        read_settings(NODE)
    parameters["/robotteamsim/robots"] = 2
    assert read_settings(NODE).num_robots == 2


def test_code_that_a_scenario_file_names_is_rejected_unless_it_is_allowed(parameters, tmp_path):
    path = tmp_path / "my.yaml"
    robots = "robots: {count: 2, start: [3, 3, 0]}"
    path.write_text(f"name: my\nplan: garage\n{robots}\ncontrol: {{algorithm: 'somewhere:Mine'}}\n", encoding="utf-8")
    parameters["/robotteamsim/scenario"] = str(path)
    with pytest.raises(ScenarioError, match=r"'somewhere:Mine' runs any code; .* add allow_code:=true$"):
        read_settings(NODE)
    parameters["/robotteamsim/allow_code"] = True
    assert read_settings(NODE).scenario.control.algorithm == "somewhere:Mine"

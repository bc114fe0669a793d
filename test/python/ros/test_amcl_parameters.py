"""The parameters of amcl for each robot of a scenario."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import yaml

from robotteamsim.ros.nodes import amcl_parameters
from robotteamsim.scenario import load
from robotteamsim.setup import resolve

FILE = Path(__file__).parents[3] / "launch" / "amcl.yaml"


@pytest.fixture
def printed(monkeypatch, capsys):
    """Return a function that runs the program as amcl_robot.launch does, where amcl is installed or is not."""

    def run(scenario, robots, seed, overrides, robot, path="/opt/amcl"):
        monkeypatch.setattr(amcl_parameters, "installed", lambda *_: path)
        monkeypatch.setattr(sys, "argv", ["amcl_parameters", str(FILE), scenario, robots, seed, overrides, robot])
        amcl_parameters.main()
        return yaml.safe_load(capsys.readouterr().out)

    return run


def test_missing_arguments_are_named(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["amcl_parameters"])
    with pytest.raises(SystemExit, match="2"):
        amcl_parameters.main()
    assert capsys.readouterr().err == "amcl_parameters: 0 arguments; expected FILE SCENARIO ROBOTS SEED SET ROBOT\n"


@pytest.mark.parametrize(
    ("seed", "overrides", "same"),
    [
        ("", "", ["robots.count=2"]),
        ("5", "robots.formation=random", ["robots.count=2", "robots.formation=random", "run.seed=5"]),
    ],
    ids=["in line", "at random"],
)
def test_each_amcl_starts_where_its_robot_does_and_has_its_frames(printed, seed, overrides, same):
    for robot_id, robot in enumerate(resolve(load("garage_sar", same)).robots):
        found = printed("garage_sar", "2", seed, overrides, str(robot_id))
        assert tuple(found[f"initial_pose_{axis}"] for axis in "xya") == robot.start_pose
        assert found["odom_frame_id"] == f"robot_{robot_id}/odom"
        assert found["base_frame_id"] == f"robot_{robot_id}/base_link"


def test_noise_of_the_odometry_is_that_of_two_steps(printed):
    found = printed("garage_sar", "1", "", "robots.odometry.alpha3=0.002", "0")
    assert [found[f"odom_alpha{i}"] for i in (1, 2, 3, 4)] == [0.005, 0.0005, 0.001, 0.00005]


def test_weights_of_the_beam_model_add_up_to_1(printed):
    found = printed("garage_sar", "-1", "", "", "0")
    assert found["laser_model_type"] == "beam"
    assert sum(found[f"laser_z_{name}"] for name in ("hit", "short", "max", "rand")) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("arguments", "path", "line"),
    [
        (("garage_sar", "-1", "", "", "0"), None, "amcl (ROS package amcl) is not installed; "),
        (("garage_sar", "2", "", "", "2"), "/opt/amcl", "robot: 2; expected 0 to 1\n"),
        (("nowhere.yaml", "-1", "", "", "0"), "/opt/amcl", "nowhere.yaml: there is no such file\n"),
        (("garage_sar", "-1", "x", "", "0"), "/opt/amcl", "--set: run.seed: 'x' is not a whole number\n"),
    ],
    ids=["no amcl", "no such robot", "no such scenario", "wrong seed"],
)
def test_what_is_wrong_is_one_line_with_status_2(printed, capsys, arguments, path, line):
    with pytest.raises(SystemExit) as ended:
        printed(*arguments, path=path)
    captured = capsys.readouterr()
    assert (ended.value.code, captured.out) == (2, "")
    assert captured.err.startswith(f"amcl_robot.launch: {line}")
    assert captured.err.count("\n") == 1

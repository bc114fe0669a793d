"""The page about the inputs of controllers has every attribute, and its example runs as printed."""

from __future__ import annotations

import dataclasses
import inspect
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import robotteamsim as rts
from robotteamsim.testing import check_controller

PAGE = (Path(__file__).parents[3] / "docs" / "what_a_controller_sees.md").read_text(encoding="utf-8")
(EXAMPLE,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
NAMES = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`\n]+)`", PAGE.partition("## Example")[0]))))

RECORDS = (
    *(rts.Observation, rts.RobotReading, rts.OdometryReading, rts.PoseReading, rts.Pose, rts.Twist, rts.VoiceReading),
    *(rts.Message, rts.Task, rts.Discovery, rts.Assistance, rts.Decision),
)


@pytest.mark.parametrize("record", RECORDS)
def test_page_has_each_attribute_of_a_record(record):
    assert set(record.__struct_fields__) - NAMES == set()


@pytest.mark.parametrize("kind", [rts.Situation, rts.PathController, rts.KnownMap, rts.Grid, rts.MapSource])
def test_page_has_each_public_name_of_a_class(kind):
    own = {name for name in vars(kind) if not name.startswith("_")}
    if dataclasses.is_dataclass(kind):
        own |= {field.name for field in dataclasses.fields(kind)}
    assert own - NAMES - {"step"} == set()


def test_names_of_the_page_are_in_the_package():
    used = set(re.findall(r"\brts\.(\w+)", PAGE))
    assert used - set(rts.__all__) == set()
    assert {"KnownMap", "PathController", "PlanningGrid", "Situation"} <= used


def test_methods_of_the_grid_are_those_of_the_package_and_have_docstrings():
    methods = {name for name, value in vars(rts.PlanningGrid).items() if not name.startswith("_") and callable(value)}
    listed = re.search(r"an `rts.PlanningGrid`, has (.*?) and more", PAGE, re.DOTALL)
    assert set(re.findall(r"`(\w+)`", listed[1])) <= methods
    assert all("\n\n" in inspect.getdoc(getattr(rts.PlanningGrid, name)) for name in methods)


@pytest.fixture
def on_path(tmp_path, monkeypatch):
    """The example in a folder in which Python finds it."""
    (tmp_path / "nearest_frontier.py").write_text(EXAMPLE)
    monkeypatch.syspath_prepend(tmp_path)
    yield
    sys.modules.pop("nearest_frontier", None)


@pytest.mark.slow
@pytest.mark.usefixtures("on_path")
def test_example_explores_a_building_that_nobody_knows_and_touches_nothing_for_long():
    algorithm = "control.algorithm=nearest_frontier:NearestFrontier"
    simulation = rts.Simulation(rts.load("garage_unknown", [algorithm, "mission.time_limit_s=240"]))
    result = simulation.run()
    assert result.areas_explored >= 1
    assert result.victims_saved >= 1
    assert all(robot.distance_m > 30.0 and robot.contact_s < 6.0 for robot in result.robots)
    robots = [guard.controller.controller.controller for guard in simulation.controllers.guards]
    assert all(set(robot.goals) == {0, 1, 2} - {robot.robot_id} for robot in robots)
    assert all(0.4 < np.mean(robot.found.grid(0.1).cells != rts.UNKNOWN) < 0.95 for robot in robots)


@pytest.mark.slow
@pytest.mark.usefixtures("on_path")
def test_example_leaves_voices_behind_walls():
    """In the office, a voice is heard at each place of the robots' way."""
    algorithm = "control.algorithm=nearest_frontier:NearestFrontier"
    result = rts.Simulation(rts.load("office_unknown", [algorithm, "mission.time_limit_s=220"])).run()
    assert result.victims_saved >= 3
    assert all(robot.distance_m > 60.0 for robot in result.robots)


@pytest.mark.slow
@pytest.mark.usefixtures("on_path")
def test_example_keeps_the_rules_of_controllers():
    check_controller("nearest_frontier:NearestFrontier", "garage_unknown", steps=60)

"""What nobody can run is refused in one line; a faulty controller stops its robot, and the mission goes on."""

from __future__ import annotations

import json

import pytest

from robotteamsim.cli import main
from robotteamsim.recording.bag_reader import BagReader

SHORT = ("--set", "mission.time_limit_s=2")

FAULTY = """
from robotteamsim.interface import Decision
from robotteamsim.geometry import Twist
from robotteamsim.network.messages import Message

class Sound:
    def __init__(self, robot_id, scenario):
        self.robot_id = robot_id

    def step(self, observation, inbox, task):
        return self.odd() if self.robot_id == 1 else Decision(Twist(0.2))

class Raises(Sound):
    def odd(self):
        raise ValueError("of no\\nuse")

class Exits(Sound):
    def odd(self):
        raise SystemExit(3)

class SaysNan(Sound):
    def odd(self):
        return Decision(Twist(float("nan")))

class SaysTooMuch(Sound):
    def odd(self):
        return Decision(outbox=(Message(1, 0, "x" * 70000),))

class SaysNonsense(Sound):
    def odd(self):
        return Decision(local_best="high")
"""


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        (["control.c1=-0.1"], "--set: control.c1: -0.1 is below 0"),
        (["control.c2=2.5"], "--set: control.c2: 2.5 is above 2"),
        (["control.c4=.nan"], "--set: control.c4: .nan is not a finite number"),
        (["control.alpha=1.2"], "--set: control.alpha: 1.2 is above 1"),
        (["control.adaptation=neural"], "--set: control.adaptation: 'neural' is not one of none, crisp, fuzzy"),
        (["control.alpha=-0.1"], "--set: control.alpha: -0.1 is below 0"),
        (["control.algorithm=pso", "control.inertia=2"], "--set: control.inertia: 2 is above 1"),
        (["control.swarms.min=3"], "--set: control.swarms.initial: 1 is below min, 3"),
        (["control.swarms.initial=2"], "--set: control.swarms.max: 1 is below initial, 2"),
        (
            ["control.exclusion.min_robots=9", "control.exclusion.max_robots=3"],
            "--set: control.exclusion.max_robots: 3 is below min_robots, 9",
        ),
        (["robots.count=0"], "--set: robots.count: 0 is below 1"),
        (["robots=[]"], "--set: robots: has 0 items; expected at least 1"),
        (["network.max_message_bytes=0"], "--set: network.max_message_bytes: 0 is below 1"),
        (["mission.base=3"], "--set: mission.base: there is no robot 3; expected 0 to 2"),
        (
            ["control.algorithm=faulty_ones:Missing"],
            "garage_sar: control.algorithm: 'faulty_ones:Missing': ModuleNotFoundError: No module named 'faulty_ones'; "
            "is its folder in PYTHONPATH?",
        ),
    ],
)
def test_bad_value_is_rejected_in_one_line_with_exit_status_2(capsys, settings, line):
    arguments = [word for setting in settings for word in ("--set", setting)]
    assert main(["run", "garage_sar", *arguments]) == 2
    assert capsys.readouterr().err == f"robotteamsim: {line}\n"


@pytest.mark.parametrize(
    ("name", "kind", "detail"),
    [
        ("Raises", "controller_failed", "robot 1 is stopped: ValueError: of no use (faulty_ones_of_test.py:"),
        ("Exits", "controller_failed", "robot 1 is stopped: SystemExit: 3 (faulty_ones_of_test.py:"),
        ("SaysNan", "controller_failed", "robot 1 is stopped: step returned Twist(linear_x_mps=nan, "),
        (
            "SaysNonsense",
            "controller_failed",
            "robot 1 is stopped: step returned local_best = 'high'; expected a number",
        ),
        ("SaysTooMuch", "message_too_large", "robot 1 cannot send 70000 bytes, the limit is 65507"),
    ],
)
def test_faulty_controller_is_an_event_and_the_mission_goes_on(tmp_path, monkeypatch, name, kind, detail):
    (tmp_path / "faulty_ones_of_test.py").write_text(FAULTY)
    monkeypatch.syspath_prepend(tmp_path)
    out, bag = tmp_path / "out", tmp_path / "m.bag"
    chosen = ("--set", f"control.algorithm=faulty_ones_of_test:{name}")
    status = main(["run", "garage_sar", *SHORT, *chosen, "--out", str(out), "--bag", str(bag), "--quiet"])
    assert status == (kind == "controller_failed")
    document = json.loads((out / "mission.json").read_text())
    (event,) = [event for event in document["events"] if event["kind"] not in ("start", "end")]
    assert (event["kind"], event["robot_id"]) == (kind, 1)
    assert event["detail"].startswith(detail)
    assert document["result"]["end"] == "time_limit"
    driven_m = [robot["distance_m"] for robot in document["result"]["robots"]]
    assert driven_m[1] < 0.01 < 0.2 < min(driven_m[0], driven_m[2])
    with BagReader([bag]) as reader:
        events = [message.detail for _, _, message in reader.messages({"/mission/events"})]
    assert event["detail"] in events


def test_check_refuses_a_patrol_that_cannot_be_measured(tmp_path, refusal):
    """The robots of a small room are larger than the firefighter, for whose radius the graph is measured."""
    walls = ["{from: [0, 0], to: [4.3, 0]}", "{from: [4.3, 0], to: [4.3, 3.2]}"]
    walls += ["{from: [4.3, 3.2], to: [0, 3.2]}", "{from: [0, 3.2], to: [0, 0]}"]
    named = ", ".join(f"{{name: w{i}, thickness_m: 0.2, {wall[1:]}" for i, wall in enumerate(walls))
    path = tmp_path / "room.yaml"
    path.write_text(
        "name: room\n"
        f"plan: {{name: room, bounds: {{min: [-0.5, -0.5], max: [4.8, 3.7]}}, walls: [{named}]}}\n"
        "robots: {radius_m: 0.25, count: 1, start: [2.15, 1.6, 0]}\n"
        "firefighters: {count: 1, start: [1.55, 2.1, 0]}\n"
        "command_centre: 0\n"
        "mission: {saved_by: firefighter, areas: [{name: a, center: [2.2, 1.2], radius_m: 1}]}\n"
        "control: {algorithm: sebs}\n"
    )
    line = refusal("scenario", "check", path)
    assert line == f"{path}: mission.patrol.spacing_m: 6 m leaves no two places of the plan linked"


def test_check_names_the_option_of_a_patrol_that_cannot_be_measured(refusal):
    changes = ("--set", "control.algorithm=sebs", "--set", "mission.patrol.spacing_m=100")
    line = "--set: mission.patrol.spacing_m: 100 m leaves no two places of the plan linked"
    assert refusal("scenario", "check", "tutorial_arena", *changes) == line

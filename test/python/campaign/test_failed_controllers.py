"""Trials in which a controller fails are counted, stored and named; no campaign starts without its controllers."""

from __future__ import annotations

import contextlib
import csv
import json
from pathlib import Path

import pytest

import robotteamsim
from robotteamsim.campaign import Trial, make_design, read_store, run_trial
from robotteamsim.campaign.factors import parse_override
from robotteamsim.campaign.summary import controllers_note, summarise
from robotteamsim.cli import campaign_command, main
from robotteamsim.errors import CampaignError
from robotteamsim.scenario import load

LIMIT = "mission.time_limit_s=2"
CLASSES = """\
from robotteamsim import Decision, Twist


class Raises:
    def __init__(self, robot_id, scenario):
        self.robot_id, self.seed, self.steps = robot_id, scenario.run.seed, 0

    def step(self, observation, inbox, task):
        self.steps += 1
        if self.robot_id == 1 and self.steps > 3:
            raise ValueError("of no\\nuse")
        return Decision(Twist(0.1))


class SaysNan(Raises):
    def step(self, observation, inbox, task):
        return Decision(Twist(float("nan") if self.robot_id == 2 else 0.1))


class FailsInOddTrials(Raises):
    def step(self, observation, inbox, task):
        return super().step(observation, inbox, task) if self.seed % 2 else Decision()


class SaysNanInOddTrials(SaysNan):
    def step(self, observation, inbox, task):
        return SaysNan.step(self, observation, inbox, task) if self.seed % 2 else Decision()


class NotMade:
    def __init__(self, robot_id, scenario):
        if robot_id == 2:
            raise RuntimeError("no licence")

    def step(self, observation, inbox, task):
        return Decision()
"""
RAISED = "0.3 s: robot 1 is stopped: ValueError: of no use (failing_of_test.py:11)"
NAN = "Twist(linear_x_mps=nan, linear_y_mps=0.0, angular_z_radps=0.0); expected a Twist of finite numbers"
RETURNED = f"0.0 s: robot 2 is stopped: step returned {NAN} (failing_of_test.py:16)"


@pytest.fixture
def failing(tmp_path, monkeypatch):
    """Put the module with the controllers where workers find it, too, and let commands use workers of their own."""
    (tmp_path / "failing_of_test.py").write_text(CLASSES)
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def scenario_with(name: str):
    return load("garage_sar", [f"control.algorithm=failing_of_test:{name}", LIMIT])


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        # The first decision is that of the start, at 0 s; the fourth one raises.
        ("Raises", RAISED),
        ("SaysNan", RETURNED),
    ],
)
def test_outcome_has_the_first_controller_that_failed_and_its_reason(failing, name, reason):
    outcome = run_trial(scenario_with(name), Trial(0, 1, 5), robotteamsim.__version__)
    assert outcome.controller_failed == reason
    assert (outcome.failed, outcome.end) == (False, "time_limit")


def test_outcome_of_working_controllers_has_no_failure(hall_scenario):
    assert run_trial(hall_scenario(), Trial(0, 1, 1), robotteamsim.__version__).controller_failed == ""


def test_summary_counts_the_trials_and_the_note_names_the_first(short_design, outcome_of):
    design = short_design("voice.noise_db=10,20", trials=3)
    reasons = {(1, 1): "0.3 s: robot 1 is stopped: A", (1, 3): "0.9 s: robot 0 is stopped: B"}
    outcomes = [outcome_of(t, controller_failed=reasons.get((t.cell, t.number), "")) for t in design.all_trials()]
    assert [summary.controllers_failed for summary in summarise(design, outcomes)] == [0, 2]
    first = next(outcome for outcome in outcomes if outcome.controller_failed)
    wanted = f"In 2 of 6 missions a controller failed; the first: seed {first.seed}, 0.3 s: robot 1 is stopped: A"
    assert controllers_note(outcomes) == wanted
    assert controllers_note([outcome for outcome in outcomes if not outcome.controller_failed]) == ""


def test_constructor_that_raises_ends_a_campaign_before_it_starts(failing, capsys, tmp_path):
    chosen = "control.algorithm=failing_of_test:NotMade"
    with pytest.raises(CampaignError, match=r"cannot be constructed for robot 2: RuntimeError: no licence \(failing_"):
        make_design("garage_sar", trials=1, overrides=[parse_override(chosen)])
    out = tmp_path / "c"
    assert main(["campaign", "garage_sar", "--set", chosen, "--trials", "1", "--out", str(out)]) == 2
    line = f"--set: control.algorithm: '{chosen.partition('=')[2]}' cannot be constructed for robot 2: RuntimeError: "
    assert capsys.readouterr().err == f"robotteamsim: {line}no licence (failing_of_test.py:33)\n"
    assert not out.exists()


class TrialsHere:
    """Runs trials in this process instead of on workers, which other tests share."""

    def run(self, design, trials, keep):
        for trial in trials:
            keep(run_trial(design.cells[trial.cell].scenario, trial, robotteamsim.__version__))
        return ()


@pytest.fixture
def in_this_process(monkeypatch):
    monkeypatch.setattr(campaign_command, "local_workers", lambda count, most: contextlib.nullcontext(TrialsHere()))


@pytest.mark.parametrize(
    ("name", "reason"),
    [("FailsInOddTrials", RAISED), ("SaysNanInOddTrials", RETURNED.replace(":16)", ":26)"))],
)
def test_campaign_and_report_count_the_failures_and_end_with_status_1(
    failing, capsys, tmp_path, in_this_process, name, reason
):
    out = tmp_path / "c"
    command = ["campaign", "garage_sar", "--set", f"control.algorithm=failing_of_test:{name}", "--set", LIMIT]
    assert main([*command, "--trials", "6", "--out", str(out), "--json"]) == 1
    captured = capsys.readouterr()
    odd = [outcome for outcome in read_store(out).outcomes if outcome.seed % 2]
    assert 0 < len(odd) < 6, "the seeds of the campaign are all odd or all even"
    line = f"In {len(odd)} of 6 missions a controller failed; the first: seed {odd[0].seed}, {reason}"
    assert captured.err.endswith(f"robotteamsim: {line}\n")
    document = json.loads(captured.out)
    assert document["cells"][0]["controllers_failed"] == document["controllers_failed"] == len(odd)
    listed = [(each["seed"], each["controller_failed"]) for each in document["with_failed_controllers"]]
    assert listed == [(o.seed, reason) for o in odd]
    rows = list(csv.DictReader((out / "trials.csv").read_text().splitlines()))
    assert {int(row["seed"]): row["controller_failed"] for row in rows if row["controller_failed"]} == {
        outcome.seed: reason for outcome in odd
    }
    assert main(["report", str(out), "--no-players", "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert (report["controllers_failed"], report["notes"][0]) == (len(odd), line)
    assert line in Path(report["report"]).read_text()


EACH = pytest.mark.parametrize(("name", "reason"), [("Raises", RAISED), ("SaysNan", RETURNED)])


@EACH
def test_benchmark_counts_the_failures_and_ends_with_status_1(failing, capsys, tmp_path, in_this_process, name, reason):
    command = [
        "benchmark",
        "patrol",
        "--controller",
        "sebs",
        "--controller",
        f"failing_of_test:{name}",
        "--robots",
        "3",
    ]
    assert main([*command, "--trials", "1", "--duration", "20", "--out", str(tmp_path / "b"), "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["controllers_failed"] == 1
    assert document["notes"][0].startswith("In 1 of 2 missions a controller failed; the first: seed ")
    assert document["notes"][0].endswith(reason)


@EACH
def test_run_and_analyse_name_the_failure_and_end_with_status_1(failing, capsys, tmp_path, name, reason):
    bag = tmp_path / "m.bag"
    chosen = ("--set", f"control.algorithm=failing_of_test:{name}", "--set", LIMIT)
    assert main(["run", "garage_sar", *chosen, "--json", "--bag", str(bag)]) == 1
    captured = capsys.readouterr()
    result = json.loads(captured.out)
    assert (result["controllers_failed"], result["controller_failed"]) == (1, reason)
    assert f"robotteamsim: 1 controller failed; the first: {reason}\n" in captured.err
    sound = tmp_path / "sound.bag"
    assert main(["run", "garage_sar", "--set", LIMIT, "--quiet", "--bag", str(sound)]) == 0
    assert (
        main(["analyse", str(sound), str(bag), "--csv", str(tmp_path / "t"), "--json", str(tmp_path / "t.json")]) == 1
    )
    assert capsys.readouterr().err == f"robotteamsim: a controller failed in 1 of 2 bags; the first: m: {reason}\n"
    found = json.loads((tmp_path / "t.json").read_text())["bags"]
    assert [(each["controllers_failed"], each["controller_failed"]) for each in found] == [(0, ""), (1, reason)]
    rows = list(csv.DictReader((tmp_path / "t" / "bags.csv").read_text().splitlines()))
    assert [row["controller_failed"] for row in rows] == ["", reason]
    assert main(["analyse", str(sound)]) == 0

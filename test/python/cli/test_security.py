"""What inputs can do: a file runs no code unless it is allowed to, and a CSV file holds no formulas."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from robotteamsim.cli import campaign_command, main
from robotteamsim.wording import safe_cell

FOREIGN = """
import pathlib
from robotteamsim.control.baselines.greedy import GreedyController
pathlib.Path('ran').touch()
Mine = GreedyController
"""
SHORT = ("--set", "mission.time_limit_s=1")


@pytest.fixture
def scenario_file(tmp_path, monkeypatch):
    """A scenario whose controller is a module beside it; the module leaves the file `ran` when it is imported."""
    (tmp_path / "foreign_of_test.py").write_text(FOREIGN)
    path = tmp_path / "my.yaml"
    robots = "robots: {count: 2, start: [3, 3, 0]}"
    path.write_text(f"name: my\nplan: garage\n{robots}\ncontrol: {{algorithm: 'foreign_of_test:Mine'}}\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(__import__("sys").modules, "foreign_of_test", raising=False)
    monkeypatch.chdir(tmp_path)
    return path


@pytest.mark.parametrize(
    "command",
    [("run", "my.yaml"), ("campaign", "my.yaml", "--trials", "1", "--out", "d"), ("scenario", "check", "my.yaml")],
)
@pytest.mark.usefixtures("scenario_file")
def test_code_that_a_file_names_does_not_run(refusal, command):
    assert refusal(*command, *SHORT) == (
        "my.yaml: control.algorithm: 'foreign_of_test:Mine' runs any code; if you trust the file, add --allow-code"
    )
    assert not Path("ran").exists()


@pytest.mark.usefixtures("scenario_file")
def test_code_that_a_design_file_names_does_not_run(refusal):
    Path("design.yaml").write_text("trials: 1\nsweep: {control.algorithm: [rdpso, 'foreign_of_test:Mine']}\n")
    line = refusal("campaign", "garage_sar", "--design", "design.yaml", "--out", "d")
    assert line.startswith("design.yaml: control.algorithm: 'foreign_of_test:Mine' runs any code")
    assert not Path("ran").exists()


@pytest.mark.usefixtures("scenario_file")
@pytest.mark.parametrize("allowed", [("--allow-code",), ("--set", "control.algorithm=foreign_of_test:Mine")])
def test_code_runs_that_the_user_has_named_or_allowed(allowed):
    assert main(["run", "my.yaml", *SHORT, *allowed, "--quiet"]) == 0
    assert Path("ran").exists()


@pytest.mark.usefixtures("scenario_file")
def test_scenario_with_code_can_be_shown_without_running_it(capsys):
    assert main(["scenario", "show", "my.yaml"]) == 0
    assert "foreign_of_test:Mine" in capsys.readouterr().out
    assert not Path("ran").exists()


@pytest.mark.parametrize(
    ("value", "cell"),
    [
        ("=cmd()", "'=cmd()"),
        ("@x", "'@x"),
        ("-x", "'-x"),
        ("+1+1", "'+1+1"),
        ("-1.5", "-1.5"),
        ("a=b", "a=b"),
        (-2, -2),
    ],
)
def test_formula_is_no_cell(value, cell):
    assert safe_cell(value) == cell


def test_tables_of_a_bag_hold_no_formulas(tmp_path):
    bag, tables = tmp_path / "=1+1.bag", tmp_path / "tables"
    assert main(["run", "garage_sar", *SHORT, "--bag", str(bag), "--quiet"]) == 0
    assert main(["analyse", str(bag), "--csv", str(tables)]) == 0
    for file in tables.iterdir():
        with file.open(newline="", encoding="utf-8") as lines:
            assert not any(cell.startswith("=") for row in csv.reader(lines) for cell in row)


@pytest.mark.parametrize(
    ("address", "warns"), [("tcp://10.9.8.7:1", True), ("tls://10.9.8.7:1", False), ("tcp://127.0.0.1:1", False)]
)
def test_scheduler_without_tls_on_a_network_is_warned_of(monkeypatch, capsys, tmp_path, address, warns):
    def nowhere(_: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(campaign_command, "scheduler_at", nowhere)
    arguments = ["campaign", "garage_sar", "--trials", "1", "--out", str(tmp_path / "d"), "--scheduler", address]
    assert main(arguments) == 130
    assert ("without TLS, whoever reaches it can run code" in capsys.readouterr().err) is warns


def test_names_of_code_stay_plain_text_in_results(scenario_file, tmp_path):
    assert main(["run", str(scenario_file), *SHORT, "--allow-code", "--quiet", "--out", str(tmp_path / "o")]) == 0
    document = json.loads((tmp_path / "o" / "mission.json").read_text())
    assert document["scenario"]["control"]["algorithm"] == "foreign_of_test:Mine"

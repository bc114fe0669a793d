"""The examples that train: their options, and a training of some seconds."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "learning"
NAMES = ["ppo_search", "mappo_search"]


@pytest.fixture(autouse=True)
def libraries():
    for name in ("torch", "torchrl", "stable_baselines3"):
        pytest.importorskip(name, reason=f"{name} is not installed (with PyTorch 1 GB; extra train)")


def run(name, *arguments):
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_help_names_the_options(name):
    done = run(name, "--help")
    assert (done.returncode, done.stderr) == (0, "")
    assert all(option in done.stdout for option in ("--seed", "--minutes", "--batch", "--out"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("option", "value", "line"),
    [("--minutes", "0", "0 is not above 0"), ("--seed", "x", "'x' is not a whole number"), ("--batch", "2", "batch")],
)
def test_bad_options_are_one_line(option, value, line):
    done = run("ppo_search", option, value)
    assert done.returncode == 2
    assert f"error: argument {option}: " in done.stderr
    assert line in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_training_writes_a_policy_that_runs_and_its_curve(name, tmp_path):
    options = "--minutes", 0.02, "--batch", 3, "--evaluations", 1, "--missions", 1, "--seed", 3
    done = run(name, "--out", tmp_path, *options)
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader((tmp_path / "learning_curve.csv").read_text().splitlines()))
    assert rows[0]["decisions"] == "0"
    assert int(rows[-1]["decisions"]) >= 3 * 3 * 128
    assert all(row["seed"] == "3" and 0.0 <= float(row["score"]) <= 1.0 for row in rows)
    policy = f"control.algorithm={tmp_path / 'policy.pt'}"
    command = [sys.executable, "-m", "robotteamsim.cli", "run", "garage_sar", "--set", policy]
    mission = subprocess.run(
        [*command, "--set", "mission.time_limit_s=5"], capture_output=True, text=True, cwd=EXAMPLES
    )
    assert mission.returncode == 0, mission.stderr

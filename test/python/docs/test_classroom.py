"""docs/classroom.md and docs/exercises.md: every command runs, and the solutions give what the sheet says."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
SHEET = (ROOT / "docs" / "exercises.md").read_text(encoding="utf-8")
PAGE = (ROOT / "docs" / "classroom.md").read_text(encoding="utf-8")
CONTAINERFILE = (ROOT / "setup" / "Containerfile").read_text(encoding="utf-8")


def commands(text: str) -> list[str]:
    """Return the commands that a page prints."""
    return [line for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]


RANGE, DOORS, NOISE, WALL, FAILURE, PRINTED, PRESETS = commands(SHEET)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of docs/exercises."""
    return Path(shutil.copytree(ROOT / "docs" / "exercises", tmp_path_factory.mktemp("class") / "exercises"))


def output(command: str, folder: Path) -> str:
    """Run a command with this interpreter and return what it prints."""
    words = command.replace("robotteamsim ", f"{sys.executable} -m robotteamsim.cli ", 1)
    words = words.replace("python3 ", f"{sys.executable} ", 1)
    words = words.replace("PYTHONPATH=.", f"PYTHONPATH=.:{os.environ.get('PYTHONPATH', '')}")
    done = subprocess.run(words, shell=True, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def result(command: str, folder: Path) -> dict[str, object]:
    return json.loads(output(f"{command} --json", folder))


def test_radio_range_is_that_of_the_sheet(folder: Path) -> None:
    assert re.findall(r"[\d.]+ m", output(RANGE, folder)) == ["25.4 m", "102.0 m", "48.0 m", "25.4 m"]
    assert "the simulator: -80.0 dBm" in output(RANGE, folder)
    assert "beyond 25.4 m, lost beyond 102.0 m, and beyond 48.0 m" in SHEET


def test_losses_of_doors_equal_the_data_sheet(folder: Path) -> None:
    values = re.findall(r"-?[\d.]+ dBm?", output(DOORS, folder))
    assert values == ["-79.4 dBm", "-99.8 dBm", "20.4 dB"]
    assert all(value in SHEET for value in values[:2])


def test_noise_costs_victims_and_shortens_missions(folder: Path) -> None:
    output(f"{NOISE} --trials 3", folder)
    with (folder / "noise" / "trials.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for key in ("victims_saved", "time_s"):
        quiet, loud = (
            statistics.mean(float(row[key]) for row in rows if float(row["voice.noise_db"]) == noise_db)
            for noise_db in (10.0, 30.0)
        )
        assert quiet > loud


def test_wall_follower_drives_far_and_touches_nothing(folder: Path) -> None:
    (robot,) = result(WALL, folder)["robots"]
    assert robot["distance_m"] > 30.0
    assert robot["contact_s"] == 0.0


def test_two_robots_save_everyone_after_a_failure_but_not_as_printed(folder: Path) -> None:
    survived = result(FAILURE, folder)
    assert (survived["end"], survived["victims_saved"]) == ("areas_explored", 4)
    printed = result(PRINTED, folder)
    assert (printed["end"], printed["areas_explored"] < 5) == ("time_limit", True)


def test_presets_reach_the_shares_of_the_sheet(folder: Path) -> None:
    shares = re.findall(r"(\d+) % linked, (\d+) %", output(PRESETS, folder))
    assert shares == re.findall(r"(\d+) % \((\d+) %", " ".join(SHEET.split()))


def test_commands_of_the_class_page_run(folder: Path) -> None:
    for command in commands(PAGE):
        output(command, folder)
    assert (folder / "mission.png").stat().st_size > 10_000


def test_containerfile_builds_on_the_system_and_by_the_targets_of_the_makefile() -> None:
    assert "\nFROM docker.io/library/debian:12\n" in CONTAINERFILE
    targets = re.findall(r"^RUN make (\w+)$", CONTAINERFILE, re.MULTILINE)
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets)
    (needed,) = re.findall(r"^garage_sar: (\w+)", makefile, re.MULTILINE)
    assert needed in targets
    ignored = (ROOT / ".dockerignore").read_text(encoding="utf-8").split("\n")
    assert {"build", ".venv"} <= set(ignored)

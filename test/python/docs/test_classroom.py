"""docs/classroom.md and docs/exercises.md: every command runs, and the solutions give what sheet and answers say."""

from __future__ import annotations

import json
import os
import re
import shutil
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


ANSWERS = (ROOT / "docs" / "exercise_answers.md").read_text(encoding="utf-8")
NEW, ENTER, RANGE, DOORS, NOISE, MEANS, WALL, FAILURE, PRINTED, PRESETS = commands(SHEET)


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


def digits(number: int) -> list[str]:
    """Return the digits of checks and hashes that the sheet gives for an exercise."""
    (section,) = re.findall(rf"## {number}\. (.*?)(?=\n## |\Z)", SHEET, re.DOTALL)
    return re.findall(r"`([0-9a-f]{8})`", section)


def check(command: str, folder: Path) -> list[str]:
    return re.findall(r"^check: (\w+)$", output(command, folder), re.MULTILINE)


def begun(result: dict[str, object]) -> str:
    return str(result["trajectory_hash"])[:8]


def test_files_of_the_exercises_run_before_anything_is_added_and_print_other_checks(tmp_path: Path) -> None:
    assert ENTER == "cd exercises"
    assert "next: cd exercises && python3 radio_range.py" in output(NEW, tmp_path)
    sheet = tmp_path / "exercises"
    assert sorted(path.name for path in sheet.iterdir()) == sorted(
        path.name for path in (ROOT / "docs" / "exercises").iterdir() if path.name != "minimise.py"
    )
    for command, number in ((RANGE, 1), (DOORS, 2), (PRESETS, 6)):
        (printed,) = check(command, sheet)
        assert printed not in digits(number)
    assert begun(result(WALL, sheet)) == digits(4)[0]
    assert begun(result(FAILURE, sheet)) == digits(5)[2]


def test_radio_range_is_that_of_the_answers(folder: Path) -> None:
    assert re.findall(r"[\d.]+ m\b", output(RANGE, folder)) == ["25.4 m", "102.0 m", "48.0 m", "25.4 m"]
    assert "the simulator: -80.0 dBm" in output(RANGE, folder)
    assert "beyond 25.4 m, lost beyond 102.0 m, and beyond 48.0 m" in ANSWERS
    assert check(RANGE, folder) == digits(1)


def test_losses_of_doors_equal_the_data_sheet(folder: Path) -> None:
    values = re.findall(r"-?[\d.]+ dBm?", output(DOORS, folder))
    assert values == ["-79.4 dBm", "-99.8 dBm", "20.4 dB"]
    assert all(value in ANSWERS for value in values[:2])
    assert check(DOORS, folder) == digits(2)


def test_noise_costs_victims_and_shortens_missions(folder: Path) -> None:
    output(NOISE, folder)
    printed = re.findall(r"([\d.]+) victims saved in ([\d.]+) s", output(MEANS, folder))
    (said,) = re.findall(r"On average (.*?) and (.*?) victims are saved in (.*?) and (.*?) s\.", ANSWERS)
    assert [victims for victims, _ in printed] == [*said[0].split(", "), said[1]]
    assert [f"{float(time_s):.0f}" for _, time_s in printed] == [*said[2].split(", "), said[3]]
    assert check(MEANS, folder) == digits(3)


def test_wall_follower_drives_far_and_touches_nothing(folder: Path) -> None:
    drove = result(WALL, folder)
    (robot,) = drove["robots"]
    assert robot["distance_m"] > 30.0
    assert robot["contact_s"] == 0.0
    assert f"drives {robot['distance_m']:.0f} m; trajectories: `{begun(drove)}`" in ANSWERS


def test_two_robots_save_everyone_after_a_failure_but_not_as_printed(folder: Path) -> None:
    survived = result(FAILURE, folder)
    assert (survived["end"], survived["victims_saved"]) == ("areas_explored", 4)
    printed = result(PRINTED, folder)
    assert (printed["end"], printed["areas_explored"] < 5) == ("time_limit", True)
    assert [begun(survived), begun(printed)] == digits(5)[:2]


def test_presets_reach_the_shares_of_the_answers(folder: Path) -> None:
    shares = re.findall(r"(\d+) % linked, (\d+) %", output(PRESETS, folder))
    assert shares == re.findall(r"(\d+) % \((\d+) %", " ".join(ANSWERS.split()))
    assert check(PRESETS, folder) == digits(6)


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

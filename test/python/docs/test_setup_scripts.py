"""The scripts of the set-up: steps with their logs, and the environment of ROS."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


def step(folder: Path, command: str) -> subprocess.CompletedProcess[str]:
    words = (str(ROOT / "setup" / "step.sh"), "[2/5] a step", str(folder / "log" / "step.log"), "bash", "-c", command)
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)


def package_path(workspace: Path, before: str) -> str:
    """Return ROS_PACKAGE_PATH as the hook of a workspace leaves it."""
    command = f'. "{ROOT / "env-hooks" / "20.robotteamsim.sh"}"; echo "$ROS_PACKAGE_PATH"'
    environment = {"CATKIN_ENV_HOOK_WORKSPACE": str(workspace), "ROS_PACKAGE_PATH": before, "PATH": "/usr/bin:/bin"}
    done = subprocess.run(("sh", "-c", command), env=environment, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.strip()


def test_step_shows_its_name_and_keeps_its_output_in_the_log(tmp_path):
    done = step(tmp_path, "echo quiet")
    assert done.returncode == 0
    assert done.stdout.startswith("-- [2/5] a step\n-- [2/5] a step: done after ")
    assert done.stderr == ""
    assert (tmp_path / "log" / "step.log").read_text(encoding="utf-8") == "quiet\n"


def test_failed_step_shows_the_end_of_its_log_and_names_it(tmp_path):
    done = step(tmp_path, "seq 100; exit 7")
    assert done.returncode == 7
    end, last = done.stderr.splitlines()[-2:]
    assert end == "100"
    assert last == f"-- [2/5] a step: failed; the whole log is {tmp_path / 'log' / 'step.log'}"
    assert "\n75\n" not in done.stderr


def test_wheel_does_not_install_what_tests_and_all_commands_need():
    plan = subprocess.run(("make", "-n", "wheel"), cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert "requirements.lock" not in plan
    assert "debian-test" not in plan
    assert 'step.sh "building the wheel"' in plan


def test_help_of_make_test_names_the_checks_that_it_leaves_out():
    lines = subprocess.run(("make", "help"), cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    (about_test,) = (line for line in lines if line.split()[:2] == ["make", "test"])
    for target in ("tidy", "fuzz", "sanitize", "faults", "garbage", "gazebo"):
        assert target in about_test.partition("not ")[2]


def test_hook_sets_the_package_path_where_ros_environment_is_missing(tmp_path):
    (tmp_path / ".catkin").write_text("/home/me/a;/home/me/b", encoding="utf-8")
    assert package_path(tmp_path, "") == "/home/me/a:/home/me/b:/usr/share"


def test_hook_changes_nothing_where_ros_environment_has_set_the_package_path(tmp_path):
    (tmp_path / ".catkin").write_text("/home/me/a", encoding="utf-8")
    assert package_path(tmp_path, "/home/me/a:/home/me/other:/usr/share") == "/home/me/a:/home/me/other:/usr/share"


def test_hook_of_an_installation_adds_its_share_folder(tmp_path):
    (tmp_path / ".catkin").touch()
    assert package_path(tmp_path, "/opt/share") == f"/opt/share:{tmp_path}/share:/usr/share"


@pytest.mark.slow
@pytest.mark.parametrize("line", ["[ 50%] Building", "  [10/20] Building"])
def test_long_step_shows_its_progress(tmp_path, line):
    done = step(tmp_path, f"echo '{line}'; sleep 11")
    assert re.search(r"^--   \[2/5\] a step: 50 %, 1\d s$", done.stdout, re.MULTILINE)


def test_a_folder_with_a_blank_is_refused_in_one_line(tmp_path):
    folder = tmp_path / "my projects"
    folder.mkdir()
    shutil.copy(ROOT / "Makefile", folder)
    done = subprocess.run(["make", "garage_sar"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert f"{folder}: catkin cannot build in a folder with a blank in its path; move this folder" in line

"""Every file and command of docs/tutorial_gazebo.md, as printed."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from running import GRACE_S, ROSCORE, TIMEOUT_S, Program, environment, running

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "tutorial_gazebo.md").read_text()
FILES = dict(re.findall(r"(?:Save|and) this as `([\w./]+\.(?:world|config|sdf))`.*?```xml\n(.*?)```", TEXT, re.DOTALL))
INSERTED = re.findall(r"before `</world>`.*?```xml\n(.*?)```", TEXT, re.DOTALL)
WHEELS = re.findall(r"in place of the line.*?```xml\n(.*?)```", TEXT, re.DOTALL)
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL) for line in block.splitlines()]
TOPICS = re.findall(r"```\n(/clock\n.*?)```", TEXT, re.DOTALL)

PATCH = re.search(r"```diff\n(.*?)```", TEXT, re.DOTALL)[1]

MOVES = """
import sys, rospy
from nav_msgs.msg import Odometry

rospy.init_node("moves", anonymous=True, disable_rostime=True)
for _ in range(2000):
    truth = rospy.wait_for_message(f"/{sys.argv[1]}/base_pose_ground_truth", Odometry, timeout=60.0)
    if truth.twist.twist.linear.x > 0.1:
        print("it moves")
        break
"""


def save(folder: Path, *inserted: str, wheels: bool = False) -> None:
    """Write all files, with further parts in the world."""
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    world = FILES["tutorial.world"].replace("  </world>", "".join(inserted) + "  </world>")
    if wheels:
        world = re.sub(r'.*filename="librobotteamsim_gazebo.so"/>\n', WHEELS[0], world, count=1)
    (folder / "tutorial.world").write_text(world)


@pytest.fixture
def master(tmp_path: Path) -> Iterator[Program]:
    with running((*ROSCORE,), tmp_path) as program:
        program.wait_for(lambda line: "started core service" in line, "a ROS master")
        yield program


@pytest.fixture
def in_first_terminal(monkeypatch: pytest.MonkeyPatch, gzserver: tuple[str, ...], tmp_path: Path) -> tuple[str, ...]:
    """Return the tutorial's command in the terminal that has Gazebo."""
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "models"))
    command = next(command for command in COMMANDS if command.startswith("gzserver"))
    return (*gzserver, *command.split()[1:])


def output(command: str, master: Program, folder: Path) -> str:
    """Return what a command of the second terminal prints."""
    env = environment(folder, master.port)
    return subprocess.run(
        command, shell=True, cwd=folder, env=env, check=True, timeout=TIMEOUT_S, capture_output=True, text=True
    ).stdout


def wait_until_robots_publish(master: Program, folder: Path, robot: str) -> None:
    output(f"rostopic echo -n 1 /{robot}/odom/header", master, folder)


def drive_by_keyboard(master: Program, folder: Path, command: str, robot: str) -> None:
    """Run the keyboard's node in a terminal, and hold the key for forward until the robot moves."""
    ours, its = pty.openpty()
    env = environment(folder, master.port)
    (folder / "moves.py").write_text(MOVES)
    node = subprocess.Popen(["bash", "-c", f"exec {command}"], cwd=folder, env=env, stdin=its, stdout=its, stderr=its)
    os.close(its)
    try:
        with running((sys.executable, "moves.py", robot), folder, master.port) as watcher:
            while watcher.process.poll() is None:
                os.write(ours, b"i")
                try:
                    watcher.process.wait(0.1)
                except subprocess.TimeoutExpired:
                    continue
            assert watcher.wait() == 0, watcher.output
            assert "it moves" in watcher.output
    finally:
        node.terminate()
        node.wait(GRACE_S)
        os.close(ours)


def test_empty_world_runs(in_first_terminal: tuple[str, ...], master: Program, tmp_path: Path) -> None:
    save(tmp_path)
    with running(in_first_terminal, tmp_path, master.port) as world:
        assert "clock" in output("rostopic echo -n 1 /clock/clock && echo clock", master, tmp_path)
        assert "Error" not in world.output


def test_robot_among_the_barriers_has_the_topics_and_range_of_the_text_and_obeys_the_keyboard(
    in_first_terminal: tuple[str, ...], master: Program, tmp_path: Path
) -> None:
    barriers, robot, _ = INSERTED
    save(tmp_path, barriers, robot)
    list_topics, echo, keyboard = (
        next(line for line in COMMANDS if line.startswith(start))
        for start in ("rostopic list", "rostopic echo", "roslaunch")
    )
    with running(in_first_terminal, tmp_path, master.port) as world:
        wait_until_robots_publish(master, tmp_path, "robot_0")
        assert output(list_topics, master, tmp_path) == TOPICS[0]
        assert float(output(echo, master, tmp_path).split()[0]) == pytest.approx(2.5, abs=0.01)
        drive_by_keyboard(master, tmp_path, keyboard, "robot_0")
        assert "Error" not in world.output


def test_second_robot_and_one_with_wheels_need_only_their_lines(
    in_first_terminal: tuple[str, ...], master: Program, tmp_path: Path
) -> None:
    save(tmp_path, *INSERTED, wheels=True)
    with running(in_first_terminal, tmp_path, master.port) as world:
        for number in range(2):
            robot = f"robot_{number}"
            wait_until_robots_publish(master, tmp_path, robot)
            drive_by_keyboard(master, tmp_path, f"roslaunch robotteamsim keyboard.launch robot:={number}", robot)
        assert "Error" not in world.output


def test_solution_of_the_homework_fits_the_plugin(tmp_path: Path) -> None:
    patch = tmp_path / "homework.patch"
    patch.write_text(PATCH)
    subprocess.run(["git", "apply", "--check", str(patch)], cwd=ROOT, check=True)

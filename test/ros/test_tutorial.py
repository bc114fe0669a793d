"""Every file and command of docs/tutorial.md, as printed."""

from __future__ import annotations

import json
import os
import pty
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from running import GRACE_S, ROSLAUNCH, TIMEOUT_S, Program, running

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "tutorial.md").read_text()
FILES = re.findall(r"```yaml\n(.*?)```", TEXT, re.DOTALL)
BLOCKS = re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL)
COMMANDS = [line for block in BLOCKS if "catkin_make" not in block for line in block.splitlines()]
"""Without those for the node in C++, which test_templates.py runs."""
LAUNCHES = [command for command in COMMANDS if " scenario.launch" in command]

SPEED = """
import rospy
from nav_msgs.msg import Odometry

rospy.init_node("speed", anonymous=True, disable_rostime=True)
for _ in range(2000):
    truth = rospy.wait_for_message("/robot_0/base_pose_ground_truth", Odometry, timeout=60.0)
    if truth.twist.twist.linear.x > 0.1:
        print("it moves")
        break
"""


LOCATE = """
import rospy
import tf2_ros

rospy.init_node("locate", anonymous=True, disable_rostime=True)
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer)
print(buffer.lookup_transform("map", "robot_0/base_laser_link", rospy.Time(), rospy.Duration(60.0)))
"""

SEE = "rostopic echo -n 1 --noarr /scene/robots"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of steps 1 to 7, with the package's commands on the path."""
    (tmp_path / "plan.yaml").write_text(FILES[0])
    (tmp_path / "arena.yaml").write_text(FILES[1])
    (tmp_path / "speed.py").write_text(SPEED)
    (tmp_path / "locate.py").write_text(LOCATE)
    for name in ("my_node.py", "careful_driver.py"):
        shutil.copy(ROOT / "templates" / "controller" / name, tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    return tmp_path


def at_master(program: Program, command: str) -> tuple[str, ...]:
    return "env", f"ROS_MASTER_URI=http://localhost:{program.port}", "bash", "-c", f"exec env {command}"


def assert_it_moves(world: Program, folder: Path) -> None:
    with running(at_master(world, f"{sys.executable} speed.py"), folder) as watcher:
        assert watcher.wait() == 0, watcher.output
        assert "it moves" in watcher.output


def put_back(world: Program, folder: Path) -> None:
    """Put the robot where it started: on a busy machine it may have driven to a barrier meanwhile."""
    with running(at_master(world, "rosservice call /reset_positions"), folder) as program:
        assert program.wait() == 0, program.output


def drive_by_keyboard(world: Program, folder: Path, command: str) -> None:
    """Run the keyboard's node in a terminal, hold the key for forward until the robot moves, then press Ctrl-C."""
    ours, its = pty.openpty()
    env = os.environ | {"ROS_MASTER_URI": f"http://localhost:{world.port}", "ROS_HOME": str(folder / "home")}
    node = subprocess.Popen(
        ["bash", "-c", f"exec env {command}"], cwd=folder, env=env, stdin=its, stdout=its, stderr=its
    )
    os.close(its)
    try:
        with running(at_master(world, f"{sys.executable} speed.py"), folder) as watcher:
            while watcher.process.poll() is None:
                os.write(ours, b"i")
                try:
                    watcher.process.wait(0.1)
                except subprocess.TimeoutExpired:
                    continue
            assert watcher.wait() == 0, watcher.output
            assert "it moves" in watcher.output
        node.send_signal(signal.SIGINT)
        assert node.wait(TIMEOUT_S) == 0
    finally:
        node.kill()
        node.wait(GRACE_S)
        os.close(ours)


def test_commands_of_the_tutorial_are_those_that_are_tested_here():
    kinds = [command.replace("ROS_NAMESPACE=robot_0 ", "").split()[:2] for command in COMMANDS]
    assert kinds == [
        ["robotteamsim", "plan"],
        ["robotteamsim", "scenario"],
        ["robotteamsim", "scenario"],
        ["roslaunch", "robotteamsim"],
        ["rostopic", "list"],
        ["rostopic", "echo"],
        ["rostopic", "pub"],
        ["roslaunch", "robotteamsim"],
        ["roslaunch", "robotteamsim"],
        ["python3", "my_node.py"],
        ["python3", "careful_driver.py"],
        ["roslaunch", "robotteamsim"],
        ["robotteamsim", "run"],
        ["roslaunch", "robotteamsim"],
    ]


def test_files_are_checked_and_drawn(folder):
    for command in COMMANDS[:3]:
        subprocess.run(command, shell=True, cwd=folder, check=True, capture_output=True)
    assert (folder / "plan.png").stat().st_size > 1000


def test_misspelt_key_is_reported_as_printed(folder):
    (message,) = re.findall(r"^robotteamsim: .*$", TEXT, re.MULTILINE)
    (folder / "arena.yaml").write_text(FILES[1].replace("beams", "beems"))
    checked = subprocess.run(COMMANDS[1], shell=True, cwd=folder, capture_output=True, text=True, check=False)
    assert checked.returncode == 2
    assert checked.stderr.strip() == message


def test_robot_is_driven_by_command_keyboard_and_nodes(folder):
    topics, scan, publish, keyboard, view, my_node, careful, careful_keyboard = COMMANDS[4:12]
    short = "set:=mission.time_limit_s=2"  # the launch outlives the mission
    with running((*ROSLAUNCH, *LAUNCHES[0].split()[1:], short), folder) as world:
        world.wait_for(lambda line: "mission ends" in line, "the end of the mission")
        for command, expected in ((scan, "range_max: 5.0"), (topics, "/robot_0/base_scan")):
            with running(at_master(world, command), folder) as program:
                assert program.wait() == 0, program.output
                assert expected in program.output
        with running(at_master(world, f"{sys.executable} locate.py"), folder) as program:
            assert program.wait() == 0, program.output  # otherwise rviz shows no laser
        with running(at_master(world, view), folder), running(at_master(world, SEE), folder) as program:
            assert program.wait() == 0, program.output
        for command in (publish, my_node):
            put_back(world, folder)
            with running(at_master(world, command.replace("python3", sys.executable)), folder):
                assert_it_moves(world, folder)
        put_back(world, folder)
        drive_by_keyboard(world, folder, keyboard)
        put_back(world, folder)
        with running(at_master(world, careful.replace("python3", sys.executable)), folder):
            drive_by_keyboard(world, folder, careful_keyboard)


def test_mission_has_the_same_result_headless_and_in_ros(folder):
    (folder / "arena.yaml").write_text(FILES[1] + FILES[2])
    headless = subprocess.run(f"{COMMANDS[12]} --json", shell=True, cwd=folder, check=True, capture_output=True)
    with running((*ROSLAUNCH, *LAUNCHES[1].split()[1:], "out:=out"), folder) as program:
        assert program.wait() == 0, program.output
    in_ros = json.loads((folder / "out" / "mission.json").read_text())["result"]
    assert in_ros["trajectory_hash"] == json.loads(headless.stdout)["trajectory_hash"]
    assert in_ros["victims_saved"] == 1

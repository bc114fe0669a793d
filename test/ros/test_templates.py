"""The homework of the tutorial in Python and in C++: built and started as printed, and driven towards a wall."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from running import ROSLAUNCH, running

ROOT = Path(__file__).parents[2]
TEMPLATES = ROOT / "templates"
(IN_CPP,) = re.findall(r"```sh\n(mkdir.*?)```", (ROOT / "docs" / "tutorial.md").read_text(), re.DOTALL)
*BUILD, SOURCE, START = IN_CPP.splitlines()

DRIVE = """
import math

import rospy
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

rospy.init_node("driver", disable_rostime=True)
commands, speeds, nearest = [], [], []
rospy.Subscriber("cmd_vel", Twist, lambda message: commands.append(message.linear.x))
rospy.Subscriber("base_pose_ground_truth", Odometry, lambda message: speeds.append(message.twist.twist.linear.x))
rospy.Subscriber("base_scan", LaserScan, lambda message: nearest.append(min(message.ranges)))
wanted = rospy.Publisher("wanted_vel", Twist, queue_size=1)


def stands_at_the_wall():
    return 0.25 in commands and commands[-1] == 0.0 and abs(speeds[-1]) < 1e-6


def drive(speed_mps, is_done):
    for _ in range(6000):
        wanted.publish(Twist(linear=Vector3(speed_mps, 0.0, 0.0)))
        rospy.rostime.wallsleep(0.02)
        if commands and speeds and nearest and is_done():
            return


drive(0.5, stands_at_the_wall)
print("commands", sorted(set(commands)), "nearest", round(nearest[-1], 3))
drive(-0.4, lambda: speeds[-1] < -0.1 and commands[-1] < 0.0)
print("backs away at", commands[-1])
drive(-0.4, lambda: nearest[-1] > 0.6)
drive(0.5, lambda: nearest[-1] < 0.35 and speeds[-1] > 0.2)
for _ in range(3000):  # without a command
    rospy.rostime.wallsleep(0.02)
    if abs(speeds[-1]) < 1e-6:
        break
print("without commands, stops at", round(nearest[-1], 3))
"""


WATCH = """
import rospy
from geometry_msgs.msg import Twist

rospy.init_node("watcher", disable_rostime=True)
print("drives at", rospy.wait_for_message("/robot_0/cmd_vel", Twist, timeout=120.0).linear.x)
"""


def test_new_package_is_built_and_started_by_catkin(tmp_path):
    (tmp_path / "ws" / "src").mkdir(parents=True)
    new = "cd ws/src && robotteamsim new package wanderer && cd .. && catkin_make -DPYTHON_EXECUTABLE=/usr/bin/python3"
    done = subprocess.run(("bash", "-c", new), cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "watch.py").write_text(WATCH)
    start = "source ws/devel/setup.bash && exec roslaunch -p ${ROS_MASTER_URI##*:} wanderer wanderer.launch"
    with running(("bash", "-c", start), tmp_path) as program:
        program.wait_for(lambda line: "process[robot_0/wanderer" in line, "the start of the node")
        with running((sys.executable, "watch.py"), tmp_path, program.port) as watcher:
            assert watcher.wait() == 0, watcher.output + program.output
    assert "drives at 0.4" in watcher.output


@pytest.fixture(scope="module")
def cpp_driver(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder in which the C++ template is built."""
    folder = tmp_path_factory.mktemp("cpp_controller")
    for command in BUILD:
        done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.parametrize("language", ["python", "cpp"])
def test_careful_driver_halves_the_speed_and_stops_before_the_wall(language, tmp_path, request):
    command: Sequence[str] = (sys.executable, str(TEMPLATES / "controller" / "careful_driver.py"))
    if language == "cpp":
        command = ("bash", "-c", f"cd {request.getfixturevalue('cpp_driver')}; {SOURCE}; exec env {START}")
    (tmp_path / "drive.py").write_text(DRIVE)
    world = (*ROSLAUNCH, "robotteamsim", "world.launch", "scenario:=tutorial_arena")
    with running(world, tmp_path) as program:
        program.wait_for(lambda line: "process[simulation" in line, "the start of the simulation")
        shared = ("env", f"ROS_MASTER_URI=http://localhost:{program.port}", "ROS_NAMESPACE=robot_0")
        with running((*shared, *command), tmp_path), running((*shared, sys.executable, "drive.py"), tmp_path) as driver:
            assert driver.wait() == 0, driver.output
    assert "commands [0.0, 0.25, 0.5]" in driver.output, driver.output
    assert "backs away at -0.2" in driver.output, driver.output
    near_m = [float(text) for text in re.findall(r"(?:nearest|stops at) (\S+)", driver.output)]
    assert len(near_m) == 2
    assert all(0.2 < nearest_m < 0.3 for nearest_m in near_m), near_m

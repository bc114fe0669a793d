"""The controller of docs/ros2.md as a node of rclpy drives a robot."""

from __future__ import annotations

import sys
from pathlib import Path

from peer import MISSION
from running import running

ROOT = Path(__file__).parents[2]
TEMPLATE = ROOT / "templates" / "controller" / "my_node_ros2.py"


def test_own_node_drives_forward_and_turns_away_from_walls(tmp_path, peer):
    arena = (*MISSION, "tutorial_arena", "--controllers", "none", "--speed", "10")
    own = (sys.executable, str(TEMPLATE), "--ros-args", "-r", "__ns:=/robot_0")
    with running(arena, tmp_path) as mission, running(own, tmp_path):
        truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry")
        scans = peer.listen("/robot_0/base_scan", "sensor_msgs/LaserScan")
        peer.wait_until(lambda: truth and truth[-1].twist.twist.linear.x > 0.39, "driving")
        peer.wait_until(lambda: truth[-1].twist.twist.angular.z > 0.9, "turning")
        assert min(min(scan.ranges) for scan in scans) > 0.2
    assert "Traceback" not in mission.output


def test_documentation_prints_the_template():
    assert TEMPLATE.read_text() in (ROOT / "docs" / "ros2.md").read_text()

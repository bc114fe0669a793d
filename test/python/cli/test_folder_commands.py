"""`analyse` and `view` take folders of `ros2 bag record` and chosen odometry."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer

from robotteamsim.cli import main
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.recording.bag_types import ROS2, bag_typestore, message_type
from robotteamsim.recording.topics import robots
from robotteamsim.sensing.readings import OdometryReading


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A robot drives 2 m in 2 s by its wheels, and 4 m by its camera."""
    path = tmp_path / "rosbag2"
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as bag:
        for topic, step_m in (("/robot1/wheels", 0.1), ("/robot1/camera", 0.2)):
            connection = bag.add_connection(topic, "nav_msgs/msg/Odometry", typestore=bag_typestore(ROS2))
            for step in range(21):
                reading = OdometryReading(PoseReading(step * step_m, 0.0, 0.0, 1.0), Twist())
                message = robots.odometry(10**9 + step * 10**8, 0, reading)
                data = message_type("nav_msgs/Odometry", ROS2).encode(message)
                bag.write(connection, 10**9 + step * 10**8, data)
    return path


def test_analyse_takes_a_folder_and_the_odometry_of_a_robot(capsys, folder, monkeypatch):
    assert main(["analyse", str(folder)]) == 2
    assert "several odometries of a robot; choose with --odometry" in capsys.readouterr().err
    monkeypatch.chdir(folder)
    assert main(["analyse", ".", "--odometry", "/robot1/camera", "--json", "-"]) == 0
    (totals,) = json.loads(capsys.readouterr().out)["bags"]
    assert totals["bag"] == "rosbag2"
    assert [(robot["name"], round(robot["distance_m"], 9)) for robot in totals["robots"]] == [("robot1", 4.0)]


def test_files_of_a_folder_are_not_overwritten(capsys, folder):
    for command in ("analyse", "view"):
        option = "--json" if command == "analyse" else "--html"
        out = str(folder / "metadata.yaml")
        assert main([command, str(folder), "--odometry", "/robot1/camera", option, out]) == 2
        assert "would overwrite a file that this command reads" in capsys.readouterr().err


def test_view_writes_the_page_of_a_folder(folder, tmp_path):
    page = tmp_path / "page.html"
    assert main(["view", str(folder), "--odometry", "/robot1/wheels", "--html", str(page)]) == 0
    assert "rosbag2" in page.read_text(encoding="utf-8")


def test_odometry_is_for_bags_only(capsys):
    assert main(["view", "garage_sar", "--odometry", "/odom", "--html", "x.html"]) == 2
    assert "--odometry /odom: only allowed for bags; got garage_sar" in capsys.readouterr().err

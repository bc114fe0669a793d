"""The launch files of ROS 2 and the view for rviz2, with stand-ins for `launch`, which has no wheel."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
import types
from pathlib import Path

import pytest
import yaml

from robotteamsim import palette

ROOT = Path(__file__).parents[3]


class Action:
    """Keeps what an action or a substitution of `launch` is made of."""

    def __init__(self, *values, **named):
        self.values, self.named = values, named


class LaunchConfiguration(Action):
    def perform(self, context):
        return context[self.values[0]]


@pytest.fixture(autouse=True)
def launch(monkeypatch):
    """Modules with the names that the launch files import."""
    names = {
        "launch": ("LaunchDescription",),
        "launch.actions": (
            *("DeclareLaunchArgument", "ExecuteProcess", "IncludeLaunchDescription", "OpaqueFunction", "Shutdown"),
        ),
        "launch.launch_description_sources": ("PythonLaunchDescriptionSource",),
        "launch.substitutions": ("LaunchConfiguration",),
    }
    for name, classes in names.items():
        module = types.ModuleType(name)
        for one in classes:
            setattr(module, one, LaunchConfiguration if one == "LaunchConfiguration" else type(one, (Action,), {}))
        monkeypatch.setitem(sys.modules, name, module)


def described(name):
    (actions,) = runpy.run_path(str(ROOT / "launch" / name))["generate_launch_description"]().values
    return actions


def mission(**arguments):
    """Return the default of each argument of mission.launch.py, and the command that it runs with some arguments."""
    *declared, opaque = described("mission.launch.py")
    defaults = {one.values[0]: one.named["default_value"] for one in declared}
    assert arguments.keys() <= defaults.keys()
    (process,) = opaque.named["function"](defaults | arguments)
    return defaults, process.named["cmd"]


def test_arguments_are_the_options_of_the_starter():
    defaults, _ = mission()
    shown = subprocess.run(
        (sys.executable, "-m", "robotteamsim.ros2", "-h"), capture_output=True, text=True, check=True
    )
    options = set(re.findall(r"^ +(?:-h, )?--([a-z-]+)", shown.stdout, re.MULTILINE)) - {"help"}
    assert {name.replace("_", "-") for name in defaults} == options | {"scenario", "ros-args"}


@pytest.mark.parametrize(
    "arguments",
    [
        {},
        {"scenario": "tutorial_arena", "robots": "2", "seed": "7", "speed": "0", "teleop": "0", "out": "there"},
        {"set": "voice.noise_db=20 run.step_s=0.2", "controllers": "none", "localization": "none"},
        {"lockstep": "true", "stays": "True", "paused": "true", "allow_code": "true"},
        {"ros_args": "-p stamped_cmd_vel:=true"},
    ],
)
def test_starter_accepts_all_arguments(arguments):
    _, command = mission(**arguments)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "has no rclpy" in done.stderr, done.stderr  # its arguments are read before
    given = [value for key, value in arguments.items() if key not in ("set", "ros_args") and value.lower() != "true"]
    assert all(any(part.endswith(value) for part in command) for value in given)


def test_garage_is_the_default_mission():
    (include,) = described("garage_sar.launch.py")
    (source,) = include.values
    assert Path(source.values[0]) == ROOT / "launch" / "mission.launch.py"
    assert mission()[0]["scenario"] == "garage_sar"


def test_rviz2_shows_what_rviz_shows():
    files = [ROOT / "rviz" / name for name in ("robotteamsim.rviz", "robotteamsim_ros2.rviz")]
    views = [yaml.safe_load(file.read_text())["Visualization Manager"] for file in files]
    assert len({view["Global Options"]["Background Color"] for view in views}) == 1
    old, new = (view["Displays"] for view in views)
    kinds = [(one["Class"].partition("/")[2], one["Name"], one["Enabled"]) for one in new]
    assert kinds[: len(old)] == [(one["Class"].partition("/")[2], one["Name"], one["Enabled"]) for one in old]
    topics = [one["Topic"]["Value"] for one in new if "Topic" in one]
    wanted = [topic for one in old if (topic := one.get("Marker Topic") or one.get("Topic"))]
    beliefs = [f"/robot_{i}/{name}" for i in range(3) for name in ("map", "particlecloud", "amcl_pose")]
    assert topics == [*wanted, *(f"/robot_{i}/base_scan" for i in range(3)), *beliefs]
    for display in new[len(old) :]:
        colour = [round(255.0 * part) for part in palette.rgb(palette.robot_colour(int(display["Name"][-1])))]
        assert display.get("Color") == (None if "Map" in display["Name"] else "; ".join(map(str, colour)))

"""The mission of any scenario: ros2 launch robotteamsim mission.launch.py scenario:=tutorial_arena speed:=2

The arguments are the options of `python3 -m robotteamsim.ros2`, which --help describes. Blanks separate those of `set`.
"""

import sys

from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration

from launch import LaunchDescription

VALUES = {
    "robots": "",
    "seed": "",
    "speed": "5",
    "controllers": "nodes",
    "localization": "ground_truth",
    "teleop": "",
    "out": "",
}
SWITCHES = ("lockstep", "stays", "paused", "allow_code")


def generate_launch_description():
    """Return what `ros2 launch` runs; it ends with the mission."""
    defaults = {"scenario": "garage_sar", "set": "", "ros_args": "", **VALUES, **dict.fromkeys(SWITCHES, "false")}
    arguments = [DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()]
    return LaunchDescription([*arguments, OpaqueFunction(function=_mission)])


def _mission(context):
    def value(name):
        return LaunchConfiguration(name).perform(context)

    command = [sys.executable, "-m", "robotteamsim.ros2", value("scenario")]
    command += [f"--{name}={value(name)}" for name in VALUES if value(name)]
    command += [f"--set={override}" for override in value("set").split()]
    command += [f"--{name.replace('_', '-')}" for name in SWITCHES if value(name).lower() == "true"]
    command += ["--ros-args", *value("ros_args").split()]
    return [ExecuteProcess(cmd=command, output="screen", on_exit=Shutdown(reason="the mission has ended"))]

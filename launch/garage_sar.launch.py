"""The garage mission: ros2 launch robotteamsim garage_sar.launch.py seed:=7 lockstep:=true"""

from pathlib import Path

from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

from launch import LaunchDescription


def generate_launch_description():
    """Return mission.launch.py, whose default scenario is this one; it has the same arguments."""
    mission = str(Path(__file__).with_name("mission.launch.py"))
    return LaunchDescription([IncludeLaunchDescription(PythonLaunchDescriptionSource(mission))])

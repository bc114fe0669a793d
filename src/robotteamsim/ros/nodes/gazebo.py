"""The node `gazebo`: writes the scenario as a world of Gazebo and becomes gzserver, whose plugins are the world."""

import logging
import os
import shlex
import shutil
import time
from pathlib import Path
from typing import get_args

import rospkg
import rospy

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.gazebo import export_world
from robotteamsim.gazebo.robots import DriveKind
from robotteamsim.message_parts import robot_name
from robotteamsim.nodes.settings import Settings, read_settings
from robotteamsim.recording.files import write_atomically
from robotteamsim.ros.node import ParameterError, parameter, run, wait_for_shutdown
from robotteamsim.ros.ros1 import Ros1Node

logger = logging.getLogger(__name__)

START_TIMEOUT_S = 60.0
"""Gazebo starts without controllers that have not started after this time [s, wall]."""
CHECK_PERIOD_S = 0.2
"""Interval of checks for controllers [s, wall]."""

PLUGINS = ("librobotteamsim_gazebo.so", "librobotteamsim_gazebo_world.so")


class GazeboError(RobotTeamSimError):
    """Gazebo or its plugins are not installed."""


def main() -> None:
    """Run the node; the process then is gzserver."""
    commands: list[list[str]] = []
    run("gazebo", lambda: commands.append(_prepare()))
    for command in commands:
        os.execvp(command[0], command)


def _prepare() -> list[str]:
    """Write the world, wait for the controllers, and return the command that runs the world."""
    settings = read_settings(Ros1Node())
    _check(settings)
    drive = parameter("~drive", "velocity")
    if drive not in get_args(DriveKind):
        raise ParameterError(f"~drive: {drive!r}; expected {' or '.join(get_args(DriveKind))}")
    program = shlex.split(parameter("~gzserver", "gzserver"))
    if not program or shutil.which(program[0]) is None:
        raise GazeboError(
            f"~gzserver: {' '.join(program)!r} is not installed; install Gazebo 11 (Debian 11: gazebo, Ubuntu 20.04:"
            " gazebo11), or see docs/gazebo_missions.md for other systems"
        )
    _find_plugins(parameter("~plugins", ""))
    # Inherited by gzserver. Otherwise it looks for models on the internet.
    os.environ.setdefault("GAZEBO_MODEL_DATABASE_URI", "")
    world = _write_world(settings, drive)
    _wait_for_controllers(settings)
    return [*program, "--verbose", str(world)]


def _check(settings: Settings) -> None:
    """Reject what Gazebo's world cannot do. Raises: ParameterError."""
    scenario = settings.scenario
    if parameter("~follow_clock", False):
        return  # our own world runs next to it
    for what, is_used in (("fire", scenario.fire is not None), ("people who move", scenario.moves_people)):
        if is_used:
            raise ParameterError(f"{scenario.name}: Gazebo's world has no {what}; expected world:=true")
    if any(event.kind in ("remove", "spawn", "take_passage", "door", "light") for event in scenario.schedule):
        logger.warning(
            "schedule: its robots, passages, doors and lights are left out, because Gazebo's world has no schedule"
        )


def _find_plugins(folder: str) -> None:
    """Add the folder of the plugins to gzserver's path, or find them there. Raises: GazeboError."""
    path = os.environ.get("GAZEBO_PLUGIN_PATH", "")
    built = [f"{prefix}/lib" for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(":")]
    folders = [folder] if folder else [*path.split(":"), *built]
    for candidate in folders:
        if all((Path(candidate) / plugin).is_file() for plugin in PLUGINS):
            os.environ["GAZEBO_PLUGIN_PATH"] = f"{candidate}:{path}"
            return
    raise GazeboError(
        f"{PLUGINS[0]} is not in {', '.join(filter(None, folders))}; build this package where libgazebo-dev is"
        " installed, or set plugins:= to the folder of the plugins"
    )


def _write_world(settings: Settings, drive: DriveKind) -> Path:
    export = export_world(settings.setup, drive)
    for note in export.notes:
        logger.warning("%s", note)
    folder = Path(rospkg.get_ros_home())
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"robotteamsim_{settings.scenario.name}.world"
    write_atomically(path, export.text)
    logger.info("Gazebo's world is %s", path)
    return path


def _wait_for_controllers(settings: Settings) -> None:
    """Wait until simulation and controllers have started: simulated time begins when Gazebo starts."""
    deadline_s = time.monotonic() + START_TIMEOUT_S
    wanted = {f"/{robot_name(robot_id)}/cmd_vel_stamped" for robot_id in settings.controlled}
    wanted.add("/mission/status")
    while missing := wanted - {name for name, _ in rospy.get_published_topics()}:
        if time.monotonic() > deadline_s:
            logger.warning("starting without %s", ", ".join(sorted(missing)))
            return
        if wait_for_shutdown(CHECK_PERIOD_S):
            return

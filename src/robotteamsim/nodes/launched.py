"""The scenario and the domain of a launch, for nodes and for what starts them, before it imports rospy."""

import os
import tempfile
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from robotteamsim.nodes.node import ParameterError
from robotteamsim.scenario import Scenario, load
from robotteamsim.scenario.sections import Team

NOT_SET = -1
"""Default for the number of robots, and for the id of the one driven by hand: not given."""


def ros1_setting_name(key: str) -> str:
    """Return the parameter of a setting in ROS 1, where one server has the parameters of all nodes."""
    return f"/robotteamsim/{key}"


def read_scenario(setting: Callable[[str, Any], Any], setting_name: Callable[[str], str] = str) -> Scenario:
    """Return the scenario of a launch.

    Args:   setting, setting_name: as of a `Node`.
    Raises: ParameterError, ScenarioError.
    """
    name = setting("scenario", "")
    if not name:
        raise ParameterError(f"{setting_name('scenario')}: is not set; expected the name or file of a scenario")
    text = setting("set", "")
    # Blanks separate them in launch files; lines do it where values may have blanks.
    overrides = text.splitlines() if "\n" in text else text.split()
    scenario = load(name, overrides)
    num_robots = setting("robots", NOT_SET)
    if num_robots in (NOT_SET, scenario.num_robots):
        return scenario
    if isinstance(scenario.robots, Team):
        return load(name, [*overrides, f"robots.count={num_robots}"])
    expected = f"expected {scenario.num_robots}, the length of the robots' list in {name}"
    raise ParameterError(f"{setting_name('robots')}: {num_robots}; {expected}")


def read_ros1_scenario(parameter: Callable[[str, Any], Any]) -> Scenario:
    """Return the scenario of a launch of ROS 1. Args: parameter: returns one, by its name and default.

    Raises: ParameterError, ScenarioError.
    """
    return read_scenario(lambda key, default: parameter(ros1_setting_name(key), default), ros1_setting_name)


def lock_domain(domain: int) -> AbstractContextManager[object]:
    """Lock a domain for the simulations of this machine, whose topics would mix. Raises: ParameterError."""
    path = Path(tempfile.gettempdir(), f"robotteamsim-{os.getuid()}-domain-{domain}.lock")
    try:
        return FileLock(path, timeout=0).acquire()
    except Timeout:
        raise ParameterError(
            f"ROS_DOMAIN_ID: {domain}; another simulation runs in it; expected another domain"
        ) from None

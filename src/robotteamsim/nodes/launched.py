"""The scenario of a launch, for nodes and for what starts them, before it imports rospy."""

from collections.abc import Callable
from typing import Any

from robotteamsim.nodes.node import ParameterError
from robotteamsim.scenario import Scenario, load
from robotteamsim.scenario.sections import Team

NOT_SET = -1
"""Default for the number of robots, and for the id of the one driven by hand: not given."""


def ros1_setting(key: str) -> str:
    """Return the name of the parameter of a setting in ROS 1, where one server has the parameters of all nodes."""
    return f"/robotteamsim/{key}"


def read_scenario(parameter: Callable[[str, Any], Any], setting: Callable[[str], str] = ros1_setting) -> Scenario:
    """Return the scenario of a launch.

    Args:   parameter: returns a parameter, by its name and default.
            setting:   returns the name of the parameter of a setting, as `Node.setting`.
    Raises: ParameterError, ScenarioError.
    """
    name = parameter(setting("scenario"), "")
    if not name:
        raise ParameterError(f"{setting('scenario')}: is not set; expected the name or file of a scenario")
    text = parameter(setting("set"), "")
    # Blanks separate them in launch files; lines do it where values may have blanks.
    overrides = text.splitlines() if "\n" in text else text.split()
    scenario = load(name, overrides)
    num_robots = parameter(setting("robots"), NOT_SET)
    if num_robots in (NOT_SET, scenario.num_robots):
        return scenario
    if isinstance(scenario.robots, Team):
        return load(name, [*overrides, f"robots.count={num_robots}"])
    raise ParameterError(
        f"{setting('robots')}: {num_robots}; expected {scenario.num_robots}, the length of the robots' list in {name}"
    )

"""The scenario of a launch, for nodes and for what starts them, before it imports rospy."""

from collections.abc import Callable
from typing import Any

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.scenario import Scenario, load
from robotteamsim.scenario.sections import Team

PARAMETERS = "/robotteamsim"
"""Namespace of the parameters that all nodes read."""
NOT_SET = -1
"""Default for the number of robots, and for the id of the one driven by hand: not given."""


class ParameterError(RobotTeamSimError):
    """A parameter of a node is missing or wrong."""


def read_scenario(parameter: Callable[[str, Any], Any]) -> Scenario:
    """Return the scenario. Args: parameter: returns a parameter, by its name and default.

    Raises: ParameterError, ScenarioError.
    """
    name = parameter(f"{PARAMETERS}/scenario", "")
    if not name:
        raise ParameterError(f"{PARAMETERS}/scenario: is not set; expected the name or file of a scenario")
    overrides = parameter(f"{PARAMETERS}/set", "").split()
    scenario = load(name, overrides)
    num_robots = parameter(f"{PARAMETERS}/robots", NOT_SET)
    if num_robots in (NOT_SET, scenario.num_robots):
        return scenario
    if isinstance(scenario.robots, Team):
        return load(name, [*overrides, f"robots.count={num_robots}"])
    raise ParameterError(
        f"{PARAMETERS}/robots: {num_robots}; expected {scenario.num_robots}, the length of the robots' list in {name}"
    )

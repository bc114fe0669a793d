"""Controllers: one robot's observation and messages in, twist and messages out."""

from collections.abc import Callable

from robotteamsim.control.controller import Controller, Decision, Task
from robotteamsim.control.rdpso import RdpsoController
from robotteamsim.control.wander import WanderController
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.scenario import Scenario

ALGORITHMS: dict[str, Callable[[int, Scenario], Controller]] = {"rdpso": RdpsoController, "wander": WanderController}
"""The controllers by the name that `control.algorithm` gives."""


def make_controller(robot_id: int, scenario: Scenario) -> Controller:
    """Return the controller of one robot, as `control.algorithm` names it.

    Raises: ScenarioError: there is no such algorithm, or no such robot.
    """
    name = scenario.control.algorithm
    if name not in ALGORITHMS:
        choices = ", ".join(ALGORITHMS)
        raise ScenarioError(f"{scenario.name}: control.algorithm: '{name}' is not known; wanted one of: {choices}")
    return ALGORITHMS[name](robot_id, scenario)


__all__ = ["ALGORITHMS", "Controller", "Decision", "RdpsoController", "Task", "WanderController", "make_controller"]

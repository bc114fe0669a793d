"""Controllers by the name that `control.algorithm` gives: ours, those of installed packages, any class by its place."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points

from robotteamsim.control.baselines.greedy import GreedyController
from robotteamsim.control.baselines.pso import DpsoController, PsoController, RpsoController
from robotteamsim.control.baselines.random_walk import RandomWalkController
from robotteamsim.control.baselines.sebs import SebsController
from robotteamsim.control.cover.controller import CoverController
from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.runtime.base_station import with_base
from robotteamsim.errors import RobotTeamSimError, ScenarioError
from robotteamsim.interface import Controller
from robotteamsim.scenario.scenario import Scenario

MakeController = Callable[..., Controller]
"""A controller class, or anything else that makes the controller of one robot from its id and the scenario.

Where it takes `arrival` as well, it is told by that how often the robot has come, its start included.
"""

ALGORITHMS: dict[str, MakeController] = {
    "rdpso": RdpsoController,
    "random_walk": RandomWalkController,
    "greedy": GreedyController,
    "pso": PsoController,
    "dpso": DpsoController,
    "rpso": RpsoController,
    "sebs": SebsController,
    "cover": CoverController,
}
"""The controllers of this package."""

ENTRY_POINTS = "robotteamsim.controllers"
"""The group of entry points by which other packages offer theirs."""


def make_controller(robot_id: int, scenario: Scenario, arrival: int = 1) -> Controller:
    """Return the controller of one robot that has come so often, as `control.algorithm` names it.

    The name is one of ALGORITHMS, or of an entry point of the group `robotteamsim.controllers`, or `module:Class`.
    Where there is a base, robots report to it what they find, see `finds.with_base`.
    Raises: ScenarioError: there is no such algorithm, it cannot be imported or is no controller; no such robot.
            Whatever the constructor of a controller of somebody else raises.
    """
    name = scenario.control.algorithm
    try:
        make = _find(name)
    except _NotFoundError as error:
        raise ScenarioError(f"{scenario.name}: control.algorithm: {error}") from None
    made = make(robot_id, scenario, **({"arrival": arrival} if _takes_arrival(make) else {}))
    missing = [method for method in ("observe", "decide") if not callable(getattr(made, method, None))]
    if missing:
        raise ScenarioError(
            f"{scenario.name}: control.algorithm: '{name}' makes a {type(made).__name__}, which has no "
            f"{' and no '.join(missing)}"
        )
    return made if scenario.mission.base is None else with_base(made, robot_id, scenario)


def algorithm_names() -> list[str]:
    """Return the names that are known: this package's, then those of installed packages, sorted."""
    return [*ALGORITHMS, *sorted({point.name for point in entry_points(group=ENTRY_POINTS)} - set(ALGORITHMS))]


def _takes_arrival(make: MakeController) -> bool:
    try:
        return "arrival" in inspect.signature(make).parameters
    except ValueError:  # a class of an extension may tell nothing
        return False


class _NotFoundError(RobotTeamSimError):
    """There is no controller of that name."""


def _find(name: str) -> MakeController:
    if name in ALGORITHMS:
        return ALGORITHMS[name]
    for point in entry_points(group=ENTRY_POINTS):
        if point.name == name:
            return _loaded(name, point)
    module, colon, attribute = name.partition(":")
    if colon and module and attribute:
        return _loaded(name, EntryPoint(name, name, ENTRY_POINTS))
    raise _NotFoundError(f"'{name}' is not known; wanted one of: {', '.join(algorithm_names())}, or module:Class")


def _loaded(name: str, point: EntryPoint) -> MakeController:
    try:
        # Files that came since the last import would not be seen otherwise.
        importlib.invalidate_caches()
        found = point.load()
    except Exception as error:  # Whatever the user's module raises is one line to him.
        raise _NotFoundError(f"'{name}': {type(error).__name__}: {error}") from None
    if not callable(found):
        raise _NotFoundError(f"'{name}' is {found!r:.40}; wanted a class")
    made: MakeController = found
    return made

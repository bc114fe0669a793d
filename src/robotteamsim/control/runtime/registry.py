"""Controllers by the name in `control.algorithm`: ours, those of installed packages, and any `module:Class`."""

import importlib
import inspect
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points

from robotteamsim.control.baselines.boustrophedon import BoustrophedonController
from robotteamsim.control.baselines.conscientious import ConscientiousReactiveController
from robotteamsim.control.baselines.greedy import GreedyController
from robotteamsim.control.baselines.infotaxis import InfotaxisController
from robotteamsim.control.baselines.pso import DpsoController, PsoController, RpsoController
from robotteamsim.control.baselines.random_walk import RandomWalkController
from robotteamsim.control.baselines.sebs import SebsController
from robotteamsim.control.cover.controller import CoverController
from robotteamsim.control.people.dispatch import DispatchController
from robotteamsim.control.people.firefighter import FirefighterController
from robotteamsim.control.people.relay import RelayController
from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.runtime.base_station import with_base
from robotteamsim.control.search.controller import SearchController
from robotteamsim.errors import RobotTeamSimError, ScenarioError
from robotteamsim.interface import Controller
from robotteamsim.scenario.scenario import Scenario

MakeController = Callable[..., Controller]
"""A controller class, or another callable that makes the controller of one robot from its id and the scenario.

If it has a parameter `arrival`, it receives the number of the robot's arrivals, including the start.
"""

ALGORITHMS: dict[str, MakeController] = {
    "rdpso": RdpsoController,
    "random_walk": RandomWalkController,
    "greedy": GreedyController,
    "pso": PsoController,
    "dpso": DpsoController,
    "rpso": RpsoController,
    "sebs": SebsController,
    "conscientious_reactive": ConscientiousReactiveController,
    "boustrophedon": BoustrophedonController,
    "infotaxis": InfotaxisController,
    "cover": CoverController,
    "search": SearchController,
    "relay": RelayController,
}
"""The controllers of this package."""

_OF_ROLE: dict[str, MakeController] = {"firefighter": FirefighterController, "command_centre": DispatchController}
"""The controllers of people, with firefighters."""

ENTRY_POINTS = "robotteamsim.controllers"
"""The group of entry points with which other packages register controllers."""


def make_controller(robot_id: int, scenario: Scenario, arrival: int = 1) -> Controller:
    """Return the controller of one robot for `control.algorithm`, of a relay, or of people for their role.

    The name is one of ALGORITHMS, or of an entry point in the group `robotteamsim.controllers`, or `module:Class`.
    If the scenario has a base, discoveries are announced to it, see `base_station.with_base`.
    Args:   arrival: number of the robot's arrivals, including the start.
    Raises: ScenarioError: no such algorithm, it cannot be imported or is not a controller; no such robot. Exceptions
            of the controller's constructor are not caught.
    """
    name = scenario.control.algorithm
    try:
        make = _make_for(robot_id, scenario)
    except _NotFoundError as error:
        raise ScenarioError(f"{scenario.name}: control.algorithm: {error}") from None
    made = make(robot_id, scenario, **({"arrival": arrival} if _takes_arrival(make) else {}))
    missing = [method for method in ("observe", "decide") if not callable(getattr(made, method, None))]
    if missing:
        raise ScenarioError(
            f"{scenario.name}: control.algorithm: '{name}' makes a {type(made).__name__}, which has no "
            f"{' and no '.join(missing)}"
        )
    return made if scenario.base is None else with_base(made, robot_id, scenario)


def _make_for(robot_id: int, scenario: Scenario) -> MakeController:
    if scenario.firefighters is not None and (role := scenario.role_of(robot_id)) != "robot":
        return _OF_ROLE[role]
    is_relay = scenario.num_robots - scenario.control.relays <= robot_id < scenario.num_robots
    return RelayController if is_relay else _find(scenario.control.algorithm)


def algorithm_names() -> list[str]:
    """Return the known names: this package's, then those of installed packages, sorted."""
    return [*ALGORITHMS, *sorted({point.name for point in entry_points(group=ENTRY_POINTS)} - set(ALGORITHMS))]


def _takes_arrival(make: MakeController) -> bool:
    try:
        return "arrival" in inspect.signature(make).parameters
    except ValueError:  # a class from a C extension may have no signature
        return False


class _NotFoundError(RobotTeamSimError):
    """No controller has that name."""


def _find(name: str) -> MakeController:
    if name in ALGORITHMS:
        return ALGORITHMS[name]
    for point in entry_points(group=ENTRY_POINTS):
        if point.name == name:
            return _loaded(name, point)
    module, colon, attribute = name.partition(":")
    if colon and module and attribute:
        return _loaded(name, EntryPoint(name, name, ENTRY_POINTS))
    raise _NotFoundError(f"'{name}' is not known; expected one of: {', '.join(algorithm_names())}, or module:Class")


def _loaded(name: str, point: EntryPoint) -> MakeController:
    try:
        # Otherwise files that were added after the last import are not found.
        importlib.invalidate_caches()
        found = point.load()
    except ModuleNotFoundError as error:
        missing = f"ModuleNotFoundError: {error}; is its folder in PYTHONPATH?"
        raise _NotFoundError(f"'{name}': {missing}") from None
    except Exception as error:  # Any error in the user's module is reported in one line.
        raise _NotFoundError(f"'{name}': {type(error).__name__}: {error}") from None
    if not callable(found):
        raise _NotFoundError(f"'{name}' is {found!r:.40}; expected a class")
    made: MakeController = found
    return made

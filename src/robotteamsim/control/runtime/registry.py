"""Controllers by the name in `control.algorithm`: ours, those of packages, any `module:Class`, files of policies."""

import inspect
from collections.abc import Callable, Collection
from functools import partial
from importlib.metadata import EntryPoint
from typing import NamedTuple

from robotteamsim.control.people.dispatch import DispatchController
from robotteamsim.control.people.firefighter import FirefighterController
from robotteamsim.control.runtime.area_planner import AreaPlanner
from robotteamsim.control.runtime.base_station import StandingBase, controls_base, with_base
from robotteamsim.control.runtime.located import Located
from robotteamsim.errors import RobotTeamSimError, ScenarioError
from robotteamsim.interface import Controller
from robotteamsim.maps.found_map import FoundMap, without_walls
from robotteamsim.maps.laser_localiser import LaserLocaliser
from robotteamsim.maps.localiser import DeadReckoning, Localiser, TruePose
from robotteamsim.maps.survey import Survey
from robotteamsim.own_parts import PartError, load_part, own_parts
from robotteamsim.scenario.controllers import ALGORITHMS, is_policy_file
from robotteamsim.scenario.problems import suggestion
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import Setup

MakeController = Callable[..., Controller]
"""A controller class, or another callable that makes the controller of one robot from its id and the scenario.

If its second parameter is named `setup`, it receives the `Setup` instead: the scenario with start poses and maps. If it
has a parameter `arrival`, it receives the number of the robot's arrivals, including the start.
"""

_OF_ROLE: dict[str, MakeController] = {"firefighter": FirefighterController, "command_centre": DispatchController}
"""The controllers of people, with firefighters."""

ENTRY_POINTS = "robotteamsim.controllers"
"""The group of entry points with which other packages register controllers."""

_OF_FILE = "robotteamsim.learning.policy_file:FilePolicy"
"""The controller of the file of a policy."""


def make_controller(robot_id: int, setup: Setup, arrival: int = 1) -> Controller:
    """Return the controller of one robot for `control.algorithm`, of a relay, or of people for their role.

    The name is one of ALGORITHMS, or of an entry point in the group `robotteamsim.controllers`, or `module:Class`, or
    a file of a learned policy.
    If the scenario has a base, discoveries are announced to it, see `base_station.with_base`. With another
    `mission.area_order` than given, robots choose their areas, see `area_planner.AreaPlanner`.
    Args:   arrival: number of the robot's arrivals, including the start.
    Raises: ScenarioError: no such algorithm, it cannot be imported or is not a controller; no such robot. Exceptions
            of the controller's constructor are not caught.
    """
    scenario = setup.scenario
    if not 0 <= robot_id < len(setup.robots):
        raise ScenarioError(f"{scenario.name}: there is no robot {robot_id}, only 0 to {len(setup.robots) - 1}")
    try:
        make = _make_for(robot_id, scenario)
    except _NotFoundError as error:
        raise ScenarioError(f"{scenario.name}: control.algorithm: {error}") from None
    complete = partial(_complete, robot_id, make=make, arrival=arrival)
    belief = make_belief(robot_id, setup, arrival)
    if belief.localiser is None:
        return complete(belief.setup)
    return Located(complete, robot_id, belief.setup, belief.localiser, belief.survey)


def _complete(robot_id: int, setup: Setup, *, make: MakeController, arrival: int) -> Controller:
    """Return the controller of a robot, with what makes its deliveries, and chooses its areas."""
    scenario, taken = setup.scenario, _parameters(make)
    own = {"arrival": arrival} if "arrival" in taken else {}
    stands = robot_id == scenario.base and not controls_base(make, scenario)
    made = StandingBase() if stands else make(robot_id, setup if "setup" in taken else scenario, **own)
    if not callable(getattr(made, "step", None)):
        problem = f"makes a {type(made).__module__}.{type(made).__name__}, which has no step(observation, inbox, task)"
        raise ScenarioError(f"{scenario.name}: control.algorithm: '{scenario.control.algorithm}' {problem}")
    complete = made if scenario.base is None else with_base(made, robot_id, scenario)
    if scenario.mission.area_order != "given" and robot_id in scenario.searcher_ids:
        return AreaPlanner(complete, robot_id, setup, getattr(made, "best_area", None))
    return complete


class Belief(NamedTuple):
    """What a robot's controller gets in place of the truth, see `Located`.

    setup:     with what the robot knows of the building.
    localiser: follows its pose; None: the true one is used.
    survey:    maps the building; None: the robot knows it.
    """

    setup: Setup
    localiser: Localiser | None
    survey: Survey | None


def make_belief(robot_id: int, setup: Setup, arrival: int = 1) -> Belief:
    """Return what a robot believes, by `control.localisation` and `control.map`."""
    localiser = _localiser(robot_id, setup, arrival)
    if setup.scenario.control.map == "known":
        return Belief(setup, localiser, None)
    known = without_walls(setup.plan)
    found = FoundMap(known)
    setup = setup.without_building(known, {robot_id: found})
    survey = Survey(robot_id, setup, found, localiser, arrival)
    return Belief(setup, survey, survey)


def _localiser(robot_id: int, setup: Setup, arrival: int) -> Localiser | None:
    """Return what follows the pose of a robot; None: its controller may use the true one, or a survey finds it."""
    control = setup.scenario.control
    if control.localisation == "laser" and control.map == "known":
        return LaserLocaliser(robot_id, setup, arrival)
    if control.localisation == "odometry":
        return DeadReckoning(robot_id, setup)
    return TruePose() if control.map == "unknown" and control.localisation == "ground_truth" else None


def _make_for(robot_id: int, scenario: Scenario) -> MakeController:
    if scenario.firefighters is not None and (role := scenario.role_of(robot_id)) != "robot":
        return _OF_ROLE[role]
    is_relay = scenario.num_robots - scenario.relays.count <= robot_id < scenario.num_robots
    return _find("relay" if is_relay else scenario.control.algorithm)


def algorithm_names() -> list[str]:
    """Return the known names: this package's, then those of installed packages, sorted."""
    return [*dict.fromkeys([*ALGORITHMS, *own_parts(ENTRY_POINTS)])]


def _parameters(make: MakeController) -> Collection[str]:
    try:
        return inspect.signature(make).parameters
    except ValueError:  # a class from a C extension may have no signature
        return ()


class _NotFoundError(RobotTeamSimError):
    """No controller has that name."""


def _find(name: str) -> MakeController:
    if name in ALGORITHMS:
        return _loaded(name, EntryPoint(name, ALGORITHMS[name].controller, ENTRY_POINTS))
    if point := own_parts(ENTRY_POINTS).get(name):
        return _loaded(name, point)
    if is_policy_file(name):
        return partial(_loaded(name, EntryPoint(name, _OF_FILE, ENTRY_POINTS)), name)
    module, colon, attribute = name.partition(":")
    if colon and module and attribute:
        return _loaded(name, EntryPoint(name, name, ENTRY_POINTS))
    known = algorithm_names()
    expected = f"expected one of: {', '.join(known)}, module:Class, or policy.pt{suggestion(name, known)}"
    raise _NotFoundError(f"'{name}' is not known; {expected}")


def _loaded(name: str, point: EntryPoint) -> MakeController:
    try:
        found = load_part(point)
    except PartError as error:
        raise _NotFoundError(f"'{name}': {error}") from None
    if not callable(found):
        raise _NotFoundError(f"'{name}' is {found!r:.40}; expected a class")
    made: MakeController = found
    return made

"""The protocols of the benchmarks: which controllers run in which buildings, with which noise and teams.

docs/benchmark.md describes them.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotteamsim import scenario
from robotteamsim.campaign.design import Cell, Design
from robotteamsim.control import make_controller
from robotteamsim.control.baselines.patrol_graph import patrol_graph
from robotteamsim.control.runtime.foreign_code import is_foreign
from robotteamsim.errors import CampaignError, PlacementError, RobotTeamSimError, ScenarioError
from robotteamsim.scenario.controllers import ALGORITHMS, Control, control_kind, is_policy_file
from robotteamsim.scenario.patrol import Patrol, PatrolGraph, PatrolVertex
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Mission, Team, Voice
from robotteamsim.setup import resolve

_PUBLISHED: Mapping[str, Any] = {
    "communication": {"gated": False},
    "rule_out_places": False,
    "navigation": "straight",
    "memory_of": "commands",
    "exclusion": {"while_approaching": True, "min_robots": 0},
    "swarms": {"min": 0},
}
"""The switches of the scenario garage_sar_published."""

VARIANTS: Mapping[str, Mapping[str, Any]] = {
    "rdpso_published": {"algorithm": "rdpso", **_PUBLISHED},
    "rdpso_adapted": {"algorithm": "rdpso", "adaptation": "fuzzy"},
    "search_connected": {"algorithm": "search", "network": "connected"},
    "cover_connected": {"algorithm": "cover", "c4": 0.3, "kept_link": "tree"},
    "frontier_alone": {"algorithm": "frontier", "coordinated": False},
    "nearest": {"algorithm": "frontier", "choice": "nearest", "coordinated": False},
    "nearest_coordinated": {"algorithm": "frontier", "choice": "nearest"},
    "cost_utility": {"algorithm": "frontier", "choice": "cost_utility"},
    "rrt": {"algorithm": "frontier", "choice": "rrt"},
}
"""Controllers that differ from a registered one by keys of `control`."""

_CONTROLLERS = (
    *("search", "rdpso_published", "rdpso_adapted", "pso", "greedy", "random_walk", "cover", "sebs", "infotaxis"),
    "boustrophedon",
)
"""Those of the search protocol; the first is the reference of all comparisons."""

_EXPLORING = ("frontier", "frontier_alone", "nearest", "nearest_coordinated", "cost_utility", "rrt", "rdpso")
"""Those of the exploration protocol; the first is the reference of all comparisons."""

PATROLLING = tuple(name for name, kind in ALGORITHMS.items() if kind.patrols)
"""The controllers that patrol."""

_LEAST_LATTICE = 6.0
"""Number of places along the side of a square building, at least, in the lattice that is patrolled."""

_OFFICE_AREAS = (
    "mission.areas=[{name: area_1, center: [18, 15]}, {name: area_2, center: [42, 14]}, "
    "{name: area_3, center: [56, 31]}, {name: area_4, center: [12, 21]}]"
)

BUILDINGS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "garage": ("garage_sar", ()),
    "office": ("office_manet", ("mission.base=null", "mission.time_limit_s=600", _OFFICE_AREAS)),
    "warehouse": ("warehouse_push", ("robots={count: 3, start: [2.0, 7.0, 0.0]}", "objects=[]")),
    "isr_floor": ("isr_floor_0_sar", ()),
}
"""By name, the shipped scenario and its changes: the warehouse has a team of equal robots and nothing to push."""

UNKNOWN_BUILDINGS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "garage": ("garage_unknown", ()),
    "office": ("office_unknown", ()),
    **{
        name: ("garage_unknown", (f"plan=explore_{name}", "robots.start=[1.7, 1.7, 0]", "mission.areas=[]"))
        for name in ("loop", "corridor", "corner", "rooms", "loop_rooms", "corner_rooms")
    },
}
"""The buildings of the exploration protocol; the last six are maps of our own."""

STARTS = ("near", "far")
POSES = ("known", "unknown", "unknown_start")


@dataclass(frozen=True, slots=True)
class SearchProtocol:
    """A benchmark of search.

    controllers: names in VARIANTS, registered algorithms, module:Class, or files of policies; the first is the
                 reference of comparisons.
    buildings:   names in BUILDINGS, shipped scenarios, or files.
    victims:     number of victims at random places, which replace the scenario's own.
    areas:       whether missions have the building's areas, of which the last one ends the mission.
    """

    controllers: tuple[str, ...]
    buildings: tuple[str, ...]
    noises_db: tuple[float, ...]
    robots: tuple[int, ...]
    trials: int
    victims: int = 4
    seed: int = 1
    areas: bool = True


@dataclass(frozen=True, slots=True)
class PatrolProtocol:
    """A benchmark of patrol in one building.

    controllers: names of controllers that patrol a graph, module:Class, or files of policies; the first is the
                 reference of comparisons.
    graph:       a .graph file of patrolling_sim; None: a lattice of places.
    """

    controllers: tuple[str, ...]
    building: str
    graph: str | None
    robots: tuple[int, ...]
    trials: int
    duration_s: float
    seed: int = 1


@dataclass(frozen=True, slots=True)
class ExplorationProtocol:
    """A benchmark of the exploration of buildings that nobody knows.

    controllers: names in VARIANTS, registered algorithms, module:Class, or files of policies, with which robots need
                 not know the building; the first is the reference of comparisons.
    buildings:   names in UNKNOWN_BUILDINGS, shipped scenarios, or files.
    starts:      of STARTS: robots start together, or at random places.
    poses:       of POSES: robots know their true poses, or find them with their maps, also where they start.
    """

    controllers: tuple[str, ...]
    buildings: tuple[str, ...]
    robots: tuple[int, ...]
    starts: tuple[str, ...]
    poses: tuple[str, ...]
    trials: int
    duration_s: float
    seed: int = 1


def quick_search() -> SearchProtocol:
    """Return a small search protocol, which runs within a minute on two cores."""
    return SearchProtocol(_CONTROLLERS, ("garage", "warehouse"), (20.0,), (3,), trials=2)


def full_search() -> SearchProtocol:
    """Return the full search protocol with the shipped buildings."""
    return SearchProtocol(_CONTROLLERS, tuple(BUILDINGS), (20.0, 30.0), (1, 3, 8), trials=30)


def quick_patrol(building: str = "garage", graph: str | None = None) -> PatrolProtocol:
    """Return a small patrol protocol, which runs within some minutes on two cores."""
    return PatrolProtocol(PATROLLING, building, graph, (1, 2, 4), trials=10, duration_s=600.0)


def full_patrol(building: str = "garage", graph: str | None = None) -> PatrolProtocol:
    """Return the full patrol protocol."""
    return PatrolProtocol(PATROLLING, building, graph, (1, 2, 4, 8, 12), trials=30, duration_s=3600.0)


def quick_exploration() -> ExplorationProtocol:
    """Return a small exploration protocol, which runs within some minutes on two cores."""
    some = ("frontier", "nearest", "rrt")
    return ExplorationProtocol(some, ("rooms", "loop_rooms"), (2,), ("near",), ("unknown",), trials=2, duration_s=300.0)


def full_exploration() -> ExplorationProtocol:
    """Return the full exploration protocol."""
    return ExplorationProtocol(
        _EXPLORING, tuple(UNKNOWN_BUILDINGS), (1, 2, 4, 8), STARTS, POSES[:2], trials=20, duration_s=1200.0
    )


def search_design(protocol: SearchProtocol) -> Design:
    """Return the design of a search protocol; trials of equal number have the same victims in all cells of a building.

    Raises: CampaignError, ScenarioError: one line with option, value and what was expected.
    """
    _check_lists(
        controller=protocol.controllers, building=protocol.buildings, noise=protocol.noises_db, robots=protocol.robots
    )
    if protocol.victims < 1:
        raise CampaignError(f"--victims: {protocol.victims} is not above 0: a search needs someone to find")
    cells = []
    for building in protocol.buildings:
        base = load_building(building)
        changes = {"victims": (), "random_victims": protocol.victims, "base": None, "coverage": {}}
        changes["patrol"] = _lattice(base)
        if not protocol.areas:
            changes["areas"] = ()
        mission = _section(Mission, base.mission, "--victims: ", **changes)
        nobody_else = base.people.model_copy(update={"groups": ()})
        base = base.model_copy(update={"mission": mission, "people": nobody_else})
        for noise_db in protocol.noises_db:
            voice = _section(Voice, base.voice, "--noise: ", noise_db=noise_db)
            noisy = base.model_copy(update={"voice": voice})
            for robots, controller, cell in _teams(noisy, protocol.robots, protocol.controllers):
                cells.append(Cell((building, noise_db, robots, controller), cell))
    keys = ("building", "noise_db", "robots", "controller")
    return _design(cells, keys, protocol.trials, protocol.seed)


def patrol_design(protocol: PatrolProtocol) -> Design:
    """Return the design of a patrol protocol, without areas and victims; the robots start at random poses.

    From one start, a controller without chance would drive the same patrol with every seed.

    Raises: CampaignError, ScenarioError.
    """
    _check_lists(controller=protocol.controllers, robots=protocol.robots)
    for controller in protocol.controllers:
        if controller not in PATROLLING and not is_foreign(controller):
            expected = ", ".join((*PATROLLING, "module:Class, a policy's file"))
            raise CampaignError(f"--controller: '{controller}' does not patrol a graph; expected one of {expected}")
    overrides = [] if protocol.graph is None else [f"mission.patrol.graph={json.dumps(protocol.graph)}"]
    try:
        base = load_building(protocol.building, overrides)
    except ScenarioError as error:
        raise CampaignError(str(error).replace("--set: mission.patrol.graph", "--graph", 1)) from None
    patrol = base.mission.patrol if protocol.graph else _lattice(base)
    changes = {"areas": (), "victims": (), "base": None, "time_limit_s": protocol.duration_s, "patrol": patrol}
    mission = _section(Mission, base.mission, "--duration: ", **changes)
    base = _at_random_places(base.model_copy(update={"mission": mission}), protocol.building)
    cells = [
        Cell((robots, controller), _with_graph(cell))
        for robots, controller, cell in _teams(base, protocol.robots, protocol.controllers)
    ]
    return _design(cells, ("robots", "controller"), protocol.trials, protocol.seed)


def exploration_design(protocol: ExplorationProtocol) -> Design:
    """Return the design of an exploration protocol, without areas and victims.

    Raises: CampaignError, ScenarioError.
    """
    _check_lists(
        controller=protocol.controllers,
        building=protocol.buildings,
        robots=protocol.robots,
        start=protocol.starts,
        pose=protocol.poses,
    )
    for option, values, known in (("--start", protocol.starts, STARTS), ("--pose", protocol.poses, POSES)):
        for value in values:
            if value not in known:
                raise CampaignError(f"{option}: '{value}'; expected one of {', '.join(known)}")
    cells = []
    for building in protocol.buildings:
        base = load_building(building, known=UNKNOWN_BUILDINGS)
        changes = {"areas": (), "victims": (), "base": None, "time_limit_s": protocol.duration_s}
        mission = _section(Mission, base.mission, "--duration: ", **changes)
        base = base.model_copy(update={"mission": mission})
        for start, pose in itertools.product(protocol.starts, protocol.poses):
            found = {
                "map": "unknown",
                "localisation": "ground_truth" if pose == "known" else "laser",
                "mapping": {"starts": "unknown" if pose == "unknown_start" else "known"},
            }
            placed = _at_random_places(base, building) if start == "far" else base
            for robots, controller, cell in _teams(placed, protocol.robots, protocol.controllers, found):
                cells.append(Cell((building, start, pose, robots, controller), cell))
    return _design(cells, ("building", "start", "pose", "robots", "controller"), protocol.trials, protocol.seed)


def _at_random_places(of: Scenario, building: str) -> Scenario:
    """Return a scenario whose team starts at random places."""
    assert isinstance(of.robots, Team)
    start = of.robots.start or of.robots.start_poses[0]
    team = _section(Team, of.robots, f"{building}: robots.", start=start, start_poses=(), formation="random")
    return of.model_copy(update={"robots": team})


def _with_graph(of: Scenario) -> Scenario:
    """Return the scenario with its lattice as a graph: its idleness is then measured with any controller."""
    patrol = of.mission.patrol
    if patrol.graph is not None:
        return of
    found = patrol_graph(resolve(of))
    vertices = tuple(
        PatrolVertex(position=place, neighbours=tuple(i for i, _ in edges), lengths_m=tuple(m for _, m in edges))
        for place, edges in zip(found.places, found.edges, strict=True)
    )
    patrol = patrol.model_copy(update={"graph": PatrolGraph(vertices=vertices)})
    return of.model_copy(update={"mission": of.mission.model_copy(update={"patrol": patrol})})


def load_building(
    name: str, overrides: Sequence[str] = (), known: Mapping[str, tuple[str, tuple[str, ...]]] = BUILDINGS
) -> Scenario:
    """Return the scenario of a building. Raises: ScenarioError, CampaignError: it has no team, or a schedule."""
    of, changes = known.get(name, (name, ()))
    loaded = scenario.load(of, [*changes, *overrides])
    is_team = isinstance(loaded.robots, Team)
    if not is_team or not loaded.num_robots:
        found = "none" if is_team else "a list"
        raise CampaignError(f"{name}: robots: {found}; expected a team, whose number of robots the benchmark varies")
    if loaded.schedule:
        raise CampaignError(f"{name}: schedule: {len(loaded.schedule)} events; expected none in a benchmark")
    return loaded


def control_of(controller: str, given: Mapping[str, Any] | None = None) -> Control:
    """Return `control` with its defaults, except what makes a controller; a policy's file by its absolute path.

    Args: given: keys of all controllers that have other values.
    """
    algorithm = str(Path(controller).absolute()) if is_policy_file(controller) else controller
    keys = VARIANTS.get(controller, {"algorithm": algorithm})
    return control_kind(keys["algorithm"])(**keys, **(given or {}))


def _lattice(of: Scenario) -> Patrol:
    """Return the lattice that is patrolled: with the default spacing, or less in a small building."""
    (x_low, y_low), (x_high, y_high) = of.plan.bounds.min, of.plan.bounds.max
    side_m = math.sqrt((x_high - x_low) * (y_high - y_low))
    return Patrol(spacing_m=min(Patrol().spacing_m, max(side_m / _LEAST_LATTICE, 1.0)))


def _teams(
    base: Scenario, robots: Sequence[int], controllers: Sequence[str], given: Mapping[str, Any] | None = None
) -> Iterator[tuple[int, str, Scenario]]:
    """Yield each number of robots with each controller and its scenario, after checks. Args: given: as `control_of`."""
    assert isinstance(base.robots, Team)
    for count in robots:
        if count < 1:  # A scenario without robots is one with firefighters.
            raise CampaignError(f"--robots: count: {count} is below 1")
        team = _section(Team, base.robots, "--robots: ", count=count, reserve=0)
        sized = base.model_copy(update={"robots": team})
        _check_room(sized)
        for controller in controllers:
            control = control_of(controller, given)
            if control.map not in control.maps:
                raise CampaignError(f"--controller: '{controller}' needs to know the building")
            cell = sized.model_copy(update={"control": control})
            try:
                made = make_controller(0, resolve(cell))
            except RobotTeamSimError as error:
                message = str(error).removeprefix(f"{cell.name}: ").removeprefix("control.algorithm: ")
                option = "--policy" if is_policy_file(controller) else "--controller"
                raise CampaignError(f"{option}: {message}") from None
            assert made is not None
            yield count, controller, cell


def _check_room(of: Scenario) -> None:
    """Check that robots and victims have room, for one seed. Raises: CampaignError, ScenarioError."""
    try:
        resolve(of)
    except PlacementError as error:
        if error.key.partition(".")[0] != "robots":
            raise
        raise CampaignError(f"--robots: {of.name}: {str(error).partition(f'{error.key}: ')[2]}") from None


def _section(model: Any, section: Any, place: str, **changes: Any) -> Any:
    """Return a section with some keys changed, which are checked. Raises: CampaignError, after `place`."""
    return checked(model, section.model_dump(mode="json", by_alias=True) | changes, CampaignError, place)


def _check_lists(**values_of: Sequence[Any]) -> None:
    """Raises: CampaignError: the list of an option is empty or has a value twice. Args: values_of: by option."""
    for option, values in values_of.items():
        if not values:
            raise CampaignError(f"--{option}: no values")
        for index, value in enumerate(values):
            if value in values[:index]:
                raise CampaignError(f"--{option}: {value} is given twice")


def _design(cells: Sequence[Cell], keys: tuple[str, ...], trials: int, seed: int) -> Design:
    if trials < 1:
        raise CampaignError(f"--trials: {trials} is below 1")
    if not 0 <= seed < 2**53:
        raise CampaignError(f"--seed: {seed} is not between 0 and 2^53")
    return Design(cells[0].scenario, seed, trials, keys, tuple(cells), paired=True)

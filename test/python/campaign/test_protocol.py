"""The protocols of the benchmarks."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from robotteamsim import __version__
from robotteamsim.campaign.protocol import (
    BUILDINGS,
    PATROLLING,
    ExplorationProtocol,
    PatrolProtocol,
    SearchProtocol,
    control_of,
    exploration_design,
    full_exploration,
    full_search,
    patrol_design,
    quick_search,
    search_design,
)
from robotteamsim.campaign.trial import run_trial
from robotteamsim.control.baselines.random_walk import RandomWalkController
from robotteamsim.errors import CampaignError, RobotTeamSimError
from robotteamsim.scenario import from_mapping, load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

SMALL = SearchProtocol(("greedy", "random_walk"), ("garage",), (20.0, 30.0), (1, 3), trials=2)
ONE_R5 = Path(__file__).parents[2] / "data" / "scenarios" / "one_r5.yaml"
THREE = Path(__file__).parents[2] / "data" / "patrol" / "three.graph"


def test_printed_rdpso_has_the_switches_of_the_published_scenario():
    assert control_of("rdpso_published") == load("garage_sar_published").control
    assert control_of("rdpso_adapted").adaptation == "fuzzy"


def test_search_is_the_reference_of_both_protocols():
    assert quick_search().controllers == full_search().controllers
    assert quick_search().controllers[0] == "search"
    assert len(set(quick_search().controllers)) == 10


def test_cells_are_all_combinations_with_random_victims_in_place_of_the_scenarios_own():
    design = search_design(SMALL)
    assert design.keys == ("building", "noise_db", "robots", "controller")
    assert len(design.cells) == 2 * 2 * 2
    for cell in design.cells:
        building, noise_db, robots, controller = cell.values
        assert building == "garage"
        assert (cell.scenario.voice.noise_db, cell.scenario.num_robots) == (noise_db, robots)
        assert cell.scenario.control.algorithm == controller
        assert (cell.scenario.mission.victims, cell.scenario.mission.random_victims) == ((), 4)
        assert len(cell.scenario.mission.areas) == 5


def test_search_without_areas_has_the_same_victims_and_no_area():
    cells = search_design(SMALL).cells, search_design(replace(SMALL, areas=False)).cells
    for with_areas, without in zip(*cells, strict=True):
        assert without.scenario.mission == with_areas.scenario.mission.model_copy(update={"areas": ()})


def test_all_cells_of_a_building_have_the_same_victims():
    design = search_design(SMALL)
    seeds = {trial.seed for trial in design.all_trials() if trial.number == 1}
    assert len(seeds) == 1
    placed = set()
    for cell in design.cells:
        run = cell.scenario.run.model_copy(update={"seed": min(seeds)})
        placed.add(resolve(cell.scenario.model_copy(update={"run": run})).scenario.mission.victims)
    assert len(placed) == 1


@pytest.mark.slow
def test_full_protocol_has_room_for_sixteen_robots_in_each_building():
    full = full_search()
    design = search_design(replace(full, controllers=("greedy",), robots=(*full.robots, 16)))
    assert {cell.values[0] for cell in design.cells} == set(BUILDINGS)
    assert max(cell.scenario.num_robots for cell in design.cells) == 16
    assert all(cell.scenario.mission.areas and cell.scenario.mission.base is None for cell in design.cells)


@pytest.mark.slow
def test_lattice_of_sebs_is_finer_in_a_small_building():
    design = search_design(replace(SMALL, controllers=("sebs",), buildings=("garage", str(ONE_R5)), noises_db=(20.0,)))
    spacings_m = {cell.values[0]: cell.scenario.mission.patrol.spacing_m for cell in design.cells}
    assert spacings_m["garage"] == 6.0
    # 12 x 12.5 m: a sixth of the side of a square of that area.
    assert spacings_m[str(ONE_R5)] == pytest.approx(math.sqrt(12.0 * 12.45) / 6.0, abs=0.01)


def test_patrol_has_a_graph_and_neither_areas_nor_victims():
    design = patrol_design(PatrolProtocol(("sebs",), "garage", str(THREE), (2,), trials=1, duration_s=60.0))
    (cell,) = design.cells
    assert len(cell.scenario.mission.patrol.graph.vertices) == 3
    assert (cell.scenario.mission.areas, cell.scenario.mission.victims) == ((), ())
    assert cell.scenario.mission.time_limit_s == 60.0


def test_patrol_of_a_users_class_has_the_lattice_as_a_graph_which_is_measured(monkeypatch):
    module = ModuleType("patrol_of_test")
    module.Mine = RandomWalkController
    monkeypatch.setitem(sys.modules, "patrol_of_test", module)
    protocol = PatrolProtocol(("sebs", "patrol_of_test:Mine"), "garage", None, (2,), trials=1, duration_s=5.0)
    design = patrol_design(protocol)
    outcomes = [run_trial(design.cells[trial.cell].scenario, trial, __version__) for trial in design.all_trials()]
    first, second = (len(outcome.known_details.idleness.vertices) for outcome in outcomes)
    assert first == second > 30
    # The lattice itself is patrolled in the same way.
    data = design.cells[0].scenario.model_dump(mode="json", by_alias=True)
    data["mission"]["patrol"]["graph"], data["run"]["seed"] = None, outcomes[0].seed
    assert Simulation(from_mapping(data, "test")).run().trajectory_hash == outcomes[0].trajectory_hash


@pytest.mark.slow
@pytest.mark.parametrize("controller", PATROLLING)
def test_patrols_of_other_seeds_start_elsewhere_and_drive_other_trajectories(controller):
    design = patrol_design(PatrolProtocol((controller,), "garage", None, (2,), trials=3, duration_s=20.0))
    hashes = [run_trial(design.cells[0].scenario, trial, __version__).trajectory_hash for trial in design.all_trials()]
    assert len(set(hashes)) == 3


def test_all_controllers_of_a_patrol_have_the_same_starts():
    design = patrol_design(PatrolProtocol(PATROLLING, "garage", None, (2, 4), trials=1, duration_s=20.0))
    (seed,) = {trial.seed for trial in design.all_trials()}
    starts = {}
    for cell in design.cells:
        run = cell.scenario.run.model_copy(update={"seed": seed})
        robots = resolve(cell.scenario.model_copy(update={"run": run})).robots
        starts.setdefault(cell.values[0], set()).add(tuple(robot.start_pose for robot in robots))
    ((two,), (four,)) = starts[2], starts[4]
    assert four[:2] == two


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"controllers": ("gredy",)}, "--controller: 'gredy' is not known; expected one of: rdpso, "),
        ({"controllers": ()}, "--controller: no values"),
        ({"controllers": ("greedy", "greedy")}, "--controller: greedy is given twice"),
        ({"noises_db": (90.0,)}, "--noise: noise_db: 90.0 is above 80"),
        ({"robots": (0,)}, "--robots: count: 0 is below 1"),
        ({"robots": (2900,)}, "--robots: warehouse_push: 2900 robots 0.8 m apart do not fit around [2, 7]"),
        ({"victims": 0}, "--victims: 0 is not above 0: a search needs someone to find"),
        ({"victims": 1001}, "--victims: random_victims: 1001 is above 1000"),
        ({"trials": 0}, "--trials: 0 is below 1"),
        ({"seed": -1}, "--seed: -1 is not between 0 and 2^53"),
        ({"buildings": ("gargage",)}, "gargage: no shipped scenario of this name"),
        ({"buildings": ("warehouse_push",)}, "warehouse_push: robots: a list; expected a team"),
        ({"buildings": ("office_egress",)}, "office_egress: robots: none; expected a team"),
    ],
)
def test_mistake_in_a_protocol_is_one_line_with_the_option(changes, line):
    with pytest.raises(RobotTeamSimError) as raised:
        search_design(replace(quick_search(), **({"controllers": ("greedy",), "buildings": ("warehouse",)} | changes)))
    assert line in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"controllers": ("greedy",)}, "--controller: 'greedy' does not patrol a graph; expected one of sebs, consc"),
        ({"graph": "no.graph"}, "--graph: there is no file"),
        ({"duration_s": 2e6}, "--duration: time_limit_s: "),
    ],
)
def test_mistake_in_a_patrol_is_one_line_with_the_option(changes, line):
    protocol = PatrolProtocol(("sebs",), "garage", None, (2,), trials=1, duration_s=60.0)
    with pytest.raises(CampaignError) as raised:
        patrol_design(replace(protocol, **changes))
    assert str(raised.value).startswith(line)


EXPLORATION = ExplorationProtocol(
    ("frontier", "rdpso"),
    ("rooms", "loop"),
    (1, 2),
    ("near", "far"),
    ("known", "unknown", "unknown_start"),
    trials=2,
    duration_s=60.0,
)


def test_exploration_has_all_combinations_in_buildings_that_nobody_knows():
    design = exploration_design(EXPLORATION)
    assert design.keys == ("building", "start", "pose", "robots", "controller")
    assert len(design.cells) == 48
    for cell in design.cells:
        building, start, pose, robots, _ = cell.values
        scenario = cell.scenario
        assert scenario.plan.name == f"explore_{building}"
        assert scenario.control.map == "unknown"
        assert scenario.control.localisation == ("ground_truth" if pose == "known" else "laser")
        assert scenario.control.mapping.starts == ("unknown" if pose == "unknown_start" else "known")
        assert (scenario.num_robots, scenario.robots.formation) == (robots, "square" if start == "near" else "random")
        assert (scenario.mission.areas, scenario.mission.victims, scenario.mission.time_limit_s) == ((), (), 60.0)


def test_robots_that_start_far_start_elsewhere_with_each_seed_and_alike_with_each_controller():
    design = exploration_design(
        replace(EXPLORATION, buildings=("rooms",), robots=(2,), starts=("far",), poses=("known",))
    )
    starts = {}
    for trial in design.all_trials():
        scenario = design.cells[trial.cell].scenario
        seeded = scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": trial.seed})})
        starts.setdefault(trial.number, set()).add(tuple(robot.start_pose for robot in resolve(seeded).robots))
    assert {len(of_trial) for of_trial in starts.values()} == {1}
    assert starts[1] != starts[2]


def test_full_exploration_has_room_for_eight_robots_in_each_building():
    design = exploration_design(replace(full_exploration(), controllers=("frontier",), poses=("unknown",)))
    assert len(design.cells) == 8 * 4 * 2


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"controllers": ("greedy", "search")}, "--controller: 'search' needs to know the building"),
        ({"starts": ("here",)}, "--start: 'here'; expected one of near, far"),
        ({"poses": ("known", "wrong")}, "--pose: 'wrong'; expected one of known, unknown, unknown_start"),
        ({"starts": ()}, "--start: no values"),
        ({"poses": ("known", "known")}, "--pose: known is given twice"),
        ({"duration_s": 2e6}, "--duration: time_limit_s: "),
    ],
)
def test_mistake_in_an_exploration_is_one_line_with_the_option(changes, line):
    with pytest.raises(CampaignError) as raised:
        exploration_design(replace(EXPLORATION, buildings=("rooms",), **changes))
    assert str(raised.value).startswith(line)


@pytest.mark.parametrize("controller", ["greedy", "boustrophedon", "infotaxis", "sebs"])
def test_search_in_noise_above_every_voice_ends_at_the_time_limit(controller):
    (cell,) = search_design(replace(SMALL, controllers=(controller,), noises_db=(80.0,), robots=(2,))).cells
    mission = cell.scenario.mission.model_copy(update={"areas": (), "time_limit_s": 20.0})
    result = Simulation(cell.scenario.model_copy(update={"mission": mission})).run()
    assert (result.end, result.time_s) == ("time_limit", 20.0)

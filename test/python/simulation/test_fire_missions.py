"""Missions with a fire: what robots see, how they avoid heat, and whom it harms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.hazards import BURNING
from robotteamsim.scenario import from_mapping, load
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Simulation, StepRecord

CORRIDOR = {
    "name": "corridor",
    "bounds": {"max": [20, 6]},
    "walls": [
        {"name": "north", "from": [0, 5.9], "to": [20, 5.9]},
        {"name": "south", "from": [0, 0.1], "to": [20, 0.1]},
    ],
}
FUEL = {"name": "boxes", "polygon": [[9, 0], [11, 0], [11, 6], [9, 6]], "growth": "ultra_fast", "load_mj_m2": 2000}
IGNITION = {"position": [10.2, 3.2]}


def mission(fire: dict[str, object], **sections: object) -> Scenario:
    base = {
        "name": "fire",
        "plan": CORRIDOR,
        "robots": [{"start_pose": [2.0, 3.0, 0.0], "sensors": [{"kind": "heat", "range_m": 5.0}]}],
        "fire": {"fuel": [FUEL], "ignitions": [IGNITION], **fire},
        "mission": {"time_limit_s": 600.0},
        "control": {"algorithm": "random_walk"},
    }
    return from_mapping({**base, **sections}, "fire")


def steps(simulation: Simulation, count: int) -> list[StepRecord]:
    return [simulation.step() for _ in range(count)]


def events(records: list[StepRecord], kind: str) -> list[tuple[float, str]]:
    return [(event.time_s, event.detail) for record in records for event in record.events if event.kind == kind]


def test_robot_that_stays_in_the_heat_fails_and_leaves_the_world():
    hot = mission(
        {"heat": {"robot_limit_c": 60.0, "robot_endures_s": 20.0}},
        robots=[{"start_pose": [9.5, 2.2, 0.0]}, {"start_pose": [2.0, 3.0, 0.0]}],
        mission={"time_limit_s": 600.0, "autostart": True, "base": 0},
        control={"algorithm": "cover"},  # the base stands still
    )
    simulation = Simulation(hot)
    above_s, records = 0.0, []
    while not (failed := events(records[-1:], "robot_failed_by_heat")):
        records.append(simulation.step())
        if records[-1].hazards is not None:
            above_s += float(records[-1].hazards.temperature_c(np.array([[9.5, 2.2]]))[0]) > 60.0
        assert len(records) < 3000
    assert failed[0][1] == "robot 0 fails from heat"
    assert above_s == 20.0
    assert records[-1].present.tolist() == [False, True]
    assert records[-1].failed == {0}
    assert not events(records, "robot_removed")
    simulation.spawn_robot(0)
    assert simulation.step().failed == frozenset()


def test_smoke_takes_the_far_returns_of_a_laser():
    simulation = Simulation(
        mission(
            {"heat": {"robot_limit_c": 1000.0}},
            robots=[{"start_pose": [5.0, 1.5, 0.3]}],
            mission={"autostart": False},
        )
    )
    clear = simulation.step().readings[0].ranges_m.copy()
    place = np.array([[5.1, 1.5]])
    while simulation.hazards.field.extinction_per_m(place)[0] < 0.7:
        record = simulation.step()
    # Sight along each beam, by adding up extinction in steps of 1 cm, from the laser 0.1 m ahead of the robot.
    depths = np.arange(0.005, 5.0, 0.01)
    sights_m = []
    for angle in 0.3 + np.linspace(-math.pi / 2, math.pi / 2, 181):
        along = np.stack([depths * math.cos(angle), depths * math.sin(angle)], axis=1)
        laser = np.array([5.0 + 0.1 * math.cos(0.3), 1.5 + 0.1 * math.sin(0.3)])
        depth = np.cumsum(simulation.hazards.field.extinction_per_m(laser + along)) * 0.01
        sights_m.append(depths[np.argmax(depth >= 1.5)] if (depth >= 1.5).any() else 5.0)
    smoky, sights_m = record.readings[0].ranges_m, np.array(sights_m)
    is_hidden, is_seen = clear > sights_m + 0.2, clear < sights_m - 0.2
    assert (smoky[is_hidden] == 5.0).all()
    assert (smoky[is_seen] == clear[is_seen]).all()
    assert (is_hidden & (clear < 5.0)).sum() > 10
    assert is_seen.sum() > 10


@pytest.mark.slow
def test_robots_keep_away_from_heat_that_they_see():
    def closest_m(sees: bool) -> float:
        robot = {"start_pose": [2.0, 3.0, 0.0], **({"sensors": [{"kind": "heat", "range_m": 5.0}]} if sees else {})}
        scenario = mission(
            {"fuel": [{**FUEL, "polygon": [[9, 1.5], [11, 1.5], [11, 3.5], [9, 3.5]]}]},
            robots=[robot],
            mission={
                "areas": [{"name": "end", "center": [18, 3], "radius_m": 1.0}],
                "time_limit_s": 300.0,
                "autostart": False,
            },
            control={"algorithm": "greedy"},
            run={"seed": 3},
        )
        simulation, nearest_m = Simulation(scenario), math.inf
        steps(simulation, 900)
        simulation.mission.start()
        for _ in range(1500):
            record = simulation.step()
            if record.is_there(0):
                pose = record.readings[0].ground_truth
                burning = np.argwhere(simulation.hazards.field.states == BURNING)
                places = (burning[:, ::-1] + 0.5) * 0.5
                nearest_m = min(nearest_m, *np.hypot(places[:, 0] - pose.x_m, places[:, 1] - pose.y_m))
            if record.mission.state == "ended":
                break
        return nearest_m

    assert closest_m(sees=False) < 0.5
    assert closest_m(sees=True) > 1.0


@pytest.mark.parametrize("algorithm", ["cover", "rdpso", "greedy", "relay"])
def test_robots_that_heat_surrounds_leave_it(algorithm: str):
    scenario = mission(
        {"heat": {"robot_limit_c": 1000.0}},
        robots=[{"start_pose": [10.2, 3.2, 0.0], "sensors": [{"kind": "heat", "range_m": 5.0}]}],
        mission={"areas": [{"name": "end", "center": [18, 3], "radius_m": 1.0}], "autostart": False},
        control={"algorithm": algorithm},
    )
    simulation = Simulation(scenario)
    steps(simulation, 600)
    place = simulation.hazards.field.temperature_c(np.array([[10.2, 3.2]]))
    assert place[0] > simulation.hazards.field.fire.heat.block_c
    simulation.mission.start()
    pose = steps(simulation, 200)[-1].readings[0].ground_truth
    assert abs(pose.x_m - 10.0) > 1.2
    assert simulation.hazards.field.temperature_c(np.array([[pose.x_m, pose.y_m]]))[0] < scenario.fire.heat.block_c


@pytest.mark.slow
def test_victims_collapse_and_die_and_fall_silent():
    victims = [{"name": "ann", "position": [9.2, 4.8]}, {"name": "bob", "position": [1.0, 1.0]}]
    scenario = mission({}, mission={"victims": victims, "time_limit_s": 900.0, "save_distance_m": 0.1})
    simulation = Simulation(scenario)
    records = steps(simulation, 3000)
    (collapse_s, collapse), (death_s, death) = (events(records, f"victim_{kind}")[0] for kind in ("collapsed", "dead"))
    assert collapse.startswith("ann collapses: FED ")
    assert death.startswith("ann dies: FED ")
    assert collapse_s <= death_s
    assert records[-1].mission.victims[0] == "dead"
    assert "ann" in simulation.mission.silent_victims


def test_burnt_door_is_open_in_the_world():
    plan = {
        **CORRIDOR,
        "walls": [
            *CORRIDOR["walls"],
            {"name": "left", "from": [12, 0], "to": [12, 2.4]},
            {"name": "right", "from": [12, 3.6], "to": [12, 6]},
        ],
        "doors": [{"name": "door", "from": [12, 2.4], "to": [12, 3.6], "closed": True}],
    }
    fuel = {**FUEL, "polygon": [[9, 0], [12, 0], [12, 6], [9, 6]]}
    simulation = Simulation(mission({"fuel": [fuel], "heat": {"door_endures_s": 30.0}}, plan=plan))
    records = []
    while not simulation.hazards.source.burnt_doors():
        records.append(simulation.step())
    assert not records[-1].doors["door"].closed
    assert [detail for _, detail in events(records, "door")] == ["door door is opened"]
    simulation.set_door("door", closed=True)
    steps(simulation, 20)
    assert not simulation.world.door_states()["door"].closed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("algorithm", "seed", "begin_s", "closed"),
    [("rdpso", 2, 0, ()), ("rdpso", 8, 0, ("area_2",)), ("search", 1, 400, ("area_2",))],
)
def test_teams_explore_all_areas_that_the_fire_leaves_open(algorithm, seed, begin_s, closed):
    keys = [f"run.seed={seed}", "mission.autostart=false", f"control={{algorithm: {algorithm}}}"]
    simulation = Simulation(load("garage_fire", keys))
    steps(simulation, 10 * begin_s)
    simulation.mission.start()
    records = [simulation.step()]
    while records[-1].mission.state != "ended":
        records.append(simulation.step())
    areas = [area.name for area in simulation.scenario.mission.areas]
    explored = [name for name, is_explored in zip(areas, records[-1].mission.explored, strict=True) if is_explored]
    assert explored == [name for name in areas if name not in closed]
    assert [name for name in areas if events(records, "area_passed_over") and name in closed] == list(closed)
    assert not records[-1].failed


@pytest.mark.slow
def test_mission_with_a_fire_is_the_same_to_the_bit_and_depends_on_the_seed():
    overrides = ["mission.time_limit_s=60", "run.seed=7"]
    first, again = (Simulation(load("garage_fire", overrides)).run() for _ in range(2))
    assert first.trajectory_hash == again.trajectory_hash
    other = Simulation(load("garage_fire", overrides))
    fires = [other, Simulation(load("garage_fire", ["run.seed=8"]))]
    for simulation in fires:
        steps(simulation, 1200)
    assert not np.array_equal(*(simulation.hazards.field.states for simulation in fires))


@pytest.mark.slow
def test_fire_that_has_not_begun_changes_no_trajectory():
    unlit = load("garage_fire", ["fire.ignitions=[]", "mission.time_limit_s=60"])
    without = load("garage_fire", ["fire=null", "mission.time_limit_s=60"])
    assert Simulation(unlit).run().trajectory_hash == Simulation(without).run().trajectory_hash


def test_ignition_without_a_fire_section_is_rejected():
    with pytest.raises(ScenarioError, match=r"schedule\.0\.ignite: there is no section 'fire'"):
        load("garage_sar", ["schedule=[{at_s: 1, ignite: [5, 5]}]"])
    with pytest.raises(ValueError, match="ignite: the scenario has no section 'fire'"):
        Simulation(load("garage_sar")).ignite((5.0, 5.0))


def test_fuel_in_the_wrong_place_names_file_and_key():
    with pytest.raises(ScenarioError, match=r"^--set: fire\.ignitions\.0\.position: \[30, 16\] lies in block 'core'$"):
        Simulation(load("garage_fire", ["fire.ignitions=[{position: [30, 16]}]"]))

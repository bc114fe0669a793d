"""People and firefighters who take stairs, ramps and lifts: times, flows, rescues from another level."""

from __future__ import annotations

import math
from typing import Any

import pytest

from robotteamsim.interface import Decision
from robotteamsim.mission.sensed import Sensed
from robotteamsim.scenario import from_mapping
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, Simulation, StepRecord

STAIRS = {"name": "stairs", "kind": "stairs", "stops": [[8, 5], [28, 5], [48, 5]], "length_m": 6.0}
WEST = {"name": "west", "center": [2, 5], "radius_m": 1.0}
ON_LEVEL_1, ON_LEVEL_2 = [22, 5], [42, 5]


def tower(*passages: dict[str, Any]) -> dict[str, Any]:
    """Three levels of 10 x 10 m with walls around, 3 m above one another."""
    levels, walls = [], []
    for k in range(3):
        x, corners = 20.0 * k, [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
        bounds = {"min": [x - 1, -1], "max": [x + 11, 11]}
        levels.append({"name": f"L{k}", "bounds": bounds, "origin": [x, 0], "elevation_m": 3.0 * k})
        for i in range(4):
            (x0, y0), (x1, y1) = corners[i], corners[(i + 1) % 4]
            walls.append({"name": f"wall_{k}_{i}", "from": [x0 + x, y0], "to": [x1 + x, y1]})
    bounds = {"min": [-1, -1], "max": [51, 11]}
    return {"name": "tower", "bounds": bounds, "walls": walls, "levels": levels, "passages": list(passages)}


def ann(place: list[float], **keys: object) -> dict[str, object]:
    return {"name": "ann", "position": place, "flees": True, "speed_mps": 1.0, **keys}


def egress(plan: dict[str, Any], victims: list[dict[str, Any]], **sections: Any) -> Scenario:
    mission = {"victims": victims, "exits": [WEST], "walk_update_s": 0.1, "time_limit_s": 200.0}
    return from_mapping({"name": "egress", "plan": plan, "mission": mission, **sections}, "egress")


def run(*arguments: Any, **keys: Any) -> Result:
    return Simulation(egress(*arguments, **keys)).run()


@pytest.mark.parametrize(
    ("keys", "speed_mps", "seconds"),
    [
        ({}, 1.0, 6.0 / 0.77),
        ({}, 0.5, 6.0 / 0.385),
        ({"walking_share": 0.6}, 1.0, 10.0),
        ({"kind": "ramp"}, 1.0, 6.0),
        ({"kind": "lift", "people": True, "speed_mps": 2.0, "wait_s": 5.0}, 1.0, 8.0),
    ],
)
def test_stairs_take_their_length_over_a_share_of_the_walking_speed(
    keys: dict[str, Any], speed_mps: float, seconds: float
) -> None:
    passage = {**STAIRS, "stops": STAIRS["stops"][:2], **keys}
    result = run(tower(passage), [ann(ON_LEVEL_1, speed_mps=speed_mps)])
    # From x = 22 m to 27.5 m, where the stop begins; from x = 7.5 m to the edge of the exit at 3 m.
    assert result.egress.rset_s == pytest.approx((5.5 + 4.5) / speed_mps + seconds, abs=0.35)
    assert result.egress.num_out == {"west": 1}


def test_from_the_third_level_two_flights_follow_each_other() -> None:
    result = run(tower(STAIRS), [ann(ON_LEVEL_2)])
    assert result.egress.rset_s == pytest.approx(5.5 + 4.5 + 2.0 * 6.0 / 0.77, abs=0.5)


def test_people_take_the_path_that_is_the_shortest_in_time() -> None:
    """Stairs of 6 m take as long as 7.8 m of level floor: longer than a ramp of 7 m, and shorter than one of 9 m."""
    for length_m, least_s in ((7.0, 7.0), (9.0, 6.0 / 0.77)):
        ramp = {"name": "ramp", "kind": "ramp", "stops": [[8, 4], [28, 4]], "length_m": length_m}
        stairs = {**STAIRS, "stops": [[8, 6], [28, 6]]}
        result = run(tower(ramp, stairs), [ann(ON_LEVEL_1)])
        way_m = 2.0 * math.hypot(6.0, 1.0) - 0.5 - 0.5 - 1.0
        assert result.egress.rset_s == pytest.approx(way_m + least_s, abs=0.7)


def test_nobody_flees_by_a_lift() -> None:
    lift = {**STAIRS, "kind": "lift"}
    record = steps(Simulation(egress(tower(lift), [ann(ON_LEVEL_1)])), 400)
    assert record.people[0].motion == "enclosed"
    assert record.people[0].position_m == tuple(ON_LEVEL_1)


def steps(simulation: Simulation, count: int) -> StepRecord:
    return [simulation.step() for _ in range(count)][-1]


@pytest.mark.parametrize("width_m", [0.5, 1.0])
def test_flow_into_stairs_is_at_most_that_of_the_hydraulic_model(width_m: float) -> None:
    """1.32 * 0.77 persons per metre and second, see [gwynne2016]: 31 people follow the first one within 30 headways."""
    crowd = [ann([27.0 - 0.6 * (i % 8), 3.8 + 0.6 * (i // 8)], name=f"ann{i}") for i in range(31)]
    result = run(tower({**STAIRS, "stops": STAIRS["stops"][:2], "width_m": width_m}), crowd)
    out_s = sorted(person.out_s for person in result.egress.people)
    headways_s = 30.0 / (1.32 * 0.77 * width_m)
    assert out_s[-1] - out_s[0] == pytest.approx(headways_s, rel=0.15)


class Standing:
    """The controllers of one robot, which stands."""

    faults = ("",)

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        return (Decision(),)


def test_who_arrives_where_somebody_stands_comes_out_next_to_them() -> None:
    robots = [{"start_pose": [8.0, 5.0, 0.0]}]
    passage = {**STAIRS, "stops": STAIRS["stops"][:2]}
    simulation = Simulation(egress(tower(passage), [ann([28, 5])], robots=robots), controllers=Standing())
    while (record := simulation.step()).people[0].position_m[0] > 15.0:
        assert record.sim_time_ns < 20e9
    assert 0.35 <= math.dist(record.people[0].position_m, (8.0, 5.0)) <= 0.5


def rescue(**changes: Any) -> Scenario:
    data: dict[str, Any] = {
        "name": "rescue",
        "plan": tower(STAIRS),
        "robots": {"count": 1, "start": [4.0, 2.0, 0.0]},
        "command_centre": [1.5, 8.0],
        "firefighters": {"count": 2, "start": [3.0, 5.0, 0.0]},
        "control": {"algorithm": "cover"},
        "mission": {
            "saved_by": "firefighter",
            "exits": [WEST],
            "victims": [
                {"name": "bob", "position": [27, 8], "can_walk": True, "speed_mps": 1.0},
                {"name": "eve", "position": [43, 4]},
            ],
            "time_limit_s": 400.0,
        },
    }
    return from_mapping({**data, **changes}, "rescue")


def test_firefighters_bring_those_who_are_carried_or_led_down_the_stairs_that_robots_do_not_take() -> None:
    simulation = Simulation(rescue())
    simulation.mission.start()
    levels: dict[int, set[int]] = {robot_id: set() for robot_id in range(3)}
    while (record := simulation.step()).mission.state == "running":
        for robot_id, visited in levels.items():
            visited.add(int((record.state.positions_m[robot_id, 0] + 1.0) // 20.0))
    assert record.mission.victims == ("safe", "safe")
    assert levels[0] == {0}
    assert levels[1] | levels[2] == {0, 1, 2}


def test_firefighters_are_as_fast_on_stairs_as_they_walk() -> None:
    simulation = Simulation(rescue())
    simulation.mission.start()
    held_ns: dict[int, list[int]] = {}
    while not any(x_m > 15.0 for x_m, _ in simulation.world.positions_m().tolist()):
        record = simulation.step()
        for robot_id in simulation.passages._trips:
            held_ns.setdefault(robot_id, []).append(record.sim_time_ns)
    first = next(i for i, (x_m, _) in enumerate(simulation.world.positions_m().tolist()) if x_m > 15.0)
    # 1.3 m/s on level floor.
    assert (simulation.world.sim_time_ns - held_ns[first][0]) / 1e9 == pytest.approx(6.0 / (0.77 * 1.3), abs=0.11)


def test_a_mission_over_levels_is_the_same_to_the_bit_with_the_same_seed() -> None:
    hashes = [Simulation(rescue(run={"seed": seed})).run().trajectory_hash for seed in (1, 1, 2)]
    assert hashes[0] == hashes[1] != hashes[2]


def test_firefighters_who_see_heat_take_other_stairs() -> None:
    """The nearest stairs burn; with a thermal camera, a firefighter goes up by those in the far corner."""
    near = {"name": "near", "kind": "stairs", "stops": [[5, 5], [25, 5]], "length_m": 6.0}
    far = {"name": "far", "kind": "stairs", "stops": [[9, 1], [29, 1]], "length_m": 12.0}
    fire = {
        "fuel": [{"name": "bin", "center": [5.25, 5.25], "radius_m": 0.8, "hrr": [[0, 500]]}],
        "ignitions": [{"position": [5.25, 5.25]}],
    }
    mission = {"saved_by": "firefighter", "victims": [{"name": "eve", "position": [26, 6]}], "time_limit_s": 200.0}
    crew = {"count": 1, "start": [3.0, 8.0, 0.0], "sensors": [{"kind": "heat", "range_m": 8}]}
    simulation = Simulation(rescue(plan=tower(near, far), fire=fire, firefighters=crew, mission=mission))
    simulation.mission.start()
    while (record := simulation.step()).mission.state == "running":
        x_m, y_m = record.state.positions_m[1].tolist()
        assert math.dist((x_m, y_m), (5.0, 5.0)) > 1.0
        if x_m > 15.0:
            break
    assert math.dist((x_m, y_m), (29.0, 1.0)) <= 0.5

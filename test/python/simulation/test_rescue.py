"""Rescues from the first call to safety: states, dispatch, contact, people who flee or follow."""

from __future__ import annotations

import math
from typing import Any

import pytest

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Simulation, StepRecord

HALL = {
    "name": "hall",
    "bounds": {"min": [0.0, 0.0], "max": [30.0, 10.0]},
    "walls": [
        {"name": "south", "from": [0, 0.1], "to": [30, 0.1], "thickness_m": 0.2},
        {"name": "north", "from": [0, 9.9], "to": [30, 9.9], "thickness_m": 0.2},
        {"name": "west", "from": [0.1, 0.2], "to": [0.1, 9.8], "thickness_m": 0.2},
        {"name": "east", "from": [29.9, 0.2], "to": [29.9, 9.8], "thickness_m": 0.2},
        {"name": "middle_south", "from": [15, 0.2], "to": [15, 4], "thickness_m": 0.2},
        {"name": "middle_north", "from": [15, 6], "to": [15, 9.8], "thickness_m": 0.2},
    ],
    "doors": [{"name": "door", "from": [15, 4], "to": [15, 6], "thickness_m": 0.2}],
}


def rescue(**changes: Any) -> Any:
    data: dict[str, Any] = {
        "name": "rescue",
        "plan": HALL,
        "robots": {"count": 1, "start": [4.0, 2.0, 0.0]},
        "command_centre": [1.5, 5.0],
        "firefighters": {"count": 2, "start": [3.0, 5.0, 0.0]},
        "control": {"algorithm": "cover"},
        "mission": {
            "saved_by": "firefighter",
            "victims": [
                {"name": "ann", "position": [12.0, 2.0]},
                {"name": "bob", "position": [24.0, 8.0], "can_walk": True, "speed_mps": 1.0},
            ],
            "time_limit_s": 300.0,
        },
    }
    for section, values in changes.items():
        data[section] = {**data[section], **values} if isinstance(values, dict) and section in data else values
    return from_mapping(data, "rescue.yaml")


def run(scenario: Any) -> list[StepRecord]:
    simulation = Simulation(scenario)
    simulation.mission.start()
    records = [simulation.step()]
    while records[-1].mission.state != "ended":
        records.append(simulation.step())
    return records


def events(records: list[StepRecord], *kinds: str) -> list[tuple[str, str]]:
    return [(event.kind, event.subject) for record in records for event in record.events if event.kind in kinds]


def test_every_victim_passes_all_states_until_all_are_safe():
    records = run(rescue())
    assert records[-1].mission.victims == ("safe", "safe")
    assert records[-1].mission.end == "victims_safe"
    kinds = [f"victim_{state}" for state in ("located", "reported", "reached", "carried", "safe")]
    for name in ("ann", "bob"):
        assert [kind for kind, subject in events(records, *kinds) if subject == name] == kinds


def test_located_position_is_near_and_its_error_is_in_the_event():
    located = [event for record in run(rescue()) for event in record.events if event.kind == "victim_located"]
    for event in located:
        error_m = float(event.detail.split(", ")[-1].removesuffix(" m off"))
        assert event.detail.startswith(("robot 0 locates", "firefighter"))
        assert 0.0 <= error_m < 1.6


def test_someone_who_can_walk_follows_and_someone_else_is_carried():
    records = run(rescue())
    for name, index, farthest_m in (("ann", 0, 1.0), ("bob", 1, 2.5)):
        carried = [e for record in records for e in record.events if e.kind == "victim_carried" and e.subject == name]
        helper = carried[0].robot_id
        on_the_way = [record for record in records if record.mission.victims[index] == "carried"]
        poses = [(record, record.readings[helper].true_pose) for record in on_the_way]
        assert max(math.dist(r.victims[index].position, (pose.x_m, pose.y_m)) for r, pose in poses) < farthest_m


def test_each_of_two_firefighters_is_sent_to_another_victim():
    records = run(rescue())
    reached = [event for record in records for event in record.events if event.kind == "victim_reached"]
    assert len({event.robot_id for event in reached}) == 2


def test_both_methods_of_dispatch_save_everybody():
    assert (
        run(rescue(control={"algorithm": "cover", "dispatch": {"method": "hungarian"}}))[-1].mission.victims_saved == 2
    )


def test_firefighter_out_of_contact_finishes_the_last_order_and_returns():
    scenario = rescue(
        network={"link": "distance", "max_distance_m": 9.0, "endangered_below_dbm": -80.0},
        robots={"count": 0, "start": [4.0, 2.0, 0.0]},
        firefighters={"count": 1, "start": [3.0, 5.0, 0.0]},
    )
    records = run(scenario)
    assert records[-1].mission.victims == ("safe", "safe")


def test_firefighters_go_on_when_the_last_robot_has_gone():
    simulation = Simulation(rescue())
    simulation.mission.start()
    simulation.step()
    simulation.remove_robot(0)
    records = [simulation.step()]
    while records[-1].mission.state != "ended":
        records.append(simulation.step())
    assert records[-1].mission.end == "victims_safe"


def test_people_flee_through_the_open_door_and_wait_behind_a_closed_one():
    fleeing = [
        {"name": f"p{i}", "position": [20.0 + i, 3.0 + i], "flees": True, "speed_mps": 1.2, "calling": False}
        for i in range(3)
    ]
    mission = {"victims": fleeing, "exits": [{"name": "way_out", "center": [1.5, 8.5]}], "time_limit_s": 60.0}
    records = run(rescue(mission=mission))
    assert records[-1].mission.victims == ("safe",) * 3
    closed = {**HALL, "doors": [{**HALL["doors"][0], "closed": True}]}
    records = run(rescue(plan=closed, mission=mission))
    assert [kind for kind, _ in events(records, "person_enclosed")] == ["person_enclosed"] * 3
    assert [victim.position for victim in records[-1].victims] == [tuple(person["position"]) for person in fleeing]


def test_opening_a_door_lets_enclosed_people_flee():
    closed = {**HALL, "doors": [{**HALL["doors"][0], "closed": True}]}
    person = {"name": "eve", "position": [20.0, 3.0], "flees": True, "speed_mps": 1.2}
    mission = {"victims": [person], "exits": [{"name": "way_out", "center": [1.5, 8.5]}], "time_limit_s": 60.0}
    simulation = Simulation(rescue(plan=closed, mission=mission, firefighters={"count": 1, "searches": False}))
    simulation.mission.start()
    for _ in range(50):
        simulation.step()
    simulation.set_door("door", closed=False)
    for _ in range(300):
        record = simulation.step()
    assert record.mission.victims == ("safe",)


def test_people_whom_a_fire_encloses_wait_and_report_it():
    fire = {
        "fuel": [
            {
                "name": "pile",
                "polygon": [[14.0, 3.5], [16.0, 3.5], [16.0, 6.5], [14.0, 6.5]],
                "growth": "ultra_fast",
                "load_mj_m2": 2000.0,
            }
        ],
        "ignitions": [{"position": [14.5, 5.0]}],
    }
    person = {"name": "eve", "position": [28.0, 8.0], "flees": True, "flees_after_s": 60.0, "speed_mps": 1.2}
    mission = {"victims": [person], "exits": [{"name": "way_out", "center": [1.5, 8.5]}], "time_limit_s": 80.0}
    records = run(rescue(fire=fire, mission=mission, firefighters={"count": 1, "searches": False}))
    assert events(records, "person_enclosed") == [("person_enclosed", "eve")]
    enclosed = [any(event.kind == "person_enclosed" for event in record.events) for record in records].index(True)
    assert {record.victims[0].position for record in records[enclosed:]} == {records[enclosed].victims[0].position}


def test_removed_firefighter_leaves_the_victim_to_another():
    simulation = Simulation(rescue(mission={"victims": [{"name": "ann", "position": [12.0, 2.0]}]}))
    simulation.mission.start()
    record = simulation.step()
    while record.mission.victims != ("carried",):
        record = simulation.step()
    simulation.remove_robot(record.mission.task.assistance[0].robot_id)
    states = [simulation.step().mission.victims[0] for _ in range(2000)]
    assert states[0] == "waiting"
    assert states[-1] == "safe"


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (
            {"command_centre": "gate"},
            "command_centre: 'gate' is neither a robot nor a place; expected the id of a robot",
        ),
        ({"command_centre": 7}, "command_centre: there is no robot 7; expected 0 to 0, or [x, y]"),
        ({"command_centre": [0.1, 5.0]}, "command_centre: [0.1, 5]: the command centre of radius 0.3 m overlaps wall"),
        ({"command_centre": None}, "command_centre: missing; firefighters need the id of a robot"),
        ({"mission": {"saved_by": "robot"}}, "mission.saved_by: 'robot' does not fit"),
        ({"control": {"relays": 2}}, "control.relays: 2 is above the number of robots, 1"),
        ({"mission": {"victims": [{"name": "ann", "position": [12, 2], "flees": True}]}}, "there is no exit"),
        (
            {"firefighters": {"count": 90, "start": [3, 5, 0], "spacing_m": 3.0}},
            "firefighters.count: 90 firefighters 3 m",
        ),
    ],
)
def test_wrong_roles_are_one_line(changes, line):
    with pytest.raises((ScenarioError, PlacementError), match=r"^rescue\.yaml: ") as error:
        Simulation(rescue(**changes))
    assert line in str(error.value)
    assert "\n" not in str(error.value)

"""Rescues from the first call to safety: states, dispatch, contact, people who flee or follow."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.hazards import walking_speed_share
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


def started(scenario: Any) -> Simulation:
    simulation = Simulation(scenario)
    simulation.mission.start()
    return simulation


def until(simulation: Simulation, condition: Callable[[list[StepRecord]], bool]) -> list[StepRecord]:
    records = [simulation.step()]
    while not condition(records):
        records.append(simulation.step())
    return records


def has_ended(records: list[StepRecord]) -> bool:
    return records[-1].mission.state == "ended"


def is_carried(records: list[StepRecord]) -> bool:
    return records[-1].mission.victims == ("carried",)


def run(scenario: Any) -> list[StepRecord]:
    return until(started(scenario), has_ended)


def events(records: list[StepRecord], *kinds: str) -> list[tuple[str, str]]:
    return [(event.kind, event.subject) for record in records for event in record.events if event.kind in kinds]


@pytest.mark.slow
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


ANN = {"name": "ann", "position": [7.0, 2.0]}
EVE = {"name": "eve", "position": [7.0, 2.0], "flees": True, "flees_after_s": 60.0}


@pytest.mark.parametrize(
    ("near", "located"),
    [
        (ANN, [("victim_located", "ann")]),  # both robots hear her in the first step
        (EVE, []),  # she needs no help
    ],
)
def test_loud_voice_locates_only_the_victim_whose_voice_it_is(near, located):
    bob = {"name": "bob", "position": [24.0, 8.0]}
    exits = [{"name": "way_out", "center": [1.5, 8.5]}]
    mission = {"victims": [near, bob], "exits": exits, "rescue": {"sight_m": 0.0}}
    simulation = started(rescue(robots={"count": 2, "start": [5.0, 2.0, 0.0]}, mission=mission))
    first = simulation.step()
    assert [voice.local_best_level_db > 50.0 for voice in first.voices[:2]] == [True, True]
    records = [first, *(simulation.step() for _ in range(10))]
    assert events(records, "victim_located") == located
    # In a voice that is one step old, its victim is silent by now.
    simulation.hearing.sensor.set_silenced(())
    assert simulation.hearing.sensor.speaker(first.voices[0].local_best_m) == near["name"]
    first.sim_time_ns = records[-1].sim_time_ns + 100_000_000
    assert "victim_located" not in [event.kind for event in simulation.mission.step(first, first.decisions)]


def test_voice_through_a_wall_does_not_locate_who_is_nearer_than_the_one_who_is_heard():
    callers = [{"name": "near", "position": [15.5, 2.0]}, {"name": "loud", "position": [5.0, 2.0]}]
    voice = {"constant_db": [-78.0, -78.0], "exponent": [2.0, 2.0], "wall_loss_db": 30.0}
    mission = {"victims": callers, "rescue": {"sight_m": 0.0}}
    robots = {"count": 1, "start": [13.0, 2.0, 0.0]}
    simulation = started(rescue(robots=robots, firefighters={"count": 1}, mission=mission, voice=voice))
    record = simulation.step()
    # Eq. (7) at the loudest cell: 78 - 20 log10(6.626 m) from the west, 78 - 20 log10(3.877 m) - 30 through the wall.
    heard, field = record.voices[0], simulation.hearing.sensor
    assert heard.local_best_m == (11.625, 1.875)
    assert heard.local_best_level_db == pytest.approx(61.57, abs=0.01)
    assert field.speaker(heard.local_best_m) == "loud"
    assert events([record], "victim_located", "victim_heard") == [("victim_heard", "loud"), ("victim_located", "loud")]
    field.set_silenced(["loud"])
    assert field.map().value_at(*heard.local_best_m) == pytest.approx(36.23, abs=0.01)
    assert field.speaker(heard.local_best_m) == "near"


@pytest.mark.slow
def test_someone_who_can_walk_follows_and_someone_else_is_carried():
    records = run(rescue())
    for name, index, farthest_m in (("ann", 0, 1.0), ("bob", 1, 2.5)):
        carried = [e for record in records for e in record.events if e.kind == "victim_carried" and e.subject == name]
        helper = carried[0].robot_id
        on_the_way = [record for record in records if record.mission.victims[index] == "carried"]
        poses = [(record, record.readings[helper].true_pose) for record in on_the_way]
        assert max(math.dist(r.victims[index].position, (pose.x_m, pose.y_m)) for r, pose in poses) < farthest_m


@pytest.mark.slow
def test_each_of_two_firefighters_is_sent_to_another_victim():
    records = run(rescue())
    reached = [event for record in records for event in record.events if event.kind == "victim_reached"]
    assert len({event.robot_id for event in reached}) == 2


def test_both_methods_of_dispatch_save_everybody():
    assert run(rescue(firefighters={"dispatch": {"method": "hungarian"}}))[-1].mission.victims_saved == 2


@pytest.mark.slow
def test_firefighter_out_of_contact_finishes_the_last_order_and_returns():
    scenario = rescue(
        network={"link": "distance", "max_distance_m": 9.0, "endangered_below_dbm": -80.0},
        robots={"count": 0, "start": [4.0, 2.0, 0.0]},
        firefighters={"count": 1, "start": [3.0, 5.0, 0.0]},
    )
    records = run(scenario)
    assert records[-1].mission.victims == ("safe", "safe")


@pytest.mark.slow
def test_firefighters_go_on_when_the_last_robot_has_gone():
    simulation = started(rescue())
    simulation.step()
    simulation.remove_robot(0)
    assert until(simulation, has_ended)[-1].mission.end == "victims_safe"


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_removed_firefighter_leaves_the_victim_to_another():
    simulation = started(rescue(mission={"victims": [{"name": "ann", "position": [12.0, 2.0]}]}))
    simulation.remove_robot(until(simulation, is_carried)[-1].mission.task.assistance[0].robot_id)
    states = [record.mission.victims[0] for record in until(simulation, has_ended)]
    assert states[0] == "waiting"
    assert states[-1] == "safe"


PILE = {
    "fuel": [{"name": "pile", "center": [14.0, 5.0], "radius_m": 1.0, "growth": "ultra_fast", "load_mj_m2": 2000.0}],
    "ignitions": [{"position": [14.0, 5.0]}],
}
WATCHED = {"victims": [{"name": "ann", "position": [28.0, 9.0], "calling": False}], "autostart": False}


def near_the_pile(**changes: Any) -> Simulation:
    """A firefighter 5 m from a fire, without an order."""
    firefighters = {"count": 1, "start": [10.0, 8.0, 0.0], "searches": False, **changes.pop("firefighters", {})}
    return Simulation(rescue(firefighters=firefighters, mission=WATCHED, **changes))


def until_collapse(simulation: Simulation) -> StepRecord | None:
    simulation.mission.start()
    for _ in range(2500):
        record = simulation.step()
        if events([record], "firefighter_collapsed"):
            return record
    return None


@pytest.mark.slow
def test_smoke_harms_only_firefighters_without_breathing_apparatus():
    fire = {**PILE, "casualties": {"collapse_dose": 0.005}, "heat": {"flame_c": 100.0, "convective_share": 0.0}}
    alone = {"fire": fire, "robots": {"count": 0}}
    assert until_collapse(near_the_pile(**alone)) is None
    record = until_collapse(near_the_pile(**alone, firefighters={"breathing_apparatus": False}))
    assert record is not None
    assert [event.detail for event in record.events] == ["firefighter 0 collapses"]
    assert record.failed == {0}
    # By hand: 2.764e-5 c^1.036 per minute, in steps of a second.
    place, dose, replay = np.array([[10.0, 8.0]]), 0.0, near_the_pile(**alone)
    for _ in range(record.step_index):
        hazards = replay.step().hazards
        if hazards is not None:
            dose += 2.764e-5 * float(hazards.co_ppm(place)[0]) ** 1.036 / 60.0
    assert 0.005 <= dose < 0.0052


@pytest.mark.slow
def test_heat_makes_firefighters_collapse_in_spite_of_their_apparatus():
    fire = {**PILE, "casualties": {"collapse_dose": 0.005}, "heat": {"robot_endures_s": 0.0, "robot_limit_c": 21.0}}
    record = until_collapse(near_the_pile(fire=fire, robots={"count": 0}))
    assert record is not None
    assert record.sim_time_s > 60.0  # the limit of robots does not count for people


def test_smoke_slows_firefighters():
    soot = {"yield_g_g": 0.3}
    simulation = near_the_pile(fire={**PILE, "soot": soot}, robots={"count": 0}, firefighters={"searches": True})
    for _ in range(900):
        field = simulation.step().hazards or simulation.hazards.field
    simulation.mission.start()
    fastest, share = 0.0, walking_speed_share(field.extinction_per_m(np.array([[10.0, 8.0]])))[0]
    for _ in range(5):
        pose = simulation.world.poses()[0]
        simulation.step()
        moved = simulation.world.poses()[0]
        fastest = max(fastest, math.hypot(moved.x_m - pose.x_m, moved.y_m - pose.y_m) / 0.1)
    assert 0.1 < share < 0.8
    assert 0.5 * 1.3 * share < fastest <= 1.3 * share + 1e-6


@pytest.mark.slow
def test_firefighter_stays_out_of_a_fire_that_fills_the_path_to_the_victim():
    barrier = {"name": "barrier", "polygon": [[13.0, 0.3], [17.0, 0.3], [17.0, 9.7], [13.0, 9.7]]}
    fire = {**PILE, "fuel": [{**barrier, "growth": "ultra_fast", "load_mj_m2": 4000.0}]}
    simulation = Simulation(
        rescue(
            fire=fire,
            robots={"count": 0},
            firefighters={"count": 1, "start": [4.0, 8.0, 0.0], "sensors": [{"kind": "heat", "range_m": 12.0}]},
            mission={"victims": [{"name": "ann", "position": [26.0, 2.0]}], "autostart": False},
        )
    )
    for _ in range(1500):
        simulation.step()
    simulation.mission.start()
    records = [simulation.step() for _ in range(1500)]
    assert not events(records, "firefighter_collapsed", "victim_reached")
    assert records[-1].is_there(0)


def test_collapsed_victim_whom_a_firefighter_leaves_stays_silent():
    fire = {**PILE, "casualties": {"collapse_dose": 1e-9}}
    simulation = started(rescue(fire=fire, mission={"victims": [{"name": "ann", "position": [12.0, 2.0]}]}))
    records = until(simulation, lambda records: is_carried(records) and bool(events(records, "victim_collapsed")))
    simulation.remove_robot(records[-1].mission.task.assistance[0].robot_id)
    record = simulation.step()
    assert events([record], "victim_left") == [("victim_left", "ann")]
    assert record.mission.victims == ("collapsed",)
    assert simulation.mission.silent_victims == ("ann",)


def test_collapsed_victim_is_carried_even_if_they_could_walk():
    fire = {**PILE, "casualties": {"collapse_dose": 1e-9}}
    bob = {"name": "bob", "position": [12.0, 2.0], "can_walk": True}
    records = until(started(rescue(fire=fire, mission={"victims": [bob]})), is_carried)
    assert events(records, "victim_collapsed") == [("victim_collapsed", "bob")]
    (event,) = [e for e in records[-1].events if e.kind == "victim_carried"]
    assert event.detail == f"firefighter {event.robot_id} carries bob"


def test_victim_who_collapses_while_a_firefighter_leads_them_is_carried_from_then_on():
    ignition = {"at_s": 5.0, "position": [14.0, 5.0]}
    fire = {**PILE, "ignitions": [ignition], "casualties": {"collapse_dose": 1e-9}}
    bob = {"name": "bob", "position": [12.0, 2.0], "can_walk": True}
    simulation = Simulation(rescue(fire=fire, mission={"victims": [bob], "rescue": {"pick_up_s": 1.0}}))
    simulation.mission.start()
    led, carried = [], []
    for _ in range(3000):
        record = simulation.step()
        if record.mission.victims == ("safe",):
            break
        for assistance in record.mission.task.assistance:
            helper = record.readings[assistance.robot_id].true_pose
            apart_m = math.dist(record.victims[0].position, (helper.x_m, helper.y_m))
            if assistance.moving:
                (carried if assistance.collapsed else led).append(apart_m)
    assert record.mission.victims == ("safe",)
    assert min(led) > 0.3
    assert len(carried) > 10
    assert min(carried[10:]) < 1e-6


@pytest.mark.slow
def test_firefighter_without_an_order_leaves_a_place_that_becomes_hot():
    simulation = near_the_pile(
        fire={**PILE, "casualties": {"collapse_dose": 100.0, "lethal_dose": 100.0}},
        robots={"count": 0},
        firefighters={"start": [12.0, 4.6, 0.0], "sensors": [{"kind": "heat", "range_m": 8.0}]},
    )
    for _ in range(1200):
        simulation.step()

    def is_hot() -> bool:
        pose = simulation.world.poses()[0]
        return bool(simulation.hazards.field.temperature_c(np.array([[pose.x_m, pose.y_m]]))[0] > 100.0)

    assert simulation.scenario.firefighters.block_c == 100.0
    assert is_hot()
    simulation.mission.start()
    hot = []
    for _ in range(600):  # the fire grows and heats its next place, too: it leaves again, each time within 5 s
        simulation.step()
        hot.append(is_hot())
    assert max(len(list(spell)) for is_one, spell in itertools.groupby(hot) if is_one) <= 50
    assert not any(hot[-200:])


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
        (
            {"mission": {"saved_by": "robot"}},
            "mission.saved_by: 'robot' is not allowed with firefighters; expected 'firefighter'",
        ),
        ({"relays": {"count": 2}}, "relays.count: 2 is above the number of robots, 1"),
        ({"mission": {"victims": [{"name": "ann", "position": [12, 2], "flees": True}]}}, "there is no exit"),
        (
            {"mission": {"victims": [{"name": n, "position": [12, 2], "can_walk": True} for n in ("ann", "bob")]}},
            "mission.victims.1.position: [12, 2]: 'bob' of radius 0.15 m overlaps 'ann'",
        ),
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

"""How people leave with and without a team: exits always count, and robots save only those who do not flee."""

from __future__ import annotations

import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.mission.egress import AT_CENTRE
from robotteamsim.scenario import from_mapping
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, Simulation

CORRIDOR = {"name": "corridor", "bounds": {"max": [20, 6]}}
WEST = {"name": "west", "center": [2, 3], "radius_m": 1.0}


def ann(**keys: object) -> dict[str, object]:
    return {"name": "ann", "position": [12, 3], "flees": True, "speed_mps": 1.0, **keys}


def egress(victims: list[dict[str, object]], sections: dict[str, object] | None = None, **mission: object) -> Scenario:
    section = {"victims": victims, "exits": [WEST], "walk_update_s": 0.1, "time_limit_s": 60.0, **mission}
    return from_mapping({"name": "egress", "plan": CORRIDOR, "mission": section, **(sections or {})}, "egress")


def run(*arguments: object, **keys: object) -> Result:
    return Simulation(egress(*arguments, **keys)).run()


@pytest.mark.parametrize("flees_after_s", [0.0, 5.0])
def test_one_person_needs_their_reaction_time_and_the_way_at_their_speed(flees_after_s):
    # From x = 12 m to the edge of the exit at x = 3 m, at 1 m/s.
    result = run([ann(flees_after_s=flees_after_s)])
    assert result.egress.rset_s == pytest.approx(flees_after_s + 9.0, abs=0.2)
    assert result.egress.num_out == {"west": 1}
    assert (result.end, result.victims_saved, result.robots) == ("victims_safe", 1, ())


def test_last_of_several_sets_the_required_time():
    result = run([ann(), ann(name="bob", position=[16, 5], speed_mps=0.8), ann(name="eve", position=[2.5, 3])])
    # (16 - 2, 5 - 3) is 14.14 m off, the exit begins 1 m earlier: 13.14 / 0.8 s. Paths on a grid are a little longer.
    assert result.egress.rset_s == pytest.approx(16.4, rel=0.03)
    assert result.egress.people[2].out_s == pytest.approx(0.0, abs=0.2)


@pytest.mark.parametrize("saved_by", [{}, {"saved_by": "robot"}])
def test_robots_do_not_save_those_who_flee(saved_by):
    robots = {"robots": [{"start_pose": [11.2, 3.6, 0.0]}], "control": {"algorithm": "random_walk"}}
    result = run([ann(flees_after_s=4.0)], robots, **saved_by)
    assert result.egress.people[0].exit == "west"
    assert result.egress.rset_s == pytest.approx(13.0, abs=1.0)


def test_robot_saves_one_who_does_not_flee_and_the_mission_goes_on_until_all_have_left():
    robots = {"robots": [{"start_pose": [11.0, 3.0, 0.0]}], "control": {"algorithm": "random_walk"}}
    hurt = {"name": "jim", "position": [11.3, 3.6]}
    result = run([ann(), hurt], robots)
    assert (result.end, result.victims_saved) == ("victims_safe", 2)
    assert result.egress.num_out == {"west": 1}
    assert result.egress.rset_s == pytest.approx(9.0, abs=1.0)


def test_areas_do_not_end_a_mission_while_somebody_flees():
    robots = {"robots": [{"start_pose": [17.0, 1.0, 0.0]}], "control": {"algorithm": "random_walk"}}
    area = {"name": "here", "center": [17.0, 1.0], "radius_m": 2.0}
    result = run([ann()], robots, areas=[area])
    assert result.end == "areas_explored"
    assert result.time_s == pytest.approx(9.0, abs=0.3)
    assert result.egress.rset_s == pytest.approx(9.0, abs=0.3)


ROOM = {
    **CORRIDOR,
    "walls": [{"name": "low", "from": [10, 0], "to": [10, 2]}, {"name": "high", "from": [10, 4], "to": [10, 6]}],
    "doors": [{"name": "door", "from": [10, 2], "to": [10, 4], "closed": True}],
}
"""The exit is west of a closed door, and ann is east of it."""


def test_areas_end_a_mission_though_somebody_is_enclosed():
    robots = {"plan": ROOM, "robots": [{"start_pose": [5.0, 1.0, 0.0]}], "control": {"algorithm": "random_walk"}}
    result = run([ann()], robots, areas=[{"name": "here", "center": [5.0, 1.0], "radius_m": 2.0}])
    assert result.end == "areas_explored"
    assert result.time_s < 2.0


def test_mission_goes_on_while_somebody_who_was_located_flees_though_the_team_has_left():
    sections = {
        "plan": ROOM,
        "command_centre": [7.0, 1.0],
        "firefighters": {"count": 1, "start": [16.0, 1.0, 0.0]},
        "robots": {"count": 0},
    }
    simulation = Simulation(egress([ann()], sections, saved_by="firefighter"))
    while "located" not in simulation.mission.status.victims:
        simulation.step()
    simulation.set_door("door", closed=False)
    for member in range(simulation.scenario.team_size):
        simulation.remove_robot(member)
    while simulation.mission.status.state != "ended":
        simulation.step()
    assert simulation.mission.status.end == "victims_safe"
    assert simulation.mission.egress.num_out == {"west": 1}


@pytest.mark.parametrize(("opens", "end", "rset_s"), [([], "time_limit", None), ([30.0], "victims_safe", 39.0)])
def test_one_who_is_enclosed_may_leave_when_a_door_opens(opens, end, rset_s):
    schedule = [{"at_s": at_s, "door": "door", "closed": False} for at_s in opens]
    result = run([ann()], {"plan": ROOM, "schedule": schedule})
    assert result.end == end
    assert result.egress.rset_s == (None if rset_s is None else pytest.approx(rset_s, abs=0.3))


def test_command_centre_is_no_exit_of_those_who_flee():
    """The way leads through the centre, which is safe for those whom a firefighter brings only."""
    sections = {
        "command_centre": [7.0, 1.0],
        "firefighters": {"count": 1, "start": [18.0, 1.0, 0.0]},
        "robots": {"count": 0},
    }
    result = run([ann()], sections, saved_by="firefighter", rescue={"safe_m": 4.0})
    assert result.egress.num_out == {"west": 1}
    assert AT_CENTRE not in result.egress.num_out
    assert result.egress.rset_s == pytest.approx(9.0, abs=0.3)


def test_fire_counts_in_a_study_without_robots():
    fuel = {"name": "bin", "center": [19, 5], "radius_m": 0.5, "growth": "fast"}
    fire = {"fire": {"fuel": [fuel], "ignitions": [{"at_s": 3.0, "position": [19.1, 5.1]}]}}
    result = run([ann(flees_after_s=5.0)], fire)
    assert result.egress.ignition_s == pytest.approx(3.0, abs=0.2)
    assert result.egress.rset_s == pytest.approx(14.0 - result.egress.ignition_s, abs=0.2)


@pytest.mark.parametrize(("update_s", "at_s", "ignition_s"), [(1, 0, 0), (1, 3, 3), (1, 3.4, 4), (2, 0, 0), (2, 3, 4)])
def test_egress_times_count_from_the_same_ignition_however_it_is_written(update_s, at_s, ignition_s):
    fuel = {"name": "bin", "center": [19, 5], "radius_m": 0.5, "growth": "fast"}
    fire = {"fuel": [fuel], "update_s": update_s}
    listed = {"fire": {**fire, "ignitions": [{"at_s": at_s, "position": [19.1, 5.1]}]}}
    scheduled = {"fire": fire, "schedule": [{"at_s": at_s, "ignite": [19.1, 5.1]}]}
    results = [run([ann(flees_after_s=5.0)], sections) for sections in (listed, scheduled)]
    assert [result.egress.ignition_s for result in results] == pytest.approx([ignition_s, ignition_s])


@pytest.mark.parametrize(
    ("sections", "mission", "message"),
    [
        ({}, {"exits": []}, r"robots: missing; expected a team of equal robots, or a list"),
        ({"robots": {"count": 0}}, {"exits": []}, r"robots\.count: 0 is below 1"),
        ({}, {"areas": [{"name": "a", "center": [3, 3]}]}, r"mission\.areas: needs robots or firefighters"),
        ({}, {"random_victims": 2}, r"mission\.random_victims: needs robots or firefighters"),
        ({}, {"base": 0}, r"mission\.base: needs robots or firefighters"),
        ({"command_centre": [7, 3]}, {}, r"command_centre: needs robots or firefighters"),
    ],
)
def test_what_needs_a_team_is_refused_without_one_in_one_line(sections, mission, message):
    victims = [] if mission.get("exits") == [] else [ann()]
    with pytest.raises(ScenarioError, match=message) as caught:
        egress(victims, sections, **mission)
    assert "\n" not in str(caught.value)

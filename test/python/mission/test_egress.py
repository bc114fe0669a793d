"""Required and available safe egress times, and people out by exit."""

import pytest

from robotteamsim.mission.egress import AT_CENTRE, Egress, ExitEgress, PersonEgress


def person(name: str, flees: bool = True, **values) -> PersonEgress:
    return PersonEgress(name, flees, **values)


ANN = person("ann", out_s=30.0, exit="west")
BOB = person("bob", out_s=42.0, exit="east", untenable_s=40.0, gas=0.1, heat=0.3)
EVE = person("eve", flees=False, out_s=90.0, exit=AT_CENTRE, untenable_s=25.0)
JIM = person("jim")
EXITS = (ExitEgress("west"), ExitEgress("east"), ExitEgress("north"))


@pytest.mark.parametrize(
    ("people", "ignition_s", "rset_s", "aset_s"),
    [
        ((ANN, BOB), 10.0, 32.0, 30.0),
        ((ANN, BOB, EVE), 10.0, 32.0, 30.0),  # eve does not flee
        ((EVE,), 10.0, 80.0, 15.0),  # nobody flees, so everybody counts
        ((ANN,), 10.0, 20.0, None),
        ((ANN, JIM), 10.0, None, None),  # jim is still inside
        ((ANN, BOB), None, 42.0, 40.0),  # without a fire, from the start of the mission
        ((), 10.0, None, None),
    ],
)
def test_egress_times_are_those_of_the_last_and_the_first_who_flee(people, ignition_s, rset_s, aset_s):
    egress = Egress(ignition_s, people, EXITS)
    assert (egress.rset_s, egress.aset_s) == (rset_s, aset_s)


def test_people_out_are_counted_by_exit_and_at_the_centre():
    egress = Egress(0.0, (ANN, BOB, EVE, JIM), EXITS)
    assert egress.num_out == {"west": 1, "east": 1, "north": 0, AT_CENTRE: 1}
    assert egress.num_untenable == 1
    values = egress.values()
    assert values["out"] == egress.num_out
    assert values["people"][1] == {
        "name": "bob",
        "flees": True,
        "gas": 0.1,
        "heat": 0.3,
        "visibility_m": 30.0,
        "least_visibility_m": 30.0,
        "untenable_s": 40.0,
        "out_s": 42.0,
        "exit": "east",
    }

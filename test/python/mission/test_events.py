"""Events are values with a name for files and words for people."""

import math

import pytest

from robotteamsim.mission import events, team_events
from robotteamsim.mission.events import Event, Happening, LinkEndangered, VictimDied, VictimLocated


def name(robot_id: int) -> str:
    return {4: "firefighter 0"}.get(robot_id, f"robot {robot_id}")


def classes_of_events():
    """Return the classes with a kind; the others are bases."""
    everything = {**vars(events), **vars(team_events)}.values()
    classes = [found for found in everything if isinstance(found, type) and issubclass(found, Happening)]
    return [found for found in classes if found.__struct_config__.tag is not None]


def test_each_event_has_a_kind_of_its_own():
    kinds = [found.__struct_config__.tag for found in classes_of_events()]
    assert len(set(kinds)) == len(kinds) > 40


@pytest.mark.parametrize("event", classes_of_events())
def test_each_event_has_words(event):
    assert event.template or event._words is not Happening._words


def test_event_has_its_values_and_its_words():
    located = VictimLocated("ann", "sight", 0.304, robot_id=4)
    event = Event(2.5, located, located.words(name))
    assert event.row() == {
        "time_s": 2.5,
        "kind": "victim_located",
        "subject": "ann",
        "robot_id": 4,
        "detail": "firefighter 0 locates ann by sight, 0.30 m off",
    }


def test_link_without_a_signal_is_lost_at_no_level():
    assert LinkEndangered(0, 2, lost=True, rssi_dbm=math.nan).words(name) == "link 0-2 is lost"


def test_death_is_reported_with_both_doses():
    died = VictimDied("bob", gas=1.0, heat=0.256)
    assert (died.kind, died.words(name)) == ("victim_dead", "bob dies: FED 1.00 from gas, 0.26 from heat")

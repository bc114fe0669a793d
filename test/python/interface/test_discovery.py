"""Announcements of discoveries and their acknowledgements, as text."""

from __future__ import annotations

import json

import msgspec
import pytest

from robotteamsim.control.cover.floor_cover import CoverUpdate
from robotteamsim.interface.discovery import (
    Discovery,
    acknowledged_in,
    acknowledgement,
    announced_in,
    announcement,
)

ANN = Discovery("victim", "ann", 1, (9.0, 4.0), 12.5)
EAST = Discovery("area", "east", 1, (16.0, 5.0), 20.0)


def is_announced(payload: str, discovery: Discovery) -> bool:
    return any(found.means(discovery, within_m=1.0) for found in announced_in(payload))


def test_announcement_has_all_that_is_known_of_a_discovery():
    assert json.loads(announcement(ANN)) == {
        "discoveries": [{"kind": "victim", "name": "ann", "robot_id": 1, "position_m": [9.0, 4.0], "time_s": 12.5}]
    }


def test_announcement_means_the_discovery_of_its_kind_and_name():
    assert is_announced(announcement(ANN), ANN)
    assert is_announced('{ "discoveries" : [{"name": "ann", "kind": "victim"}], "of": "mine" }', ANN)
    assert not is_announced(announcement(ANN), EAST)
    assert not is_announced(announcement(msgspec.structs.replace(ANN, kind="area")), ANN)


@pytest.mark.parametrize(("x_m", "is_near"), [(9.9, True), (10.1, False)])
def test_victim_without_a_name_is_meant_by_its_position(x_m, is_near):
    victims = Discovery("victim", "", 1, (1.0, 1.0), 3.0), Discovery("victim", "", 1, (x_m, 4.0), 12.5)
    payload = CoverUpdate(2, (1.0, 4.0), None, "00", victims).to_json()
    assert is_announced(payload, ANN) is is_near
    assert not is_announced(payload, msgspec.structs.replace(EAST, position_m=(9.0, 4.0)))


@pytest.mark.parametrize(
    "payload",
    [
        "",
        "ann",
        "[1]",
        '{"discoveries"',
        '{"discoveries": 3}',
        '{"discoveries": [{"kind": "victim"}]}',
        '{"discoveries": [{"kind": "dog", "name": "ann"}]}',
        '{"discoveries": [{"kind": "victim", "name": "ann", "position_m": [NaN, 0]}]}',
        '{"discoveries": [{"kind": "victim", "position_m": [1e999, 0]}]}',
        '{"discoveries": ' + "[" * 100_000,
        '{"discoveries": [{"kind": "victim", "name": "\ud800"}]}',
    ],
)
def test_other_messages_announce_nothing(payload):
    assert not is_announced(payload, ANN)


def test_acknowledgement_names_the_discovery():
    assert acknowledged_in(acknowledgement("victim", "ann")) == ("victim", "ann")
    assert json.loads(acknowledgement("area", "east")) == {"delivered": {"kind": "area", "name": "east"}}


@pytest.mark.parametrize("payload", ["", '{"delivered": 3}', '{"delivered": {"kind": "victim"}}', announcement(ANN)])
def test_other_messages_acknowledge_nothing(payload):
    assert acknowledged_in(payload) is None

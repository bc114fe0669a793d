"""What robots of a swarm send each other, as text."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from robotteamsim.control.rdpso.team import Best, RdpsoUpdate, Sighting, parse_update, update_of
from robotteamsim.interface import EVERYBODY, OUTSIDE, Message
from robotteamsim.swarm import SwarmState


def random_update(rng: np.random.Generator) -> RdpsoUpdate:
    def place() -> tuple[float, float]:
        x, y = (rng.normal(size=2) * 10.0 ** rng.integers(-8, 6)).tolist()
        return x, y

    def best() -> Best | None:
        return Best(float(rng.normal()), place()) if rng.random() < 0.7 else None

    return RdpsoUpdate(
        robot_id=int(rng.integers(100)),
        iteration=int(rng.integers(1000)),
        epoch=int(rng.integers(9)),
        position=place(),
        loudest=place() if rng.random() < 0.5 else None,
        local_best=best(),
        known_best=best(),
        swarm_id=int(rng.integers(OUTSIDE, 4)),
        swarm=SwarmState(int(rng.integers(15)), int(rng.integers(5))),
        doors=(Sighting('a "b"', True, 3), Sighting("ß", False, 0)) if rng.random() < 0.3 else (),
    )


@pytest.mark.parametrize("seed", range(100))
def test_update_keeps_every_bit_as_text(seed):
    update = random_update(np.random.default_rng(seed))
    assert parse_update(update.to_json()) == update
    # Another JSON library may have written it, with other spaces and digits.
    assert parse_update(json.dumps(json.loads(update.to_json()))) == update


def changed(**values: object) -> str:
    """Return an update in which some keys have other values."""
    document = json.loads(random_update(np.random.default_rng(0)).to_json())
    return json.dumps(document | values)


@pytest.mark.parametrize(
    "payload",
    [
        "",
        "hello",
        "[]",
        "3",
        '{"type": "rdpso"}',
        '{"type": "rdpso", "robot_id": "x"}',
        "[" * 100_000,
        '{"type": "rdpso", "doors": ' + "[" * 100_000,
        "\ud800",
        changed(type="cover"),
        changed(robot_id=-1),
        changed(robot_id=2**31),
        changed(robot_id=1.5),
        changed(iteration=True),
        changed(epoch=10**30),
        changed(position=[math.nan, 0.0]),
        changed(position=[math.inf, 0.0]),
        changed(position=[1e300, 0.0]),
        changed(position=[1.0]),
        changed(loudest=[1.0, 2.0, 3.0]),
        changed(local_best={"value": 1e300, "position": [0.0, 0.0]}),
        changed(known_best=[1.0, 2.0, 3.0]),
        changed(swarm_id=-2),
        changed(swarm={"search_counter": -1, "num_killed": 0}),
        changed(swarm={"search_counter": 0, "num_killed": -1}),
        changed(doors=[{"door": 3, "closed": True, "iteration": 0}]),
        changed(position=[0.0, 0.0]).replace("0.0]", "1e999]"),
    ],
)
def test_payload_that_is_not_a_valid_update_is_ignored(payload):
    assert parse_update(payload) is None


def test_unknown_keys_are_ignored():
    assert parse_update(changed(colour="red")) == random_update(np.random.default_rng(0))


def test_robot_sends_updates_of_itself_only():
    update = random_update(np.random.default_rng(0))
    assert update_of(Message(update.robot_id, EVERYBODY, update.to_json())) == update
    assert update_of(Message(update.robot_id + 1, EVERYBODY, update.to_json())) is None
    assert update_of(Message(0, EVERYBODY, "hello")) is None


def test_local_best_without_a_place_is_worth_less_than_any_other():
    worst = Best(-1e9, (0.0, 0.0))
    update = random_update(np.random.default_rng(0))
    values = [RdpsoUpdate(0, 0, 0, update.position, None, best, None, 0, SwarmState()).value for best in (None, worst)]
    assert values[0] < values[1]

"""What robots of a swarm send each other, remember of their team, and conclude from it."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from robotteamsim.control.rdpso.team import (
    Best,
    CommonView,
    RdpsoUpdate,
    Sighting,
    TeamMemory,
    parse_update,
    update_of,
)
from robotteamsim.interface import EVERYBODY, OUTSIDE, Message
from robotteamsim.network.messages import Batch
from robotteamsim.swarm import SwarmState


def update(robot_id: int, iteration: int = 1, swarm_id: int = 0, **changes: object) -> RdpsoUpdate:
    """Return the update of a robot that hears nothing, at a place that tells robot and iteration."""
    fields = {
        "epoch": 1,
        "position": (float(robot_id), float(iteration)),
        "loudest": None,
        "local_best": None,
        "known_best": None,
        "swarm": SwarmState(robot_id, 0),
    }
    return RdpsoUpdate(robot_id=robot_id, iteration=iteration, swarm_id=swarm_id, **(fields | changes))


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
    sent = random_update(np.random.default_rng(seed))
    assert parse_update(sent.to_json()) == sent
    # Another JSON library may have written it, with other spaces and digits.
    assert parse_update(json.dumps(json.loads(sent.to_json()))) == sent


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
    assert update_of(Message(3, EVERYBODY, update(3).to_json())) == update(3)
    assert update_of(Message(4, EVERYBODY, update(3).to_json())) is None
    assert update_of(Message(0, EVERYBODY, "hello")) is None


def test_local_best_without_a_place_is_worth_less_than_any_other():
    worst = Best(-1e9, (0.0, 0.0))
    values = [update(0, local_best=best).value for best in (None, worst)]
    assert values[0] < values[1]


def batch(*updates: RdpsoUpdate) -> Batch:
    return Batch(tuple(Message(each.robot_id, EVERYBODY, each.to_json()) for each in updates))


def test_memory_keeps_the_last_update_of_each_robot_in_id_order():
    memory = TeamMemory().after(batch(update(2), update(3))).after(batch(update(0, 2), update(2, 2)))
    assert memory.updates == (update(0, 2), update(2, 2), update(3))
    assert memory.by_id[3] == update(3)


def test_robots_that_heard_the_same_share_one_memory_and_one_view():
    start = [TeamMemory().after(batch(update(0), update(1))) for _ in range(2)]
    heard = [memory.after(batch(update(0, 2), update(1, 2))) for memory in start]
    assert heard[0] is heard[1]
    assert heard[0].view(2) is heard[1].view(2)
    assert heard[0].view(2).updates == (update(0, 2), update(1, 2))


def test_messages_without_updates_change_nothing():
    memory = TeamMemory().after(batch(update(0)))
    assert memory.after(Batch((Message(1, EVERYBODY, "hello"), Message(2, EVERYBODY, update(1).to_json())))) is memory


def test_own_update_is_added_unless_it_is_there():
    memory = TeamMemory().after(batch(update(0), update(1)))
    assert memory.with_update(update(1)) is memory
    assert memory.with_update(update(1, 2)).updates == (update(0), update(1, 2))
    assert memory.updates == (update(0), update(1)), "memories are shared and never change"


def test_robot_waits_for_others_only():
    memory = TeamMemory().after(batch(update(0, 4), update(1, 3), update(2, 3)))
    assert memory.has_others_of(3, 1)
    assert memory.has_others_of(3, 0)
    assert not memory.after(batch(update(2, 4))).has_others_of(3, 1)
    assert not memory.has_others_of(4, 0)


def test_view_holds_the_updates_of_its_iteration_and_memory_the_swarms_of_all():
    memory = TeamMemory().after(batch(update(0, 4, 1), update(1, 3, 2), update(2, 4, 1)))
    assert memory.view(4).updates == (update(0, 4, 1), update(2, 4, 1))
    assert memory.swarm_ids == {1, 2}
    assert {i: memory.places.by_id[i] for i in (0, 1)} == {0: (0.0, 4.0), 1: (1.0, 3.0)}


def test_each_swarm_has_its_members_and_the_memory_of_the_lowest():
    view = CommonView(
        (update(0, 3, 1), update(1, 3, 0, local_best=Best(-2.0, (0.0, 0.0))), update(2, 3, 1), update(3, 3, OUTSIDE))
    )
    assert view.values == {1: {0: float("-inf"), 2: float("-inf")}, 0: {1: -2.0}, OUTSIDE: {3: float("-inf")}}
    assert view.places[1].by_id == {0: (0.0, 3.0), 2: (2.0, 3.0)}
    assert dict(view.others(1, own_id=2)) == {0: (0.0, 3.0)}
    assert view.others(1, own_id=2).nearest((2.0, 3.0)) == (0.0, 3.0)
    assert len(view.others(1, own_id=1)) == 2
    assert not view.others(7, own_id=0)
    assert {swarm_id: state.search_counter for swarm_id, state in view.states.items()} == {1: 0, 0: 1, OUTSIDE: 3}


def test_bests_come_highest_first_and_the_excluded_add_voices_but_no_distances():
    far, near, voice = Best(-9.0, (1.0, 0.0)), Best(-4.0, (2.0, 0.0)), Best(30.0, (3.0, 0.0))
    updates = (
        update(0, local_best=far),
        update(1, local_best=near),
        update(2, swarm_id=OUTSIDE, local_best=Best(-1.0, (0.0, 0.0))),
        update(3, swarm_id=OUTSIDE, local_best=voice),
    )
    _, bests = CommonView(updates).comparable(updates[0])
    assert bests[0].local == (voice, near, far)
    assert bests[OUTSIDE].local == (voice,)


def test_only_robots_of_the_same_task_and_doors_are_compared():
    door = (Sighting("door", True, 2),)
    updates = (update(0), update(1, epoch=2), update(2, doors=door), update(3, loudest=(5.0, 5.0)))
    view = CommonView(updates)
    assert view.comparable(updates[0])[0].notes == [((0.0, 1.0), None), ((3.0, 1.0), (5.0, 5.0))]
    assert view.comparable(updates[2])[0].notes == [((2.0, 1.0), None)]
    assert view.doors == door

"""What robots remember of their team, and share."""

from __future__ import annotations

from robotteamsim.control.rdpso.team import RdpsoUpdate, TeamMemory
from robotteamsim.interface import EVERYBODY, Message
from robotteamsim.network.messages import Batch
from robotteamsim.swarm import SwarmState


def update(robot_id: int, iteration: int = 1, swarm_id: int = 0) -> RdpsoUpdate:
    place = (float(robot_id), float(iteration))
    return RdpsoUpdate(robot_id, iteration, 1, place, None, None, None, swarm_id, SwarmState())


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
    assert memory.positions(without=2) == {0: (0.0, 4.0), 1: (1.0, 3.0)}

"""Discoveries are delivered to the base, whichever controllers the robots have."""

from __future__ import annotations

import json

import msgspec
import pytest

from robotteamsim.control import make_controller
from robotteamsim.control.cover.controller import CoverController
from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.runtime.base_station import Acknowledger, Announcer, StandingBase
from robotteamsim.interface import Decision, Discovery, Observation, Task
from robotteamsim.interface.discovery import announcement
from robotteamsim.network import Message
from robotteamsim.network.messages import EVERYBODY
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

ANN = Discovery("victim", "ann", 1, (9.0, 4.0), 12.5)
EAST = Discovery("area", "east", 1, (16.0, 5.0), 20.0)
BOB = Discovery("victim", "bob", 0, (12.0, 7.0), 21.0)
STEP_NS = 100_000_000


class Chatty:
    """A controller that sends one message of its own in every step."""

    def __init__(self) -> None:
        self.inboxes: list[list[Message]] = []

    def step(self, observation, inbox, task) -> Decision:
        self.inboxes.append(list(inbox))
        return Decision(outbox=(Message(1, 0, "mine"),))


def with_base(hall_scenario, algorithm="rdpso", **mission):
    scenario = hall_scenario(control={"algorithm": algorithm, "iteration_s": 1.0})
    return scenario.model_copy(update={"mission": scenario.mission.model_copy(update={"base": 0, **mission})})


def answer(kind: str, name: str) -> Message:
    """Return the base's acknowledgement of a discovery."""
    base = Acknowledger(StandingBase(), 0)
    announced = Message(1, 0, json.dumps({"discoveries": [{"kind": kind, "name": name}]}))
    (message,) = base.step(Observation(0, STEP_NS, None, None), (announced,), Task(running=True)).outbox
    return message


def sent(announcer: Announcer, step: int, task: Task, *inbox: Message) -> list[str]:
    """Return the payloads that leave in a step, but for the controller's own."""
    outbox = announcer.step(Observation(1, step * STEP_NS, None, None), inbox, task).outbox
    assert outbox[0].payload == "mine"
    assert all((message.sender, message.receiver) == (1, 0) for message in outbox)
    return [message.payload for message in outbox[1:]]


def test_announcement_is_sent_at_once_and_every_iteration_until_the_base_answers(hall_scenario):
    announcer = Announcer(Chatty(), 1, with_base(hall_scenario), ("area", "victim"))
    asked = Task(running=True, undelivered=(ANN, BOB))
    assert sent(announcer, 1, Task(running=True)) == []
    assert sent(announcer, 2, asked) == [announcement(ANN)]
    assert [len(sent(announcer, step, asked)) for step in range(3, 24)] == [0] * 9 + [1] + [0] * 9 + [1] + [0]
    both = Task(running=True, undelivered=(ANN, BOB, EAST))
    assert sent(announcer, 24, both) == [announcement(EAST)]
    assert sent(announcer, 34, both, answer("victim", "ann")) == [announcement(EAST)]
    nothing = Task(running=True)
    assert [len(sent(announcer, step, nothing)) for step in range(35, 46)] == [0] * 9 + [1] + [0]
    assert [len(sent(announcer, step, nothing, answer("area", "east"))) for step in range(46, 60)] == [0] * 14


def test_delivered_discovery_is_announced_until_the_acknowledgement_arrives(hall_scenario):
    announcer = Announcer(Chatty(), 1, with_base(hall_scenario), ("victim",))
    assert len(sent(announcer, 1, Task(running=True, undelivered=(ANN,)))) == 1
    assert sum(len(sent(announcer, step, Task(running=True))) for step in range(2, 32)) == 3
    assert sum(len(sent(announcer, step, Task(running=True), answer("victim", "ann"))) for step in range(32, 62)) == 0
    again = msgspec.structs.replace(ANN, time_s=60.0)
    assert sent(announcer, 62, Task(running=True, undelivered=(again,))) == [announcement(again)]


def test_controller_does_not_see_acknowledgements(hall_scenario):
    chatty = Chatty()
    announcer = Announcer(chatty, 1, with_base(hall_scenario), ("victim",))
    other = Message(2, 1, "other")
    sent(announcer, 1, Task(running=True), other, answer("victim", "ann"))
    assert chatty.inboxes == [[other]]


def test_base_acknowledges_each_discovery_once_a_step_and_nothing_else():
    base = Acknowledger(Chatty(), 0)
    inbox = [Message(sender, 0, announcement(find)) for sender, find in ((1, ANN), (1, EAST), (2, ANN))]
    inbox += [Message(2, 0, "hello"), Message(2, 0, '{"discoveries": 3}')]
    mine, *answers = base.step(Observation(0, STEP_NS, None, None), inbox, Task(running=True)).outbox
    assert (mine.payload, len(base.controller.inboxes[0])) == ("mine", 5)
    assert [(m.sender, m.receiver, json.loads(m.payload)) for m in answers] == [
        (0, EVERYBODY, {"delivered": {"kind": "victim", "name": "ann"}}),
        (0, EVERYBODY, {"delivered": {"kind": "area", "name": "east"}}),
    ]
    later = base.step(Observation(0, 2 * STEP_NS, None, None), (), Task(running=True))
    assert [m.payload for m in later.outbox] == ["mine"]


def test_nothing_is_announced_while_the_mission_is_paused(hall_scenario):
    announcer = Announcer(Chatty(), 1, with_base(hall_scenario), ("area", "victim"))
    assert sent(announcer, 1, Task(running=False, undelivered=(ANN,))) == []
    assert sent(announcer, 2, Task(running=True, undelivered=(ANN,))) == [announcement(ANN)]


def test_result_that_is_not_a_decision_is_left_to_the_guard(hall_scenario):
    broken = Chatty()
    broken.step = lambda observation, inbox, task: None
    announcer = Announcer(broken, 1, with_base(hall_scenario), ("victim",))
    task = Task(running=True, undelivered=(ANN,))
    assert announcer.step(Observation(1, STEP_NS, None, None), (), task) is None


def test_wrappers_depend_on_controller_and_areas(hall_scenario):
    assert isinstance(make_controller(1, resolve(hall_scenario())), RdpsoController)  # no base
    scenario = with_base(hall_scenario)
    base = make_controller(0, resolve(scenario))
    assert (type(base), type(base.controller)) == (Acknowledger, StandingBase)
    assert isinstance(make_controller(1, resolve(scenario)), Announcer)
    covering = with_base(hall_scenario, "cover")
    base = make_controller(0, resolve(covering))
    assert (type(base), type(base.controller)) == (Acknowledger, CoverController)
    assert isinstance(make_controller(1, resolve(covering)), Announcer)
    assert isinstance(make_controller(0, resolve(with_base(hall_scenario, "cover", areas=()))), CoverController)
    assert isinstance(make_controller(1, resolve(with_base(hall_scenario, "cover", areas=()))), CoverController)


@pytest.mark.parametrize("algorithm", ["rdpso", "random_walk", "greedy", "pso", "sebs", "cover"])
def test_base_does_not_move_with_any_algorithm_and_receives_announcements(hall_scenario, algorithm):
    scenario = with_base(hall_scenario, algorithm)
    near = scenario.mission.victims[0].model_copy(update={"position": (3.5, 6.0)})
    simulation = Simulation(with_base(hall_scenario, algorithm, victims=(near,)))
    events, announced = [], []
    for _ in range(40):
        record = simulation.step()
        announced += [message for message in record.inboxes[0] if message.payload.startswith('{"discoveries"')]
        events += [(event.kind, event.subject, event.robot_id) for event in record.events]
    base = record.readings[0].ground_truth
    assert (base.x_m, base.y_m) == pytest.approx((3.0, 4.0), abs=1e-9)
    assert ("victim_saved", "ann", 1) in events
    if algorithm != "cover":  # whose robots recognise a victim by the voice that falls silent
        assert ("discovery_delivered", "ann", 1) in events
        assert len(announced) == 1  # the acknowledgement came before a second one was due


def test_swarm_in_the_garage_delivers_its_discoveries_to_a_base():
    simulation = Simulation(load("garage_sar", ["robots.count=4", "mission.base=0", "mission.time_limit_s=100"]))
    result = simulation.run()
    assert result.victims_saved > 0
    assert result.discoveries_delivered is not None
    assert 0 < result.discoveries_delivered <= result.victims_saved + result.areas_explored
    # Discovered in one step, announced in the next, delivered in the one after.
    assert 0.199 < result.mean_delivery_delay_s <= result.max_delivery_delay_s < 100.0

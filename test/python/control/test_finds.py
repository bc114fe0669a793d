"""The base stands still and hears of finds, whatever controls the robots."""

from __future__ import annotations

import json

import pytest

from robotteamsim.control import make_controller
from robotteamsim.control.cover.controller import CoverController
from robotteamsim.control.cover.update import CoverUpdate, Find
from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.runtime.base_station import (
    FindListener,
    FindReporter,
    StandingBase,
    discovery_to_json,
    tells_of,
)
from robotteamsim.interface import Decision, Discovery, Observation, Task
from robotteamsim.network import Message
from robotteamsim.network.messages import EVERYBODY
from robotteamsim.scenario import load
from robotteamsim.scenario.sections import Control
from robotteamsim.simulation import Simulation

ANN = Discovery("victim", "ann", 1, (9.0, 4.0), 12.5)
EAST = Discovery("area", "east", 1, (16.0, 5.0), 20.0)
BOB = Discovery("victim", "bob", 0, (12.0, 7.0), 21.0)
STEP_NS = 100_000_000


class Told:
    """A controller that sends one message of its own in every step."""

    def __init__(self) -> None:
        self.inboxes: list[list[Message]] = []

    def observe(self, observation, inbox, task) -> None:
        self.inboxes.append(list(inbox))

    def decide(self) -> Decision:
        return Decision(outbox=(Message(1, 0, "mine"),))


def with_base(hall_scenario, algorithm="rdpso", **mission):
    scenario = hall_scenario(control=Control(algorithm=algorithm, iteration_s=1.0))
    return scenario.model_copy(update={"mission": scenario.mission.model_copy(update={"base": 0, **mission})})


def answer(kind: str, name: str) -> Message:
    """Return what the base says when it has heard of a find."""
    base = FindListener(StandingBase(), 0)
    heard = Message(1, 0, json.dumps({"find": {"kind": kind, "name": name}}))
    base.observe(Observation(0, STEP_NS, None, None), (heard,), Task(running=True))
    (message,) = base.decide().outbox
    return message


def sent(reporter: FindReporter, step: int, task: Task, *inbox: Message) -> list[str]:
    """Return the payloads that leave in a step, but for the controller's own."""
    reporter.observe(Observation(1, step * STEP_NS, None, None), inbox, task)
    outbox = reporter.decide().outbox
    assert outbox[0].payload == "mine"
    assert all((message.sender, message.receiver) == (1, 0) for message in outbox)
    return [message.payload for message in outbox[1:]]


def test_report_is_sent_at_once_and_every_iteration_until_the_base_answers(hall_scenario):
    reporter = FindReporter(Told(), 1, with_base(hall_scenario), ("area", "victim"))
    asked = Task(running=True, unreported=(ANN, BOB))
    assert sent(reporter, 1, Task(running=True)) == []
    assert sent(reporter, 2, asked) == [discovery_to_json(ANN)]
    assert [len(sent(reporter, step, asked)) for step in range(3, 24)] == [0] * 9 + [1] + [0] * 9 + [1] + [0]
    both = Task(running=True, unreported=(ANN, BOB, EAST))
    assert sent(reporter, 24, both) == [discovery_to_json(EAST)]
    assert sent(reporter, 34, both, answer("victim", "ann")) == [discovery_to_json(EAST)]
    nothing = Task(running=True)
    assert [len(sent(reporter, step, nothing)) for step in range(35, 46)] == [0] * 9 + [1] + [0]
    assert [len(sent(reporter, step, nothing, answer("area", "east"))) for step in range(46, 60)] == [0] * 14


def test_find_that_the_base_has_heard_of_is_told_again_until_the_answer_comes(hall_scenario):
    reporter = FindReporter(Told(), 1, with_base(hall_scenario), ("victim",))
    assert len(sent(reporter, 1, Task(running=True, unreported=(ANN,)))) == 1
    assert sum(len(sent(reporter, step, Task(running=True))) for step in range(2, 32)) == 3
    assert sum(len(sent(reporter, step, Task(running=True), answer("victim", "ann"))) for step in range(32, 62)) == 0
    again = ANN._replace(time_s=60.0)
    assert sent(reporter, 62, Task(running=True, unreported=(again,))) == [discovery_to_json(again)]


def test_controller_sees_no_answers_of_the_base(hall_scenario):
    told = Told()
    reporter = FindReporter(told, 1, with_base(hall_scenario), ("victim",))
    other = Message(2, 1, "other")
    sent(reporter, 1, Task(running=True), other, answer("victim", "ann"), Message(0, 1, '{"heard":3}'))
    assert told.inboxes == [[other]]


def test_base_answers_each_find_once_a_step_and_nothing_else():
    base = FindListener(Told(), 0)
    inbox = [Message(sender, 0, discovery_to_json(find)) for sender, find in ((1, ANN), (1, EAST), (2, ANN))]
    inbox += [Message(2, 0, "hello"), Message(2, 0, '{"find": 3}')]
    base.observe(Observation(0, STEP_NS, None, None), inbox, Task(running=True))
    mine, *answers = base.decide().outbox
    assert (mine.payload, len(base.controller.inboxes[0])) == ("mine", 5)
    assert [(m.sender, m.receiver, json.loads(m.payload)) for m in answers] == [
        (0, EVERYBODY, {"heard": ["victim", "ann"]}),
        (0, EVERYBODY, {"heard": ["area", "east"]}),
    ]
    base.observe(Observation(0, 2 * STEP_NS, None, None), (), Task(running=True))
    assert [m.payload for m in base.decide().outbox] == ["mine"]


def test_nothing_is_reported_while_the_mission_is_paused(hall_scenario):
    reporter = FindReporter(Told(), 1, with_base(hall_scenario), ("area", "victim"))
    assert sent(reporter, 1, Task(running=False, unreported=(ANN,))) == []
    assert sent(reporter, 2, Task(running=True, unreported=(ANN,))) == [discovery_to_json(ANN)]


def test_what_is_no_decision_is_left_to_the_guard(hall_scenario):
    broken = Told()
    broken.decide = lambda: None
    reporter = FindReporter(broken, 1, with_base(hall_scenario), ("victim",))
    reporter.observe(Observation(1, STEP_NS, None, None), (), Task(running=True, unreported=(ANN,)))
    assert reporter.decide() is None


def test_report_names_kind_name_robot_place_and_time():
    assert json.loads(discovery_to_json(ANN)) == {
        "find": {"kind": "victim", "name": "ann", "robot_id": 1, "position_m": [9.0, 4.0], "time_s": 12.5}
    }


def test_message_tells_of_what_it_names():
    assert tells_of(discovery_to_json(ANN), ANN, 1.0)
    assert tells_of('{ "find" : {"name": "ann", "kind": "victim"}}', ANN, 1.0)
    assert not tells_of(discovery_to_json(ANN), EAST, 1.0)
    assert not tells_of(discovery_to_json(ANN._replace(kind="area")), ANN, 1.0)


@pytest.mark.parametrize("payload", ["", "ann", '{"find": 3}', '{"find": {"kind": "victim"}}', "[1]", '{"find"'])
def test_other_messages_tell_of_nothing(payload):
    assert not tells_of(payload, ANN, 1.0)


@pytest.mark.parametrize(("x_m", "tells"), [(9.9, True), (10.1, False)])
def test_cover_report_tells_of_the_victim_at_its_place(x_m, tells):
    report = CoverUpdate(2, (1.0, 4.0), None, "00", (Find((1.0, 1.0), 1, 3.0), Find((x_m, 4.0), 1, 12.5)))
    assert tells_of(report.to_json(), ANN, 1.0) is tells
    assert not tells_of(report.to_json(), EAST._replace(position_m=(9.0, 4.0)), 1.0)


def test_who_reports_depends_on_controller_and_areas(hall_scenario):
    assert isinstance(make_controller(1, hall_scenario()), RdpsoController)  # no base
    scenario = with_base(hall_scenario)
    base = make_controller(0, scenario)
    assert (type(base), type(base.controller)) == (FindListener, StandingBase)
    assert isinstance(make_controller(1, scenario), FindReporter)
    covering = with_base(hall_scenario, "cover")
    base = make_controller(0, covering)
    assert (type(base), type(base.controller)) == (FindListener, CoverController)
    assert isinstance(make_controller(1, covering), FindReporter)
    assert isinstance(make_controller(0, with_base(hall_scenario, "cover", areas=())), CoverController)
    assert isinstance(make_controller(1, with_base(hall_scenario, "cover", areas=())), CoverController)


@pytest.mark.parametrize("algorithm", ["rdpso", "random_walk", "greedy", "pso", "sebs", "cover"])
def test_base_stands_whatever_the_algorithm_and_hears_of_what_is_found_beside_it(hall_scenario, algorithm):
    scenario = with_base(hall_scenario, algorithm)
    near = scenario.mission.victims[0].model_copy(update={"position": (3.5, 6.0)})
    simulation = Simulation(with_base(hall_scenario, algorithm, victims=(near,)))
    events, reports = [], []
    for _ in range(40):
        record = simulation.step()
        reports += [message for message in record.inboxes[0] if '"find"' in message.payload]
        events += [(event.kind, event.subject, event.robot_id) for event in record.events]
    base = record.readings[0].ground_truth
    assert (base.x_m, base.y_m) == pytest.approx((3.0, 4.0), abs=1e-9)
    assert ("victim_saved", "ann", 1) in events
    if algorithm != "cover":  # whose robots go by voices, and are told of the find by her silence
        assert ("find_reported", "ann", 1) in events
        assert len(reports) == 1  # the answer came before a second one was due


def test_swarm_in_the_garage_reports_to_a_base():
    simulation = Simulation(load("garage_sar", ["robots.count=4", "mission.base=0", "mission.time_limit_s=100"]))
    result = simulation.run()
    assert result.victims_saved > 0
    assert result.finds_reported is not None
    assert 0 < result.finds_reported <= result.victims_saved + result.areas_explored
    # Seen in one step, asked for and sent in the next, there in the one after.
    assert 0.199 < result.mean_report_delay_s <= result.max_report_delay_s < 100.0

"""A faulty controller stops its robot and gives the reason in one line."""

from __future__ import annotations

import asyncio
import math
import re
import sys

import numpy as np
import pytest

from robotteamsim.control import Guard
from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import Decision, Estimate, Localisation, SwarmContext, Task
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario import OccupancyGrid, load
from robotteamsim.simulation import Simulation

MISTAKES = """\
import numpy as np
import robotteamsim as rts

class Misspelt:
    def __init__(self, robot_id, setup):
        pass

    def step(self, observation, inbox, task):
        return rts.Decision(rts.Twits(0.8))

class Deep(Misspelt):
    def step(self, observation, inbox, task):
        values = np.ones(3)
        return np.reshape(values, (2, 2))

class Wrong:
    def __init__(self, robot_id, setup, third):
        pass

class NoDecision(Misspelt):
    def step(self, observation, inbox, task):
        return 0.8

class NoDecisionOfPath(rts.PathController):
    def decide(self, now):
        return 0.8
"""
FORWARD = Decision(Twist(0.5))


class WithoutTextError(Exception):
    """Its text cannot be made."""

    def __str__(self) -> str:
        raise SystemExit


class Scripted:
    """Returns its decisions one after the other; an exception is raised."""

    def __init__(self, *decisions: object) -> None:
        self.decisions = list(decisions)
        self.num_steps = 0

    def step(self, observation, inbox, task):
        self.num_steps += 1
        decision = self.decisions.pop(0)
        if isinstance(decision, BaseException):
            raise decision
        return decision


def guard(*decisions: object) -> Guard:
    return Guard(1, 3, lambda: Scripted(*decisions))


def step(guarded: Guard) -> Decision:
    return guarded.step(None, (), Task())


def test_decisions_of_a_sound_controller_pass_unchanged():
    said = Decision(Twist(0.1, 0.2, 0.3), (Message(1, EVERYBODY, "hello"), Message(1, 2, "you")), goal_m=(1.0, 2.0))
    assert step(guard(said)) == said


@pytest.mark.parametrize(
    ("decision", "fault"),
    [
        (ZeroDivisionError("division by zero"), "ZeroDivisionError: division by zero (test_guard.py:"),
        (ValueError("two\n  lines"), "ValueError: two lines (test_guard.py:"),
        (MemoryError(), "MemoryError (test_guard.py:"),
        ((x for x in ()), "step returned <generator object <genexpr>>; expected a Decision"),
        (Decision(Twist(math.nan)), "step returned Twist(linear_x_mps=nan, "),
        (Decision(Twist(0.0, 0.0, math.inf)), "step returned Twist(linear_x_mps=0.0, "),
        (Decision(Twist("fast")), "step returned Twist(linear_x_mps='fast', "),
        (Decision(context=(0.5,) * 10), "step returned the context (0.5, 0.5, 0.5, "),
        (Decision(context=SwarmContext(*[math.nan] * 10)), "step returned the context SwarmContext(activity=nan, "),
        (Decision((0.5, 0.0, 0.0)), "step returned (0.5, 0.0, 0.0); expected a Twist of finite numbers"),
        (None, "step returned None; expected a Decision"),
        (
            Twist(0.125),
            "step returned Twist(linear_x_mps=0.125, linear_y_mps=0.0, angular_z_rad...; expected a Decision",
        ),
        (Decision(goal_m={1.0}), "step returned the goal {1.0}; expected finite (x, y), or None"),
        (Decision(goal_m=(math.nan, 0.0)), "step returned the goal (nan, 0.0); expected finite (x, y), or None"),
        (Decision(local_best_m=(math.inf, 0.0)), "step returned the local best (inf, 0.0); expected finite (x, y)"),
        (Decision(localisation=Pose(1.0, 2.0, 0.0)), "step returned the localisation Pose(x_m=1.0, "),
        (
            Decision(localisation=Localisation("tracking", ())),
            "step returned the localisation Localisation(state='tracking', estimates=()); expected a Localisation with",
        ),
        (
            Decision(localisation=Localisation("lost", (Estimate(Pose(math.nan, 0.0, 0.0)),))),
            "step returned the localisation Localisation(state='lost', ",
        ),
        (
            Decision(localisation=Localisation("unsure", (Estimate(Pose(0.0, 0.0, 0.0)),))),
            "step returned the localisation Localisation(state='unsure', ",
        ),
        (
            Decision(found=OccupancyGrid((0.0, 0.0), 0.1, np.zeros((2, 2)))),
            "step returned found = OccupancyGrid(origin_m=(0.0, 0.0), ",
        ),
        (Decision(particles=[Pose(0.0, 0.0, 0.0)]), "step returned particles = [Pose(x_m=0.0, "),
        (Decision(particles=(Pose(0.0, 0.0, math.nan),)), "step returned particles = (Pose(x_m=0.0, "),
        (Decision(area=-2), "step returned area = -2; expected the index of an area, or -1 for none"),
        (Decision(outbox=("hello",)), "step returned 'hello' to send; expected a Message with text"),
        (
            Decision(outbox=(Message(0, EVERYBODY, ""),)),
            "step returned a message from sender 0; expected 1, the robot itself",
        ),
        (
            Decision(outbox=(Message(1, 3, ""),)),
            "step returned a message to receiver 3; expected 0 to 2, or -1 for everybody",
        ),
        (Decision(outbox=(Message(1, 0.0, ""),)), "step returned a message to receiver 0.0; expected 0 to 2"),
        (Decision(outbox=(Message(1, -2, ""),)), "step returned a message to receiver -2; expected 0 to 2"),
        (
            Decision(outbox=(Message(1, 0, "\udc00"),)),
            "step returned the text '\\udc00' to send, which cannot be encoded as UTF-8",
        ),
        (Decision(outbox=None), "step returned the outbox None; expected a tuple of Messages"),
        (Decision(excluded="no"), "step returned excluded = 'no'; expected True or False"),
        (Decision(swarm=2.5), "step returned swarm = 2.5; expected a number from 0 on, or -1 for none"),
        (Decision(swarm=-2), "step returned swarm = -2; expected a number from 0 on, or -1 for none"),
        (Decision(swarm=2**31), "step returned swarm = 2147483648; expected a number from 0 on"),
        (Decision(search_counter=None), "step returned search_counter = None; expected a number from 0 on"),
        (Decision(local_best="high"), "step returned local_best = 'high'; expected a number"),
        (Decision(local_best=10**400), "step returned local_best = 1000000"),
        (Decision(fault=3), "step returned fault = 3; expected text"),
        (Decision(fault="\udc00"), "step returned fault = '\\udc00', which cannot be encoded as UTF-8"),
        (Decision(done="\udc00"), "step returned done = '\\udc00', which cannot be encoded as UTF-8"),
        (OSError("no file \udcff.txt"), "OSError: no file \\udcff.txt (test_guard.py:"),
        (SystemExit(3), "SystemExit: 3 (test_guard.py:"),
        (asyncio.CancelledError(), "CancelledError (test_guard.py:"),
        (GeneratorExit(), "GeneratorExit (test_guard.py:"),
        (WithoutTextError(), "WithoutTextError (test_guard.py:"),
    ],
)
def test_faulty_decision_stops_the_robot_for_good_and_reports_why(decision, fault):
    guarded = guard(FORWARD, decision, FORWARD)
    assert step(guarded) == FORWARD
    told = [step(guarded), step(guarded)]
    assert told[0].fault.startswith(fault)
    assert "\n" not in told[0].fault
    assert told[0] == told[1] == Decision(fault=told[0].fault)


def test_belief_that_is_changed_in_place_is_checked_again():
    belief = FieldMap((0.0, 0.0), 0.5, np.ones((3, 3)))
    guarded = guard(*[Decision(Twist(0.5), belief=belief)] * 3)
    assert [step(guarded).fault, step(guarded).fault] == ["", ""]
    belief.values[0, 0] = math.nan
    assert step(guarded).fault.startswith("step returned the belief")


def test_decision_that_differs_only_in_a_wrong_twist_is_found():
    guarded = guard(FORWARD, Decision(Twist(0.6)), Decision(Twist(math.nan)))
    assert [step(guarded).fault, step(guarded).fault] == ["", ""]
    assert step(guarded).fault.startswith("step returned Twist(linear_x_mps=nan, ")


def test_numbers_of_numpy_become_those_of_python():
    said = Decision(
        Twist(np.float32(0.5)),
        (Message(1, np.int64(2), "grüße"),),
        excluded=np.bool_(True),
        goal_m=np.array([1.0, 2.5]),
        local_best=np.float32(1.5),
        search_counter=np.int32(3),
        swarm=np.int64(-1),
    )
    kept = step(guard(said))
    status = (kept.excluded, kept.goal_m, kept.local_best, kept.search_counter, kept.swarm)
    assert repr(status) == "(True, (1.0, 2.5), 1.5, 3, -1)"
    assert (kept.twist, kept.outbox) == (said.twist, said.outbox)


def test_controller_that_failed_is_not_asked_any_more():
    guarded = guard(ValueError("no"))
    step(guarded)
    step(guarded)
    assert guarded.controller.num_steps == 1


def test_controller_that_raises_when_made_stops_its_robot():
    def unmade():
        raise RuntimeError("no licence")

    never = Guard(0, 1, unmade)
    assert re.fullmatch(r"RuntimeError: no licence \(test_guard.py:\d+\)", step(never).fault)


def test_mistake_of_the_user_concerns_all_and_passes():
    def make():
        raise ScenarioError("there is no such algorithm")

    with pytest.raises(ScenarioError, match="there is no such algorithm"):
        Guard(0, 1, make)


def test_place_of_a_fault_is_in_the_users_file(tmp_path, monkeypatch):
    (tmp_path / "driver_of_test.py").write_text(MISTAKES, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    faults = []
    for name in ("Misspelt", "Deep", "Wrong"):
        scenario = load("tutorial_arena", [f"control.algorithm=driver_of_test:{name}", "mission.time_limit_s=1"])
        simulation = Simulation(scenario)
        for _ in range(3):
            simulation.step()
        faults.append(simulation.controllers.faults[0])
    sys.modules.pop("driver_of_test")
    assert faults[0] == "AttributeError: module 'robotteamsim' has no attribute 'Twits' (driver_of_test.py:9)"
    assert faults[1].endswith(" (driver_of_test.py:14)")  # where numpy was called
    assert faults[2].startswith("TypeError: ")
    assert faults[2].endswith("'third'")  # no class could be called


@pytest.mark.parametrize("scenario", ["tutorial_arena", "garage_unknown", "office_manet"])
@pytest.mark.parametrize(("name", "line"), [("NoDecision", 21), ("NoDecisionOfPath", 25)])
def test_place_of_a_wrong_decision_is_in_the_users_file(tmp_path, monkeypatch, scenario, name, line):
    (tmp_path / "driver_of_test.py").write_text(MISTAKES, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    simulation = Simulation(load(scenario, [f"control.algorithm=driver_of_test:{name}"]))
    for _ in range(2):
        simulation.step()
    sys.modules.pop("driver_of_test")
    assert simulation.controllers.faults[-1] == f"step returned 0.8; expected a Decision (driver_of_test.py:{line})"

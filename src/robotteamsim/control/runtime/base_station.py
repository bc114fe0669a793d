"""How the base, `mission.base`, comes to hear of what robots find, whatever controls them."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Sequence

from robotteamsim.control.cover.update import parse_cover_update
from robotteamsim.interface import Controller, Decision, Discovery, Observation, Task
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.scenario import Scenario


def with_base(controller: Controller, robot_id: int, scenario: Scenario) -> Controller:
    """Return the controller of a robot in a scenario that has a base.

    A class with a true `reports_victims` knows of the base and tells it of victims; its robots report areas only. With
    all others the base stands still, and its robots report areas and victims.
    """
    reports_victims = bool(getattr(controller, "reports_victims", False))
    if reports_victims and not scenario.mission.areas:
        return controller
    if robot_id == scenario.mission.base:
        return FindListener(controller if reports_victims else StandingBase(), robot_id)
    return FindReporter(controller, robot_id, scenario, ("area",) if reports_victims else ("area", "victim"))


class StandingBase:
    """A base that stands where it is; messages go by way of it as by any robot."""

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Nothing that is perceived makes it move."""

    def decide(self) -> Decision:
        """Return the decision to stand."""
        return Decision()


class FindListener:
    """Runs the base's controller, and tells everybody of which finds the base has heard; that may get lost, too."""

    def __init__(self, controller: Controller, robot_id: int) -> None:
        self.controller = controller
        self._robot_id = robot_id
        self._heard: list[tuple[str, str]] = []

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Let the controller observe, and take note of the reports that arrive."""
        self.controller.observe(observation, inbox, task)
        told = [_parse(message.payload) for message in inbox if '"find"' in message.payload] if task.running else []
        self._heard = [find for find in dict.fromkeys(told) if find is not None]

    def decide(self) -> Decision:
        """Return what the controller decides, with the acknowledgement of each find that was told of in this step."""
        decision = self.controller.decide()
        # What is no decision is the guard's affair.
        if not self._heard or not isinstance(decision, Decision):
            return decision
        answers = [Message(self._robot_id, EVERYBODY, _HEARD + json.dumps(find) + "}") for find in self._heard]
        return decision._replace(outbox=(*decision.outbox, *answers))


class FindReporter:
    """Runs a robot's controller, and tells the base what the robot has found.

    The first report of a discovery leaves with the first step in which the robot is asked for it, the next ones every
    `control.iteration_s`, until the base's acknowledgement arrives. Both take the network's way.
    """

    def __init__(self, controller: Controller, robot_id: int, scenario: Scenario, kinds: Sequence[str]) -> None:
        assert scenario.mission.base is not None, "without a base there is nobody to report to"
        self.controller = controller
        self._robot_id, self._base, self._kinds = robot_id, scenario.mission.base, kinds
        self._period_ns = round(scenario.control.iteration_s * 1e9)
        self._unreported: tuple[Discovery, ...] = ()
        self._own: dict[Discovery, int] = {}
        """What the base has not acknowledged, and when a report is due next [ns]."""
        self._time_ns = 0
        self._running = False

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Let the controller observe, and take note of what the robot has found and the base has acknowledged."""
        answers = [message for message in inbox if message.payload.startswith(_HEARD)]
        # A controller need not know of them.
        others = [message for message in inbox if message not in answers] if answers else inbox
        self.controller.observe(observation, others, task)
        self._time_ns, self._running = observation.sim_time_ns, task.running
        if task.unreported is not self._unreported:
            new = [find for find in task.unreported if find not in self._unreported]
            self._unreported = task.unreported
            own = [find for find in new if find.robot_id == self._robot_id and find.kind in self._kinds]
            self._own |= dict.fromkeys(own, self._time_ns)
        if answers and self._own:
            heard = {_parse_answer(message.payload) for message in answers}
            self._own = {find: due for find, due in self._own.items() if (find.kind, find.name) not in heard}

    def decide(self) -> Decision:
        """Return what the controller decides, with the reports that are due."""
        decision = self.controller.decide()
        due = [find for find, due_ns in self._own.items() if due_ns <= self._time_ns]
        # What is no decision is the guard's affair.
        if not due or not self._running or not isinstance(decision, Decision):
            return decision
        self._own |= dict.fromkeys(due, self._time_ns + self._period_ns)
        reports = [Message(self._robot_id, self._base, discovery_to_json(find)) for find in due]
        return decision._replace(outbox=(*decision.outbox, *reports))


_HEARD = '{"heard":'
"""So begins the base's acknowledgement of a find, which goes on with its kind and name."""


def _parse_answer(payload: str) -> tuple[str, str] | None:
    """Return kind and name of the find that the base has heard of; none where a text only begins so."""
    try:
        kind, name = json.loads(payload)["heard"]
        return str(kind), str(name)
    except (ValueError, KeyError, TypeError):
        return None


def discovery_to_json(find: Discovery) -> str:
    """Return the message that tells of a discovery, one line of JSON."""
    return json.dumps({"find": find._asdict()}, separators=(",", ":"))


def tells_of(payload: str, find: Discovery, within_m: float) -> bool:
    """Return whether a message tells of a discovery: by kind and name, or, in a report of `cover`, by place.

    Args: within_m: a victim is meant by a place this near to hers [m].
    """
    if '"find"' in payload:
        return _parse(payload) == (find.kind, find.name)
    report = parse_cover_update(payload) if find.kind == "victim" else None
    return report is not None and any(math.dist(told.position, find.position_m) <= within_m for told in report.finds)


# It is sent again until it is heard of.
@functools.lru_cache(maxsize=64)
def _parse(payload: str) -> tuple[str, str] | None:
    """Return kind and name of the discovery that a message tells of; none where it tells of something else."""
    try:
        find = json.loads(payload)["find"]
        return str(find["kind"]), str(find["name"])
    except (ValueError, KeyError, TypeError):
        return None

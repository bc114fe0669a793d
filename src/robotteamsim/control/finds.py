"""How the base, `mission.base`, comes to hear of what robots find, whatever controls them."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Sequence

from robotteamsim.control.controller import Controller, Decision, Discovery, Task
from robotteamsim.control.cover_report import parse_cover_report
from robotteamsim.network.messages import Message
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import Observation


def with_base(controller: Controller, robot_id: int, scenario: Scenario) -> Controller:
    """Return the controller of a robot in a scenario that has a base.

    A class with a true `reports_victims` knows of the base and tells it of victims; its robots report areas only. With
    all others the base stands still, and its robots report areas and victims.
    """
    reports_victims = bool(getattr(controller, "reports_victims", False))
    if robot_id == scenario.mission.base:
        return controller if reports_victims else StandingBase()
    if reports_victims and not scenario.mission.areas:
        return controller
    return FindReporter(controller, robot_id, scenario, ("area",) if reports_victims else ("area", "victim"))


class StandingBase:
    """A base that stands where it is; messages go by way of it as by any robot."""

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Nothing that is perceived makes it move."""

    def decide(self) -> Decision:
        """Return the decision to stand."""
        return Decision()


class FindReporter:
    """Runs a robot's controller, and tells the base what the robot has found.

    The first report of a discovery leaves with the first step in which the robot is asked for it, the next ones every
    `control.iteration_s`, until the mission no longer asks. They take the network's way to the base.
    """

    def __init__(self, controller: Controller, robot_id: int, scenario: Scenario, kinds: Sequence[str]) -> None:
        assert scenario.mission.base is not None, "without a base there is nobody to report to"
        self.controller = controller
        self._robot_id, self._base, self._kinds = robot_id, scenario.mission.base, kinds
        self._period_ns = round(scenario.control.iteration_s * 1e9)
        self._unreported: tuple[Discovery, ...] = ()
        self._own: dict[Discovery, int] = {}
        """What it is asked to report, and when that is due next [ns]."""
        self._time_ns = 0
        self._running = False

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Let the controller observe, and take note of what the mission wants reported."""
        self.controller.observe(observation, inbox, task)
        self._time_ns, self._running = observation.sim_time_ns, task.running
        if task.unreported is not self._unreported:
            self._unreported = task.unreported
            own = [find for find in task.unreported if find.robot_id == self._robot_id and find.kind in self._kinds]
            self._own = {find: self._own.get(find, self._time_ns) for find in own}

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


def discovery_to_json(find: Discovery) -> str:
    """Return the message that tells of a discovery, one line of JSON."""
    return json.dumps({"find": find._asdict()}, separators=(",", ":"))


def tells_of(payload: str, find: Discovery, within_m: float) -> bool:
    """Return whether a message tells of a discovery: by kind and name, or, in a report of `cover`, by place.

    Args: within_m: a victim is meant by a place this near to hers [m].
    """
    if '"find"' in payload:
        return _parse(payload) == (find.kind, find.name)
    report = parse_cover_report(payload) if find.kind == "victim" else None
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

"""What a team is rewarded for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.control.driving.known_map import UNREACHABLE_M, KnownMap, known_map
from robotteamsim.mission.status import VictimState
from robotteamsim.recording.coverage import CoverageLog
from robotteamsim.recording.idleness import IdlenessLog
from robotteamsim.recording.network_log import NetworkLog
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.base import Point
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord


class Reward:
    """Zero; a subclass replaces `of_step`. Each mission has a new one."""

    PER_CONTACT_S = -0.1

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents."""
        self.setup, self.robot_ids = setup, list(robot_ids)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """Return what a scenario lacks to be rewarded, as "key: value; expected ..."; "" if nothing."""
        return ""

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        return np.zeros(len(self.robot_ids))

    def for_contacts(self, record: StepRecord) -> np.ndarray:
        """Return `PER_CONTACT_S` per second of contact for each agent, shape (n,)."""
        contact = record.state.contact.tolist()
        per_contact = self.PER_CONTACT_S * self.setup.scenario.run.step_s
        return per_contact * np.array([contact[i] for i in self.robot_ids])


class SearchReward(Reward):
    """For the team: areas explored, victims saved, time, and progress to the area; for each robot: contacts.

    Progress is that of the robot with the shortest path to the area on the known map. What it gains, it loses when it
    drives back; a new area is neither gain nor loss. It is a hint, and may change which policy is best.
    """

    AREA, VICTIM = 1.0, 2.0
    PER_METRE = 0.02
    PER_S = -0.002

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents."""
        super().__init__(setup, robot_ids)
        self._sharing: dict[KnownMap, list[int]] = {}
        """The robots of each size, which know the same paths."""
        for i in robot_ids:
            self._sharing.setdefault(known_map(setup.building, setup.robots[i].reach_m), []).append(i)
        self._explored = self._saved = 0
        self._path: tuple[Point, float] | None = None
        """The area, and the length of the shortest path to it [m]."""

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        mission = scenario.mission
        if mission.areas and mission.area_order != "given":
            return f"mission.area_order: {mission.area_order}; expected given, because agents choose no areas"
        is_empty = not mission.areas and not scenario.num_victims
        return "mission.areas: none, and there are no victims; expected some of them" if is_empty else ""

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        status, step_s = record.mission, self.setup.scenario.run.step_s
        explored, saved = status.areas_explored, status.victims_saved
        team = self.AREA * (explored - self._explored) + self.VICTIM * (saved - self._saved) + self.PER_S * step_s
        self._explored, self._saved = explored, saved
        team += self.PER_METRE * self._gained_m(record)
        return team + self.for_contacts(record)

    def _gained_m(self, record: StepRecord) -> float:
        area, before = record.mission.task.area_center_m, self._path
        self._path = None
        if area is None:
            return 0.0
        positions_m, is_there, length_m = record.state.positions_m, record.present.tolist(), UNREACHABLE_M
        for known, robot_ids in self._sharing.items():
            there = [i for i in robot_ids if is_there[i]]
            length_m = min([length_m, *known.distances_m(area, positions_m[there])])
        if length_m < UNREACHABLE_M:
            self._path = area, length_m
        return before[1] - length_m if before and self._path and before[0] == area else 0.0


class CoverageReward(Reward):
    """For the team: the share of the floor that is newly covered, by `mission.coverage`; for each robot: contacts."""

    FLOOR = 10.0

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents."""
        super().__init__(setup, robot_ids)
        self._coverage, self._covered = CoverageLog(), 0.0
        self._coverage.begin(setup)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        if scenario.mission.coverage is None:
            return "mission.coverage: none; expected a section, such as {radius_m: 2.5}"
        return _areas_of(scenario)

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        self._coverage.step(record)
        before, self._covered = self._covered, self._coverage.share
        return self.FLOOR * (self._covered - before) + self.for_contacts(record)


class ConnectedCoverageReward(CoverageReward):
    """Also for the team: time in which its network is split."""

    PER_SPLIT_S = -0.05

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents."""
        super().__init__(setup, robot_ids)
        self._network, self._split_s = NetworkLog(), 0.0
        self._network.begin(setup)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        if scenario.team_size < 2:
            return "robots.count: 1; expected at least 2, which can be connected"
        return super().lack_of(scenario)

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        self._network.step(record)
        before, self._split_s = self._split_s, self._network.totals.split_s
        return super().of_step(record) + self.PER_SPLIT_S * (self._split_s - before)


class PatrolReward(Reward):
    """For the team: the mean idleness of the vertices of `mission.patrol`, over time; for each robot: contacts."""

    PER_IDLE_S2 = -1e-4

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents. Raises: ScenarioError: the plan has no room for a graph."""
        super().__init__(setup, robot_ids)
        self._idleness = IdlenessLog()
        self._idleness.begin(setup)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        return _areas_of(scenario)

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        self._idleness.step(record)
        idle_s, step_s = float(self._idleness.idle_s.mean()), self.setup.scenario.run.step_s
        return self.PER_IDLE_S2 * idle_s * step_s + self.for_contacts(record)


class RescueReward(Reward):
    """For the team: victims located, safe and dead, and their doses of smoke and heat; for each robot: heat, contacts.

    A victim who is no longer located, because nobody found them, is a loss of what was gained.
    """

    LOCATED, SAFE, DEAD, DOSE, FAILED = 0.5, 2.0, -2.0, -1.0, -1.0
    _LOCATED: frozenset[VictimState] = frozenset(("located", "reported", "reached", "carried", "saved", "safe"))

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents."""
        super().__init__(setup, robot_ids)
        self._value, self._failed = 0.0, np.zeros(len(robot_ids), bool)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        if scenario.fire is None:
            return "fire: none; expected one"
        return "" if scenario.num_victims else "mission.victims: none; expected somebody to rescue"

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        states, before, had_failed = record.mission.victims, self._value, self._failed
        doses = 0.0 if record.egress is None else sum(person.dose for person in record.egress.people)
        self._value = self.SAFE * record.mission.victims_saved + self.DEAD * states.count("dead") + self.DOSE * doses
        self._value += self.LOCATED * sum(state in self._LOCATED for state in states)
        self._failed = np.isin(self.robot_ids, list(record.failed))
        robots = self.FAILED * (self._failed & ~had_failed) + self.for_contacts(record)
        return np.asarray(self._value - before + robots)


def _areas_of(scenario: Scenario) -> str:
    """Return what is wrong with a scenario whose last area would end the mission; "" if it has none."""
    count = len(scenario.mission.areas)
    return f"mission.areas: {count}, the last of which ends a mission; expected none" if count else ""

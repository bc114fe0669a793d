"""What a team is rewarded for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from robotteamsim.control.driving.known_map import UNREACHABLE_M, KnownMap, known_map
from robotteamsim.mission.status import VictimState
from robotteamsim.recording.coverage import CoverageLog
from robotteamsim.recording.exploration import KnownFloor
from robotteamsim.recording.idleness import IdlenessLog
from robotteamsim.recording.network_log import NetworkLog
from robotteamsim.scenario import Scenario
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord


class Steps(NamedTuple):
    """A complete step of each of k missions, as a reward looks at it; n agents. Its arrays may be kept.

    record_of:   returns all about the step of a mission, by its number, during `of_step`.
    missions:    their numbers, shape (k,).
    present:     bool, shape (k, n).              contact: whether each touches something, bool, shape (k, n).
    positions_m: true ones in `map`, shape (k, n, 2); those of absent agents mean nothing.
    explored:    areas so far, shape (k,).        saved: victims so far, shape (k,).
    areas:       whether there is an area to explore, x and y of its centre in `map` [m], shape (k, 3).
    """

    record_of: Callable[[int], StepRecord]
    missions: np.ndarray
    present: np.ndarray
    contact: np.ndarray
    positions_m: np.ndarray
    explored: np.ndarray
    saved: np.ndarray
    areas: np.ndarray

    @property
    def records(self) -> list[StepRecord]:
        """All about the step of each mission; they are made when somebody asks, and take longer than what is above."""
        return [self.record_of(mission) for mission in self.missions.tolist()]

    def numbered(self) -> Iterator[tuple[int, StepRecord]]:
        """Return number and record of each mission."""
        return zip(self.missions.tolist(), self.records, strict=True)


class Reward:
    """Zero; a subclass replaces `of_step`, and `begin` if it remembers something. One serves all missions."""

    PER_CONTACT_S = -0.1

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """Args: setup: of missions, each of which has another seed: see `begin`.  robot_ids: of the agents.
        missions: how many.
        """
        self.setup, self.robot_ids, self.missions = setup, list(robot_ids), missions

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """Return what a scenario lacks to be rewarded, as "key: value; expected ..."; "" if nothing."""
        return ""

    def begin(self, mission: int, setup: Setup) -> None:
        """Let a mission begin: forget the one before it of the same number.

        Args: setup: with a seed of its own. It has the true building, and in `found` the maps of agents that map it.
        """

    def of_step(self, steps: Steps) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation of some missions, shape (k, n)."""
        return np.zeros(steps.contact.shape)

    def for_contacts(self, steps: Steps) -> np.ndarray:
        """Return `PER_CONTACT_S` per second of contact for each agent, shape (k, n)."""
        return np.asarray(self.PER_CONTACT_S * self.setup.scenario.run.step_s * steps.contact)


class SearchReward(Reward):
    """For the team: areas explored, victims saved, time, and progress to the area; for each robot: contacts.

    Progress is that of the robot with the shortest path to the area on the known map. What it gains, it loses when it
    drives back; a new area is neither gain nor loss. It is a hint, and may change which policy is best.
    """

    AREA, VICTIM = 1.0, 2.0
    PER_METRE = 0.02
    PER_S = -0.002

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """See `Reward`."""
        super().__init__(setup, robot_ids, missions)
        agents: dict[KnownMap, list[int]] = {}
        for agent, i in enumerate(robot_ids):
            agents.setdefault(known_map(setup.building, setup.robots[i].reach_m), []).append(agent)
        self._sharing = [(known, those if len(agents) > 1 else slice(None)) for known, those in agents.items()]
        """The agents of each size, which know the same paths."""
        self._explored, self._saved = np.zeros((2, missions), int)
        self._areas, self._lengths_m = np.zeros((missions, 3)), np.full(missions, UNREACHABLE_M)
        """The area of each mission, and the length of the shortest path to it [m]."""

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        mission = scenario.mission
        if mission.areas and mission.area_order != "given":
            return f"mission.area_order: {mission.area_order}; expected given, because agents choose no areas"
        is_empty = not mission.areas and not scenario.num_victims
        return "mission.areas: none, and there are no victims; expected some of them" if is_empty else ""

    def begin(self, mission: int, setup: Setup) -> None:
        """See `Reward`."""
        self._explored[mission] = self._saved[mission] = 0
        self._lengths_m[mission] = UNREACHABLE_M

    def of_step(self, steps: Steps) -> np.ndarray:
        """See `Reward`."""
        which, step_s = steps.missions, self.setup.scenario.run.step_s
        explored, saved = steps.explored - self._explored[which], steps.saved - self._saved[which]
        team = self.AREA * explored + self.VICTIM * saved + self.PER_S * step_s
        self._explored[which], self._saved[which] = steps.explored, steps.saved
        team += self.PER_METRE * self._gained_m(steps)
        return np.asarray(team[:, None] + self.for_contacts(steps))

    def _gained_m(self, steps: Steps) -> np.ndarray:
        """Return by how much each team has come nearer to its area, shape (k,); 0 if it has another one."""
        which, areas, lengths_m = steps.missions, steps.areas, np.full(len(steps.missions), UNREACHABLE_M)
        wanted = set(map(tuple, areas.tolist()))
        for is_there, *center_m in wanted:
            if not is_there:
                continue
            rows = slice(None) if len(wanted) == 1 else (areas == (is_there, *center_m)).all(1)
            positions_m, present = steps.positions_m[rows], steps.present[rows]
            for known, agents in self._sharing:
                away_m = known.distances_m(tuple(center_m), positions_m[:, agents])
                away_m[~present[:, agents]] = UNREACHABLE_M
                lengths_m[rows] = np.minimum(lengths_m[rows], away_m.min(1))
        before_m, is_same = self._lengths_m[which], (areas == self._areas[which]).all(1)
        self._areas[which], self._lengths_m[which] = areas, lengths_m
        return np.where(is_same & (np.maximum(before_m, lengths_m) < UNREACHABLE_M), before_m - lengths_m, 0.0)


class CoverageReward(Reward):
    """For the team: the share of the floor that is newly covered, by `mission.coverage`; for each robot: contacts."""

    FLOOR = 10.0

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """See `Reward`."""
        super().__init__(setup, robot_ids, missions)
        self._coverages, self._covered = [CoverageLog() for _ in range(missions)], np.zeros(missions)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        if scenario.mission.coverage is None:
            return "mission.coverage: none; expected a section, such as {radius_m: 2.5}"
        return _areas_of(scenario)

    def begin(self, mission: int, setup: Setup) -> None:
        """See `Reward`."""
        self._coverages[mission].begin(setup)
        self._covered[mission] = 0.0

    def of_step(self, steps: Steps) -> np.ndarray:
        """See `Reward`."""
        before = self._covered[steps.missions]
        for i, record in steps.numbered():
            self._coverages[i].step(record)
            self._covered[i] = self._coverages[i].share
        floor = self.FLOOR * (self._covered[steps.missions] - before)
        return np.asarray(floor[:, None] + self.for_contacts(steps))


class KnownFloorReward(Reward):
    """For the team: the share of the true floor that is newly in a map of some agent; for each robot: contacts.

    What leaves all maps again, because one was corrected, is a loss. Whether a map is right is not looked at.
    """

    FLOOR = 10.0

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """See `Reward`."""
        super().__init__(setup, robot_ids, missions)
        self._floors, self._maps = [KnownFloor(setup)] * missions, [tuple(setup.found.values())] * missions
        self._shares, self._versions = np.zeros(missions), [[0] * len(maps) for maps in self._maps]
        """The share of each mission, and the versions of its maps when it was counted."""

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        if scenario.control.map == "known":
            return "control.map: known; expected unknown, so that there is something to find"
        return _areas_of(scenario)

    def begin(self, mission: int, setup: Setup) -> None:
        """See `Reward`."""
        self._floors[mission], self._maps[mission] = KnownFloor(setup), tuple(setup.found.values())
        self._shares[mission], self._versions[mission] = 0.0, [0] * len(setup.found)

    def of_step(self, steps: Steps) -> np.ndarray:
        """See `Reward`."""
        before = self._shares[steps.missions]
        for i in steps.missions.tolist():
            versions = [found.version for found in self._maps[i]]
            if versions != self._versions[i]:
                self._versions[i], self._shares[i] = versions, self._floors[i].share(self._maps[i])
        floor = self.FLOOR * (self._shares[steps.missions] - before)
        return np.asarray(floor[:, None] + self.for_contacts(steps))


class ConnectedCoverageReward(CoverageReward):
    """Also for the team: time in which its network is split."""

    PER_SPLIT_S = -0.05

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """See `Reward`."""
        super().__init__(setup, robot_ids, missions)
        self._networks, self._split_s = [NetworkLog() for _ in range(missions)], np.zeros(missions)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        if scenario.team_size < 2:
            return "robots.count: 1; expected at least 2, which can be connected"
        return super().lack_of(scenario)

    def begin(self, mission: int, setup: Setup) -> None:
        """See `Reward`."""
        super().begin(mission, setup)
        self._networks[mission].begin(setup)
        self._split_s[mission] = 0.0

    def of_step(self, steps: Steps) -> np.ndarray:
        """See `Reward`."""
        before_s = self._split_s[steps.missions]
        for i, record in steps.numbered():
            self._networks[i].step(record)
            self._split_s[i] = self._networks[i].totals.split_s
        split_s = self._split_s[steps.missions] - before_s
        return np.asarray(super().of_step(steps) + self.PER_SPLIT_S * split_s[:, None])


class PatrolReward(Reward):
    """For the team: the mean idleness of the vertices of `mission.patrol`, over time; for each robot: contacts."""

    PER_IDLE_S2 = -1e-4

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """See `Reward`."""
        super().__init__(setup, robot_ids, missions)
        self._idleness = [IdlenessLog() for _ in range(missions)]

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        return _areas_of(scenario)

    def begin(self, mission: int, setup: Setup) -> None:
        """See `Reward`. Raises: ScenarioError: the plan has no room for a graph."""
        self._idleness[mission].begin(setup)

    def of_step(self, steps: Steps) -> np.ndarray:
        """See `Reward`."""
        for i, record in steps.numbered():
            self._idleness[i].step(record)
        idle_s = np.array([self._idleness[i].idle_s.mean() for i in steps.missions.tolist()])
        team = self.PER_IDLE_S2 * idle_s * self.setup.scenario.run.step_s
        return np.asarray(team[:, None] + self.for_contacts(steps))


class RescueReward(Reward):
    """For the team: victims located, safe and dead, and their doses of smoke and heat; for each robot: heat, contacts.

    A victim who is no longer located, because nobody found them, is a loss of what was gained.
    """

    LOCATED, SAFE, DEAD, DOSE, FAILED = 0.5, 2.0, -2.0, -1.0, -1.0
    _LOCATED: frozenset[VictimState] = frozenset(("located", "reported", "reached", "carried", "saved", "safe"))

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """See `Reward`."""
        super().__init__(setup, robot_ids, missions)
        self._values, self._failed = np.zeros(missions), np.zeros((missions, len(robot_ids)), bool)

    @classmethod
    def lack_of(cls, scenario: Scenario) -> str:
        """See `Reward`."""
        if scenario.fire is None:
            return "fire: none; expected one"
        return "" if scenario.num_victims else "mission.victims: none; expected somebody to rescue"

    def begin(self, mission: int, setup: Setup) -> None:
        """See `Reward`."""
        self._values[mission], self._failed[mission] = 0.0, False

    def of_step(self, steps: Steps) -> np.ndarray:
        """See `Reward`."""
        which, records = steps.missions, steps.records
        values = np.array([self._value(record) for record in records])
        failed = np.array([np.isin(self.robot_ids, list(record.failed)) for record in records])
        team, are_new = values - self._values[which], failed & ~self._failed[which]
        self._values[which], self._failed[which] = values, failed
        return np.asarray(team[:, None] + (self.FAILED * are_new + self.for_contacts(steps)))

    def _value(self, record: StepRecord) -> float:
        """Return what the state of the victims is worth."""
        states, egress = record.mission.victims, record.egress
        doses = 0.0 if egress is None else sum(person.dose for person in egress.people)
        value = self.SAFE * record.mission.victims_saved + self.DEAD * states.count("dead") + self.DOSE * doses
        return value + self.LOCATED * sum(state in self._LOCATED for state in states)


def _areas_of(scenario: Scenario) -> str:
    """Return what is wrong with a scenario whose last area would end the mission; "" if it has none."""
    count = len(scenario.mission.areas)
    return f"mission.areas: {count}, the last of which ends a mission; expected none" if count else ""

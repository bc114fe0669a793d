"""What a team is rewarded for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.control.driving.known_map import UNREACHABLE_M, known_map
from robotteamsim.scenario.base import Point
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord


class Reward:
    """Zero; a subclass replaces `of_step`. Each mission has a new one."""

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents."""
        self.setup, self.robot_ids = setup, list(robot_ids)

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        return np.zeros(len(self.robot_ids))


class SearchReward(Reward):
    """For the team: areas explored, victims saved, time, and progress to the area; for each robot: contacts.

    Progress is that of the robot with the shortest path to the area on the known map. What it gains, it loses when it
    drives back; a new area is neither gain nor loss. It is a hint, and may change which policy is best.
    """

    AREA, VICTIM = 1.0, 2.0
    PER_METRE = 0.02
    PER_CONTACT_S, PER_S = -0.1, -0.002

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: robot_ids: of the agents."""
        super().__init__(setup, robot_ids)
        self._maps = [known_map(setup.building, setup.robots[i].reach_m) for i in robot_ids]
        self._explored = self._saved = 0
        self._path: tuple[Point, float] | None = None
        """The area, and the length of the shortest path to it [m]."""

    def of_step(self, record: StepRecord) -> np.ndarray:
        """Return the reward of each agent for one step of the simulation, shape (n,)."""
        status, step_s = record.mission, self.setup.scenario.run.step_s
        explored, saved = status.areas_explored, status.victims_saved
        team = self.AREA * (explored - self._explored) + self.VICTIM * (saved - self._saved) + self.PER_S * step_s
        self._explored, self._saved = explored, saved
        team += self.PER_METRE * self._gained_m(record)
        return team + self.PER_CONTACT_S * step_s * record.readings.state.contact[self.robot_ids]

    def _gained_m(self, record: StepRecord) -> float:
        area, before = record.mission.task.area_center_m, self._path
        self._path = None
        if area is None:
            return 0.0
        positions_m, is_there = record.readings.positions_m.tolist(), record.present.tolist()
        team = zip(self.robot_ids, self._maps, strict=True)
        lengths_m = [known.distance_m(area, tuple(positions_m[i])) for i, known in team if is_there[i]]
        length_m = min(lengths_m, default=UNREACHABLE_M)
        if length_m < UNREACHABLE_M:
            self._path = area, length_m
        return before[1] - length_m if before and self._path and before[0] == area else 0.0

"""What a team is rewarded for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from robotteamsim.control.driving.known_map import UNREACHABLE_M, known_map
from robotteamsim.scenario.base import Point
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord


class Reward:
    """Zero; a subclass replaces `of_step`. Each mission has a new one."""

    def __init__(self, setup: Setup) -> None:
        self.setup = setup

    def of_step(self, record: StepRecord, robot_ids: Sequence[int]) -> Mapping[int, float]:
        """Return the reward of each of these robots for one step of the simulation."""
        return dict.fromkeys(robot_ids, 0.0)


class SearchReward(Reward):
    """For the team: areas explored, victims saved, time, and progress to the area; for each robot: contacts.

    Progress is that of the robot with the shortest path to the area on the known map. What it gains, it loses when it
    drives back; a new area is neither gain nor loss. It is a hint, and may change which policy is best.
    """

    AREA, VICTIM = 1.0, 2.0
    PER_METRE = 0.02
    PER_CONTACT_S, PER_S = -0.1, -0.002

    def __init__(self, setup: Setup) -> None:
        super().__init__(setup)
        self._maps = [known_map(setup.building, robot.reach_m) for robot in setup.robots]
        self._explored = self._saved = 0
        self._path: tuple[Point, float] | None = None
        """The area, and the length of the shortest path to it [m]."""

    def of_step(self, record: StepRecord, robot_ids: Sequence[int]) -> Mapping[int, float]:
        """Return the reward of each of these robots for one step of the simulation."""
        status, step_s = record.mission, self.setup.scenario.run.step_s
        explored, saved = status.areas_explored, status.victims_saved
        team = self.AREA * (explored - self._explored) + self.VICTIM * (saved - self._saved) + self.PER_S * step_s
        self._explored, self._saved = explored, saved
        team += self.PER_METRE * self._gained_m(record, robot_ids)
        contact = record.readings.state.contact
        return {i: team + self.PER_CONTACT_S * step_s * bool(contact[i]) for i in robot_ids}

    def _gained_m(self, record: StepRecord, robot_ids: Sequence[int]) -> float:
        area, positions_m, before = record.mission.task.area_center_m, record.readings.positions_m, self._path
        here = [i for i in robot_ids if record.is_there(i)]
        self._path = None
        if area is None or not here:
            return 0.0
        length_m = min(self._maps[i].distance_m(area, (positions_m[i, 0], positions_m[i, 1])) for i in here)
        if length_m < UNREACHABLE_M:
            self._path = area, length_m
        return before[1] - length_m if before and self._path and before[0] == area else 0.0

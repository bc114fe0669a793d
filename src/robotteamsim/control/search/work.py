"""What a robot that searches does next: listen at a place, approach a voice, explore an area, or wait."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.control.driving.driver import Driver
from robotteamsim.control.search.areas import Areas, EarlyDrive, shut_cells
from robotteamsim.control.search.cells import NO_CELL, CellGrid, cell_paths, reachable_cell
from robotteamsim.control.search.connected import ConnectedTeam
from robotteamsim.control.search.goals import Approach, ListeningGoal
from robotteamsim.control.search.hunt import Hunted
from robotteamsim.control.search.knowledge import Knowledge
from robotteamsim.control.search.team import LONGEST_PATH_M, HeardVoice, Teammates, Work
from robotteamsim.interface import Task
from robotteamsim.scenario.building import Doors
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.scenario.fire import Block
from robotteamsim.scenario.sections import Area
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_AHEAD_M = 8.0
"""A robot drives to the farthest place on its path that it can reach in a straight line, within this length [m]."""

_IDLE_S = 5.0
"""A robot without work waits this long before it ends the search, so that messages in transit can arrive [s]."""

_AROUND_M = 5.0
"""A path that is longer than the straight line by more leads around a wall, behind which the victim is [m]."""

_FREE_WITHIN_M = 0.3
"""How far from the loudest place the free place may be to which a robot drives [m]."""


class Paths:
    """The paths of one robot between all cells, with doors and heat as known, and those outside the last area."""

    def __init__(self, robot_id: int, setup: Setup, grid: CellGrid, areas: Areas) -> None:
        self._building, self._reach_m = setup.map_of(robot_id), setup.robots[robot_id].reach_m
        self._start_m, self._grid = setup.start_m(robot_id), grid
        self.update((), (), areas)

    def update(self, doors: Doors, hot: tuple[Block, ...], areas: Areas) -> None:
        """Use the paths with doors, hot places and areas as they are now."""
        shared, key = self._building.shared, (self._reach_m, self._grid, doors)
        self.all = shared(cell_paths, *key, None, hot)
        self.outside = shared(cell_paths, *key, areas.kept_out, hot)
        self.shut = shut_cells(self.all, self.outside, self._start_m, self._grid.size)
        """The cells that cannot be reached without entering the last area, bool."""
        self.start = self.all.start_of(self._start_m)
        """The cell where the robot starts."""


class WorkChoice:
    """The work of one robot, chosen again in each iteration from what the team knows and does."""

    def __init__(
        self,
        robot_id: int,
        setup: Setup,
        grid: CellGrid,
        driver: Driver,
        knowledge: Knowledge,
        team: Teammates,
        areas: Areas,
        paths: Paths,
    ) -> None:
        scenario = setup.scenario
        self._tuning = scenario.control.as_kind(SearchControl)
        self._speed_mps = self._tuning.max_step_speed_mps
        self._save_distance_m = scenario.mission.save_distance_m
        self._time_limit_s = scenario.mission.time_limit_s
        self._robot_id, self._grid, self._driver = robot_id, grid, driver
        self._knowledge, self._team = knowledge, team
        self._areas, self._paths = areas, paths
        self._usable = paths.all
        """The paths that it may use now."""
        self._listening = ListeningGoal(self._tuning, self._speed_mps)
        self._meanwhile = ListeningGoal(self._tuning, self._speed_mps)
        """Where a robot listens while a teammate drives to the last area: its time costs nothing."""
        self._approach = Approach(self._tuning, self._speed_mps)
        self._early_drive = EarlyDrive()
        self._connected = ConnectedTeam(robot_id, setup, grid, team) if self._tuning.network == "connected" else None
        if self._connected is not None:
            self._connected.use((), paths.all)
        self._voice: Hunted | None = None
        self._idle_since_s: float | None = None
        self.at = self.goal = NO_CELL
        """The cells where the robot is and where it goes."""
        self.work: Work = "search"
        self.target: Vector | None = None
        """Where it drives now, in `map` [m]; None: it stands still."""
        self._way = NO_CELL, paths.all
        """The cell to which it drives, NO_CELL for a place beside it, and the paths that it may use."""
        self.done = ""
        """Why the search is over, in one line; "" while it is not."""

    @property
    def announced_voice(self) -> HeardVoice | None:
        """The voice that the robot approaches, as its team hears of it."""
        if self._voice is None or self.work != "voice":
            return None
        return HeardVoice(self._voice.source_m, min(self._approach.path_m, LONGEST_PATH_M))

    @property
    def shown_goal(self) -> Vector | None:
        """Where the robot goes in the end, in `map` [m]."""
        place = self._paths.all.place_of(self.goal) if self.goal != NO_CELL else None
        return place or self.target

    def begin_epoch(self) -> None:
        """Try again what was avoided or given up, because the voices have changed."""
        self._listening.forget_avoided()
        self._approach.forget_given_up()

    @property
    def closed_area_m(self) -> Vector | None:
        """The centre of the next area if the robot knows no path to it, in `map` [m]; else None."""
        return self._areas.closed_center_m

    def follow(self, task: Task, position: Vector, *, map_changed: bool, doors_changed: bool) -> None:
        """Use areas and paths as they are now."""
        if doors_changed:
            self._listening.forget_avoided()
        closed_m = self.closed_area_m
        area_changed = self._areas.follow(task)
        if area_changed or doors_changed:
            self._meanwhile.forget_avoided()
        if area_changed or map_changed or self._areas.must_be_measured:
            self._paths.update(self._driver.doors, self._driver.hot.blocked, self._areas)
            self._areas.measure(self._paths.all, self._paths.all.start_of(position))
            if self._connected is not None:
                self._connected.use(self._driver.doors, self._paths.all)
        if self.closed_area_m != closed_m:
            self._idle_since_s = None  # The mission may name another area first.

    def best_area(self, areas: Sequence[Area], position: Vector) -> int:
        """Return the number in a list of the area with the most expected victims per second, then of the nearest one.

        Args: position: in `map` [m].
        """
        paths, knowledge, worth = self._paths.all, self._knowledge, []
        start = paths.start_of(position)
        for area in areas:
            cell, rate, length_m = self._areas.cell_in(area, paths, start), 0.0, math.inf
            if cell != NO_CELL:
                length_m = paths.length_m(cell, start)
                speed_mps, delay_s = self._speed_mps, self._tuning.delay_s
                _, _, rate = knowledge.belief.worth(paths, start, cell, self._team.claims, speed_mps, delay_s)
            worth.append((rate, -length_m))
        return worth.index(max(worth))

    def locate(self, position: Vector) -> int:
        """Note where the robot is, in `map` [m], and return its cell; NO_CELL if it is far from all free cells."""
        self.at = self._paths.all.start_of(position)
        return self.at

    def choose(self, position: Vector, voice: Hunted | None, time_s: float, elapsed_s: float) -> None:
        """Choose what to do now, and where to drive.

        Args: position: in `map` [m].  voice: that the robot hears or has heard.  elapsed_s: of the mission.
        """
        self._choose_work(position, voice, time_s, elapsed_s)
        if self._connected is not None:
            to, paths = self._way
            self.target = self._connected.steer(position, self.at, self.work, to, self.target, paths, time_s)
            if self._connected.waits:
                self._approach.pause(self._tuning.iteration_s)
                self._listening.pause(self._tuning.iteration_s)

    @property
    def wanted(self) -> int | msgspec.UnsetType:
        """The cell where the robot wants to be next, for a team that stays connected."""
        return self._connected.wanted if self._connected is not None else msgspec.UNSET

    @property
    def is_long_held(self) -> bool:
        """Whether the robot has been held for long, in a team that stays connected."""
        return self._connected is not None and self._connected.is_long_held

    def _choose_work(self, position: Vector, voice: Hunted | None, time_s: float, elapsed_s: float) -> None:
        self.done, self._voice, start = "", voice, self.at
        self._choose_paths()
        spare_s = self._spare_s(start, elapsed_s)
        urgent = spare_s < self._tuning.reserve_s
        # When time is short, a voice is still approached if the spare time is enough to go there and back.
        longest_m = 0.5 * self._speed_mps * spare_s / self._tuning.reserve if urgent else math.inf
        allowed = start if self._usable is self._paths.all else self._usable.start_of(position)
        if voice is not None and self._approach_voice(voice, position, allowed, longest_m, time_s):
            self._listening.clear()
            self._idle_since_s = None
            return
        goal = self._listen_next(self._listening, allowed, self._least_worth, time_s) if not urgent else NO_CELL
        if self._goes_to_area(start, goal, urgent, time_s):
            self._listening.clear()
            ends = self._areas.is_last or allowed == NO_CELL
            ends = ends or not math.isfinite(self._usable.length_m(self._areas.cell, allowed))
            self._set_goal("area", self._areas.cell, position, self._paths.all if ends else self._usable)
            return
        is_early = self._early_drive.is_needed(self._areas, self._team, self._paths.all, start, self._search_m)
        if is_early and not urgent and allowed != NO_CELL:
            beside = self._areas.cell_beside(self._paths.outside, allowed)
            linked = self._linked("wait")
            if beside != NO_CELL and (linked is None or linked[beside]):
                goal = NO_CELL if beside == allowed else beside  # there it waits, so that others may explore
                self._listening.clear()
        if goal != NO_CELL:
            self._idle_since_s = None
            self._set_goal("search", goal, position, self._usable)
        else:
            self._wait(position, allowed, time_s)

    def _choose_paths(self) -> None:
        """Choose whether the robot may enter the last area."""
        if (
            self._areas.num_left > 2
            or not self._areas.num_left
            or (self._areas.num_left == 2 and self._is_work_in_shut_cells())
        ):
            self._usable = self._paths.all
        else:
            self._usable = self._paths.outside

    def _is_work_in_shut_cells(self) -> bool:
        """Whether a victim may be in the last area or behind it; the area before it is then explored later.

        What is expected there must be worth the delay of the end: the path to the last area, shared by the team.
        """
        shut = self._paths.shut
        if self._voice is not None:
            source = reachable_cell(self._paths.all, self._grid, self._voice.source_m, self.at, self._save_distance_m)
            if source != NO_CELL and shut[source]:
                return True
        for update in self._team.updates:
            cells = [cell for cell in (update.at, update.goal) if cell != NO_CELL]
            if update.work in ("search", "voice") and any(shut[cell] for cell in cells):
                return True
        expected = self._knowledge.victims_per_share * float(self._knowledge.mass()[shut].sum())
        delay_s = self._areas.tour_m / self._speed_mps / (1 + len(self._team.updates))
        return expected * self._tuning.victim_worth_s > delay_s

    def _set_goal(self, work: Work, cell: int, position: Vector, paths: _core.control.CellPaths) -> None:
        self.work, self.goal = work, cell
        self._drive_to(cell, position, paths)

    def _drive_to(self, cell: int, position: Vector, paths: _core.control.CellPaths) -> None:
        self._way = cell, paths
        self.target = paths.ahead(position, cell, _AHEAD_M)

    @property
    def _least_worth(self) -> float:
        """What a place must be worth, in shares of the prior per second of travel."""
        return 1.0 / (self._tuning.victim_worth_s * self._knowledge.victims_per_share)

    def _listen_next(self, listening: ListeningGoal, start: int, least: float, time_s: float) -> int:
        if start == NO_CELL:
            return NO_CELL
        knowledge, candidates = self._knowledge, self._knowledge.places.candidates
        waits = self.work == "wait"
        claims = self._team.kept_claims(self.at, self._paths.all) if waits else self._team.claims
        prior_claims = self._team.prior_claims(listening.cell, self.at, self._paths.all)
        linked = self._linked("search")
        if linked is not None:
            candidates = [cell for cell in candidates if linked[cell]]
            if listening.cell != NO_CELL and not linked[listening.cell]:
                listening.clear()
        cell = listening.choose(
            knowledge.belief,
            self._usable,
            start,
            candidates,
            claims,
            prior_claims,
            least,
            time_s,
        )
        if cell == NO_CELL and linked is not None:
            listening.clear()
        return cell

    def _linked(self, work: Work) -> np.ndarray | None:
        """Return the cells that a robot with this work may choose, bool; None: all, as in a free team."""
        return self._connected.linked(work) if self._connected is not None else None

    def _approach_voice(self, voice: Hunted, position: Vector, start: int, longest_m: float, time_s: float) -> bool:
        """Drive towards a voice; return False if the robot leaves it to a teammate, or cannot reach it.

        Args: start: the cell from which the robot may drive.  longest_m: of a path for which there is time [m].
        """
        if self._approach.has_given_up(voice.source_m, time_s):
            return False
        if math.dist(self._areas.nearest_outside(voice.source_m), voice.source_m) > self._save_distance_m:
            return False  # To save this victim would end the mission.
        goal = reachable_cell(self._usable, self._grid, voice.source_m, start, self._save_distance_m)
        length_m = self._usable.length_m(goal, start) if goal != NO_CELL else math.inf
        if longest_m < length_m < math.inf:
            return False
        if self._team.approaches(voice.source_m, length_m, self._tuning.same_voice_m):
            return False
        if not self._approach.goes_on(voice.source_m, length_m, time_s, was_on=self.work == "voice"):
            return False
        self._set_goal("voice", goal, position, self._usable)
        if voice.follow_m is not None and length_m <= math.dist(position, voice.source_m) + _AROUND_M:
            beside = self._place_beside(position, voice.follow_m)
            if beside is not None:
                self._way, self.target = (NO_CELL, self._usable), beside
        return True

    def _place_beside(self, position: Vector, loudest_m: Vector) -> Vector | None:
        """Return the free place at the loudest place; None if no straight line leads to it, as through a wall."""
        grid = self._driver.map.grid
        place = grid.nearest_free(self._areas.nearest_outside(loudest_m), _FREE_WITHIN_M)
        if place is None or not grid.is_line_free(position, place) or self._areas.would_end(position, place):
            return None
        return place

    def _spare_s(self, start: int, elapsed_s: float) -> float:
        """Return the time left beyond what is needed to explore the areas [s]; infinity if there are none."""
        if not self._areas.is_possible:
            return math.inf
        nearest_m, _ = min(self._team.lengths_m(self._areas.cell, start, self._paths.all))
        tour_s = (nearest_m + self._areas.tour_m) / self._speed_mps
        return self._time_limit_s - elapsed_s - self._tuning.reserve * tour_s

    def _is_nearest(self, start: int, works: tuple[Work, ...] = ()) -> bool:
        """Whether no teammate that goes to the next area is nearer to it.

        Args: works: of the teammates to consider; empty for all.
        """
        lengths_m = self._team.lengths_m(self._areas.cell, start, self._paths.all, works)
        if self._areas.rivals is not None:
            lengths_m = [one for one in lengths_m if one[1] in (self._robot_id, *self._areas.rivals)]
        return min(lengths_m)[1] == self._robot_id

    def _goes_to_area(self, start: int, goal: int, urgent: bool, time_s: float) -> bool:
        """Whether this robot explores the next area now.

        Args: goal: the cell where it would listen otherwise; NO_CELL for none.
        """
        areas = self._areas
        if not areas.is_possible or start == NO_CELL:
            return False
        if urgent:
            return self._is_nearest(start)
        linked = self._linked("area")
        if linked is not None and not linked[areas.cell]:
            return False
        keeps = self.work == "area" and self.goal == areas.cell
        if areas.is_last:
            is_over = goal == NO_CELL and self._team.all_wait and self._has_been_idle(2.0, time_s)
            return is_over and (keeps or self._is_nearest(start))
        if areas.num_left == 2 and self._usable is self._paths.all and not self._is_all_done(goal):
            return False
        if keeps and self._is_nearest(start, ("search", "wait", "area")):
            return True  # A robot whose goal changed with its position could drive back and forth forever.
        if not keeps and any(update.work == "area" and update.goal == areas.cell for update in self._team.updates):
            return False
        if goal == NO_CELL:
            return self._is_nearest(start, ("wait", "area"))
        to_area_m = self._paths.all.length_m(areas.cell, start)
        if to_area_m + areas.tour_m >= self._search_m:
            return self._is_nearest(start, ("search", "wait", "area"))
        detour_m = to_area_m + self._paths.all.length_m(areas.cell, goal) - self._paths.all.length_m(goal, start)
        return detour_m / self._speed_mps <= self._tuning.detour_s

    @property
    def _search_m(self) -> float:
        """How far each robot drives until the team has searched the remaining floor, if all goes well [m]."""
        open_m2 = self._knowledge.remaining * self._knowledge.open_m2
        return open_m2 / (2.0 * self._knowledge.hearing_m * (1 + len(self._team.updates)))

    def _is_all_done(self, goal: int) -> bool:
        """Whether no robot searches or approaches a voice. Args: goal: where this robot would listen."""
        return goal == NO_CELL and all(update.work in ("wait", "area") for update in self._team.updates)

    def _has_been_idle(self, for_s: float, time_s: float) -> bool:
        return self._idle_since_s is not None and time_s - self._idle_since_s >= for_s

    def _wait(self, position: Vector, start: int, time_s: float) -> None:
        """Have nothing to do: wait at a later area, or end the search if no area is left."""
        if self._idle_since_s is None or (self._connected is not None and self._connected.is_behind("search")):
            self._idle_since_s = time_s
        self.work, self.goal, self.target = "wait", NO_CELL, None
        self._way = NO_CELL, self._usable
        if self._areas.is_possible:
            cell = self._cell_to_wait_at(start)
            if start != NO_CELL and self._areas.nearest_outside(position) != position:
                self.target = self._usable.place_of(start)  # It was pushed into the last area.
            elif cell != NO_CELL:
                linked = self._linked("wait")
                if cell != start and (linked is None or linked[cell]):
                    self._drive_to(cell, position, self._usable)
            elif self._connected is None and self._is_last_area_taken:
                self._listen_meanwhile(position, start, time_s)
        elif self._team.all_wait and self._has_been_idle(_IDLE_S, time_s):
            self.done = self._reason()

    @property
    def _is_last_area_taken(self) -> bool:
        """Whether a teammate drives to the last area now."""
        return self._areas.is_last and any(update.work == "area" for update in self._team.updates)

    def _cell_to_wait_at(self, start: int) -> int:
        """Return where a robot waits for the turn of an area; NO_CELL if others wait at all of them."""
        if start == NO_CELL:
            return NO_CELL
        areas = self._areas
        if areas.last_cell == NO_CELL:
            return NO_CELL
        waiting = self._team.lengths_m(areas.last_cell, self.at, self._paths.all, ("wait",))
        nearest = min(waiting)[1]
        if nearest == self._robot_id:
            return areas.cell_beside(self._paths.outside, start)
        before = sum(robot_id < self._robot_id and robot_id != nearest for _, robot_id in waiting)
        return areas.middle_cell(before)

    def _listen_meanwhile(self, position: Vector, start: int, time_s: float) -> None:
        """Listen where most is expected, however little, until a teammate ends the mission."""
        cell = self._listen_next(self._meanwhile, start, 0.0, time_s)
        if cell != NO_CELL:
            self.goal = cell
            self._drive_to(cell, position, self._usable)

    def _reason(self) -> str:
        """Return why the search is over, in a few words."""
        if not self._knowledge.places.num_open:
            return "no free place can be reached"
        share = f"{self._knowledge.remaining:.1%} of the floor is unheard, which is worth less than the time"
        if self._areas.next is not None:
            return f"{self._areas.next.name} cannot be reached; {share}"
        lost_m = self._approach.lost_m
        if lost_m is not None and not self._knowledge.has_found_at(lost_m):
            x_m, y_m = lost_m
            return f"a voice near ({x_m:.1f}, {y_m:.1f}) cannot be reached; {share}"
        return share

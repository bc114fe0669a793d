"""One robot of a team that searches: it listens where victims are expected, saves whom it hears, explores areas."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.control.driving.driver import Driver
from robotteamsim.control.rdpso.door_beliefs import DoorBeliefs
from robotteamsim.control.search.areas import Areas, EarlyDrive, shut_cells
from robotteamsim.control.search.cells import NO_CELL, Places, cell_grid, cell_paths, places, reachable_cell
from robotteamsim.control.search.goals import Approach, ListeningGoal
from robotteamsim.control.search.hunt import Hunt, Hunted
from robotteamsim.control.search.knowledge import Knowledge
from robotteamsim.control.search.team import LONGEST_PATH_M, HeardVoice, SearchUpdate, Teammates, Work, update_of
from robotteamsim.geometry import Pose
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_AHEAD_M = 8.0
"""A robot drives to the farthest place on its path that it can reach in a straight line, within this length [m]."""

_SHOWN_S = 5.0
"""Period with which a robot publishes its belief for display [s]."""

_IDLE_S = 5.0
"""A robot without work waits this long before it ends the search, so that messages in transit can arrive [s]."""

_SPACING = 0.25
"""Distance of places to listen at, if it is above `place_spacing_m`: this share of the hearing distance."""

_AROUND_M = 5.0
"""A path that is longer than the straight line by more leads around a wall, behind which the victim is [m]."""

_FREE_WITHIN_M = 0.3
"""How far from the loudest place the free place may be to which a robot drives [m]."""


class SearchController:
    """Bayesian search, see `docs/search.md`.

    In each iteration the robot listens, updates its belief, chooses its work, and sends an update of what it knows and
    plans. It uses its map, its readings, the messages of its teammates and the mission's order of areas.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        scenario, body = setup.scenario, setup.robots[robot_id]
        control = scenario.control.as_kind(SearchControl)
        self._robot_id, self._scenario, self._building = robot_id, scenario, setup.building
        self._tuning = control
        self._speed_mps = control.max_step_speed_mps
        self._iteration_ns = round(control.iteration_s * 1e9)
        self._reach_m = body.reach_m
        self._save_distance_m = scenario.mission.save_distance_m
        self._driver = Driver(robot_id, setup)
        self._doors = DoorBeliefs(scenario.plan, body.laser, control.doors)
        self._grid = cell_grid(scenario)
        self._areas = Areas(scenario, self._grid)
        self._start_m = setup.start_m(robot_id)
        self._start = self._use_paths(self._start_m)
        self._places = self._find_places(1)
        self._knowledge = Knowledge(setup, self._grid, self._places)
        self._space_places()
        self._hunt, self._early_drive = Hunt(scenario, self._grid), EarlyDrive()
        self._team = Teammates(robot_id, self._tuning.given_up_s)
        self._listening = ListeningGoal(self._tuning, self._speed_mps)
        self._meanwhile = ListeningGoal(self._tuning.model_copy(update={"victim_worth_s": math.inf}), self._speed_mps)
        """Where a robot listens while a teammate drives to the last area: its time costs nothing."""

        self._epoch, self._iteration, self._elapsed_ns = 0, -1, 0
        self._last_ns: int | None = None
        """The stamp of the last step in which the mission was running."""
        self._at = self._goal = NO_CELL
        self._work: Work = "search"
        self._target: Vector | None = None
        self._voice: Hunted | None = None
        self._num_found = 0
        """How many found victims the robot knew in the last iteration."""
        self._was_beside_m: Vector | None = None
        self._approach = Approach(self._tuning, self._speed_mps)
        self._idle_since_s: float | None = None
        self._done, self._next_shown_s = "", 0.0
        self._standing = Decision()
        """The decision to stand still in this iteration."""

    @property
    def knowledge(self) -> Knowledge:
        """What the robot knows about victims."""
        return self._knowledge

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and, once per iteration, the message of this step."""
        self._note(observation, inbox, task)
        return self._decide(observation, task) if task.running else Decision()

    def _note(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        if task.epoch != self._epoch:
            self._epoch = task.epoch
            self._note_found(observation)
            self._listening.forget_avoided()
            self._approach.forget_given_up()
        self._knowledge.noise.note(observation.voice, task.epoch)
        self._was_beside_m = self._hunt.beside(observation.voice) if observation.voice.heard else None
        if task.running:
            if self._last_ns is not None:
                self._elapsed_ns += observation.sim_time_ns - self._last_ns
            self._last_ns = observation.sim_time_ns
        else:
            self._last_ns = None
        for message in inbox:
            self._hear(message, observation.sim_time_ns * 1e-9)

    def _decide(self, observation: Observation, task: Task) -> Decision:
        sim_time_ns, pose = observation.sim_time_ns, self._driver.pose(observation)
        outbox: tuple[Message, ...] = ()
        belief: FieldMap | None = None
        iteration = sim_time_ns // self._iteration_ns
        if iteration != self._iteration:
            self._iteration = iteration
            self._iterate(pose, observation, task)
            outbox = (Message(self._robot_id, EVERYBODY, self._update(pose).to_json()),)
            belief = self._shown_belief(sim_time_ns * 1e-9)
            self._standing = Decision(goal_m=self._shown_goal(), local_best=self._knowledge.remaining, done=self._done)
        if self._target is None:
            return msgspec.structs.replace(self._standing, outbox=outbox, belief=belief)
        twist = self._driver.drive(observation, pose, self._target, self._speed_mps, lambda: self._team.positions)
        return msgspec.structs.replace(self._standing, twist=twist, outbox=outbox, belief=belief)

    def _shown_belief(self, time_s: float) -> FieldMap | None:
        """Return the belief for display, once per period."""
        if time_s < self._next_shown_s or not self._places.num_open:
            return None
        self._next_shown_s = time_s + _SHOWN_S
        grid = self._grid
        # The prior is the same in all these cells.
        percent = (100.0 * self._places.num_open * self._knowledge.mass()).reshape(grid.rows, grid.columns)
        return FieldMap(grid.origin_m, grid.cell_m, percent.astype(np.float32))

    def _hear(self, message: Message, time_s: float) -> None:
        update = update_of(message)
        if update is None or update.robot_id == self._robot_id:
            return
        if max(update.goal, update.at) >= self._grid.size or not self._knowledge.merge(update.listened, update.found):
            return
        self._team.hear(update, time_s)
        self._doors.hear(update.doors)
        # A robot that arrives later does not know how long the mission has been running.
        self._elapsed_ns = max(self._elapsed_ns, round(update.elapsed_s * 1e9))

    def _update(self, pose: Pose) -> SearchUpdate:
        voice = None
        if self._voice is not None and self._work == "voice":
            voice = HeardVoice(self._voice.source_m, min(self._approach.path_m, LONGEST_PATH_M))
        return SearchUpdate(
            robot_id=self._robot_id,
            position=(pose.x_m, pose.y_m),
            at=self._at,
            work=self._work,
            goal=self._goal,
            voice=voice,
            noise_db=self._knowledge.measured_noise_db,
            elapsed_s=self._elapsed_ns * 1e-9,
            found=tuple(self._knowledge.found),
            listened=self._knowledge.log.to_text(self._tuning.shared_places, self._tuning.repeated_places),
            doors=self._doors.sightings,
        )

    def _shown_goal(self) -> Vector | None:
        place = self._all_paths.place_of(self._goal) if self._goal != NO_CELL else None
        return place or self._target

    def _iterate(self, pose: Pose, observation: Observation, task: Task) -> None:
        """Listen, and choose the work and the goal of this iteration."""
        position, time_s = (pose.x_m, pose.y_m), observation.sim_time_ns * 1e-9
        self._team.forget_lost(time_s)
        self._doors.look(pose, observation.robot.ranges_m, self._iteration)
        areas_changed = self._areas.follow(task)
        doors_changed = self._driver.update_map(observation.sim_time_ns, self._doors.changed)
        if doors_changed:
            self._knowledge.use_doors(self._doors.changed)
            self._listening.forget_avoided()
        if areas_changed or doors_changed:
            start = self._use_paths(position)
            self._areas.measure(self._all_paths, start)
            self._meanwhile.forget_avoided()
        knowledge, voice = self._knowledge, observation.voice
        of_team_db = [update.noise_db for update in self._team.updates if update.noise_db is not None]
        if knowledge.agree_on_noise(of_team_db):
            self._space_places()
        if self._voice is not None and self._is_found(self._voice.source_m, knowledge.found[self._num_found :]):
            self._hunt.forget()
        self._num_found = len(knowledge.found)
        mass = knowledge.mass() if voice.heard or self._hunt.is_on else self._places.prior
        self._voice = self._hunt.follow(voice, task.epoch, position, knowledge.losses, mass, self._places.prior)
        self._at = start = self._all_paths.start_of(position)
        if start != NO_CELL:
            knowledge.listen(start, voice)
        self._choose(position, start, time_s)

    def _is_found(self, source_m: Vector, found: Sequence[Vector]) -> bool:
        """Whether one of the found victims is where a voice came from."""
        return any(math.dist(place, source_m) <= self._tuning.same_voice_m for place in found)

    def _space_places(self) -> None:
        """Choose the places to listen at: the farther a robot hears, the fewer."""
        spacing_m = max(self._tuning.place_spacing_m, _SPACING * self._knowledge.hearing_m)
        self._places = self._find_places(max(1, round(spacing_m / self._grid.cell_m)))

    def _find_places(self, stride: int) -> Places:
        return self._building.shared(places, self._reach_m, self._grid, self._start, self._save_distance_m, stride)

    def _use_paths(self, position: Vector) -> int:
        """Use the paths with doors and areas as they are now; return the cell of the robot."""
        shared, key = self._building.shared, (self._reach_m, self._grid, self._driver.doors)
        self._all_paths = shared(cell_paths, *key, None)
        self._outside = shared(cell_paths, *key, self._areas.kept_out)
        self._shut = shut_cells(self._all_paths, self._outside, self._start_m, self._grid.size)
        return self._all_paths.start_of(position)

    def _choose_paths(self) -> None:
        """Choose whether the robot may enter the last area."""
        if self._areas.num_left > 2 or not self._areas.num_left:
            self._paths = self._all_paths
        else:
            self._paths = (
                self._all_paths if self._areas.num_left == 2 and self._is_work_in_shut_cells() else self._outside
            )

    def _is_work_in_shut_cells(self) -> bool:
        """Whether a victim may be in the last area or behind it; the area before it is then explored later.

        What is expected there must be worth the delay of the end: the path to the last area, shared by the team.
        """
        shut = self._shut
        if self._voice is not None:
            source = reachable_cell(self._all_paths, self._grid, self._voice.source_m, self._at, self._save_distance_m)
            if source != NO_CELL and shut[source]:
                return True
        for update in self._team.updates:
            cells = [cell for cell in (update.at, update.goal) if cell != NO_CELL]
            if update.work in ("search", "voice") and any(shut[cell] for cell in cells):
                return True
        expected = self._knowledge.victims_per_share * float(self._knowledge.mass()[shut].sum())
        delay_s = self._areas.tour_m / self._speed_mps / (1 + len(self._team.updates))
        return expected * self._tuning.victim_worth_s > delay_s

    def _choose(self, position: Vector, start: int, time_s: float) -> None:
        """Choose what to do now."""
        self._done = ""
        self._choose_paths()
        urgent = self._is_urgent(start)
        allowed = start if self._paths is self._all_paths else self._paths.start_of(position)
        if self._voice is not None and not urgent and self._approach_voice(self._voice, position, allowed, time_s):
            self._listening.clear()
            self._idle_since_s = None
            return
        goal = self._listen_next(self._listening, allowed, time_s) if not urgent else NO_CELL
        if self._goes_to_area(start, goal, urgent, time_s):
            self._listening.clear()
            ends = self._areas.is_last or allowed == NO_CELL
            ends = ends or not math.isfinite(self._paths.length_m(self._areas.cell, allowed))
            self._set_goal("area", self._areas.cell, position, self._all_paths if ends else self._paths)
            return
        is_early = self._early_drive.is_needed(self._areas, self._team, self._all_paths, start, self._search_m)
        if is_early and not urgent and allowed != NO_CELL:
            beside = self._areas.cell_beside(self._outside, allowed)
            if beside != NO_CELL:
                goal = NO_CELL if beside == allowed else beside  # there it waits, so that others may explore
                self._listening.clear()
        if goal != NO_CELL:
            self._idle_since_s = None
            self._set_goal("search", goal, position, self._paths)
        else:
            self._wait(position, allowed, time_s)

    def _set_goal(self, work: Work, cell: int, position: Vector, paths: _core.control.CellPaths) -> None:
        self._work, self._goal = work, cell
        self._target = paths.ahead(position, cell, _AHEAD_M)

    def _listen_next(self, listening: ListeningGoal, start: int, time_s: float) -> int:
        if start == NO_CELL:
            return NO_CELL
        knowledge = self._knowledge
        return listening.choose(
            knowledge.belief,
            self._paths,
            start,
            self._places.candidates,
            self._team.kept_claims(self._at, self._all_paths) if self._work == "wait" else self._team.claims,
            self._team.prior_claims(listening.cell, self._at, self._all_paths),
            knowledge.victims_per_share,
            time_s,
        )

    def _note_found(self, observation: Observation) -> None:
        """Note a victim whom the robot has reached: a voice beside it that falls silent in a new epoch."""
        if self._was_beside_m is None:
            return
        pose, voice = self._driver.pose(observation), observation.voice
        within_m = self._save_distance_m + self._scenario.voice.map_resolution_m
        is_silent = not voice.heard or math.dist(voice.local_best_m, self._was_beside_m) > within_m
        if is_silent and math.dist((pose.x_m, pose.y_m), self._was_beside_m) <= within_m:
            self._knowledge.add_found(self._was_beside_m)
        self._was_beside_m = None

    def _approach_voice(self, voice: Hunted, position: Vector, start: int, time_s: float) -> bool:
        """Drive towards a voice; return False if the robot leaves it to a teammate, or cannot reach it.

        Args: start: the cell from which the robot may drive.
        """
        if self._approach.has_given_up(voice.source_m, time_s):
            return False
        if math.dist(self._areas.nearest_outside(voice.source_m), voice.source_m) > self._save_distance_m:
            return False  # To save this victim would end the mission.
        goal = reachable_cell(self._paths, self._grid, voice.source_m, start, self._save_distance_m)
        length_m = self._paths.length_m(goal, start) if goal != NO_CELL else math.inf
        if self._team.approaches(voice.source_m, length_m, self._tuning.same_voice_m):
            return False
        if not self._approach.goes_on(voice.source_m, length_m, time_s, was_on=self._work == "voice"):
            return False
        self._set_goal("voice", goal, position, self._paths)
        if voice.follow_m is not None and length_m <= math.dist(position, voice.source_m) + _AROUND_M:
            self._target = self._place_beside(position, voice.follow_m) or self._target
        return True

    def _place_beside(self, position: Vector, loudest_m: Vector) -> Vector | None:
        """Return the free place at the loudest place; None if no straight line leads to it, as through a wall."""
        grid = self._driver.map.grid
        place = grid.nearest_free(self._areas.nearest_outside(loudest_m), _FREE_WITHIN_M)
        if place is None or not grid.is_line_free(position, place) or self._areas.would_end(position, place):
            return None
        return place

    def _is_urgent(self, start: int) -> bool:
        """Whether the time left is needed to explore the areas."""
        if not self._areas.is_possible:
            return False
        nearest_m, _ = min(self._team.lengths_m(self._areas.cell, start, self._all_paths))
        tour_s = (nearest_m + self._areas.tour_m) / self._speed_mps
        left_s = self._scenario.mission.time_limit_s - self._elapsed_ns * 1e-9
        return left_s < self._tuning.reserve * tour_s + self._tuning.reserve_s

    def _is_nearest(self, start: int, works: tuple[Work, ...] = ()) -> bool:
        """Whether no teammate is nearer to the next area. Args: works: of the teammates to consider; empty for all."""
        return min(self._team.lengths_m(self._areas.cell, start, self._all_paths, works))[1] == self._robot_id

    def _goes_to_area(self, start: int, goal: int, urgent: bool, time_s: float) -> bool:
        """Whether this robot explores the next area now.

        Args: goal: the cell where it would listen otherwise; NO_CELL for none.
        """
        areas = self._areas
        if not areas.is_possible or start == NO_CELL:
            return False
        if urgent:
            return self._is_nearest(start)
        keeps = self._work == "area" and self._goal == areas.cell
        if areas.is_last:
            is_over = goal == NO_CELL and self._team.all_wait and self._has_been_idle(2.0, time_s)
            return is_over and (keeps or self._is_nearest(start))
        if areas.num_left == 2 and self._paths is self._all_paths and not self._is_all_done(goal):
            return False
        if keeps and self._is_nearest(start, ("search", "wait", "area")):
            return True  # A robot whose goal changed with its position could drive back and forth forever.
        if not keeps and any(update.work == "area" and update.goal == areas.cell for update in self._team.updates):
            return False
        if goal == NO_CELL:
            return self._is_nearest(start, ("wait", "area"))
        to_area_m = self._all_paths.length_m(areas.cell, start)
        if to_area_m + areas.tour_m >= self._search_m:
            return self._is_nearest(start, ("search", "wait", "area"))
        detour_m = to_area_m + self._all_paths.length_m(areas.cell, goal) - self._all_paths.length_m(goal, start)
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
        if self._idle_since_s is None:
            self._idle_since_s = time_s
        self._work, self._goal, self._target = "wait", NO_CELL, None
        if self._areas.is_possible:
            cell = self._cell_to_wait_at(start)
            if start != NO_CELL and self._areas.nearest_outside(position) != position:
                self._target = self._paths.place_of(start)  # It was pushed into the last area.
            elif cell != NO_CELL:
                self._target = self._paths.ahead(position, cell, _AHEAD_M) if cell != start else None
            elif self._areas.is_last and any(update.work == "area" for update in self._team.updates):
                self._listen_meanwhile(position, start, time_s)
        elif self._team.all_wait and self._has_been_idle(_IDLE_S, time_s):
            self._done = self._reason()

    def _cell_to_wait_at(self, start: int) -> int:
        """Return where a robot waits for the turn of an area; NO_CELL if others wait at all of them."""
        if start == NO_CELL:
            return NO_CELL
        areas = self._areas
        if areas.last_cell == NO_CELL:
            return NO_CELL
        waiting = self._team.lengths_m(areas.last_cell, self._at, self._all_paths, ("wait",))
        nearest = min(waiting)[1]
        if nearest == self._robot_id:
            return areas.cell_beside(self._outside, start)
        before = sum(robot_id < self._robot_id and robot_id != nearest for _, robot_id in waiting)
        return areas.middle_cell(before)

    def _listen_meanwhile(self, position: Vector, start: int, time_s: float) -> None:
        """Listen where most is expected, however little, until a teammate ends the mission."""
        cell = self._listen_next(self._meanwhile, start, time_s)
        if cell != NO_CELL:
            self._goal = cell
            self._target = self._paths.ahead(position, cell, _AHEAD_M)

    def _reason(self) -> str:
        """Return why the search is over, in a few words."""
        if not self._places.num_open:
            return "no free place can be reached"
        share = f"{self._knowledge.remaining:.1%} of the floor is unheard, which is worth less than the time"
        if self._areas.next is not None:
            return f"{self._areas.next.name} cannot be reached; {share}"
        lost_m = self._approach.lost_m
        if lost_m is not None and not self._is_found(lost_m, self._knowledge.found):
            x_m, y_m = lost_m
            return f"a voice near ({x_m:.1f}, {y_m:.1f}) cannot be reached; {share}"
        return share

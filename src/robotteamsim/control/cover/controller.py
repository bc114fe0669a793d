"""Covering the floor: each robot goes to uncovered places, restrained by the communication term of eq. (22)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec

from robotteamsim.control.cover.floor_cover import CELL_M, CoverUpdate, FloorCover, parse_cover_update
from robotteamsim.control.driving.driver import Driver
from robotteamsim.control.driving.known_map import KnownMap
from robotteamsim.control.rdpso.terms import LinkKeeper, RuledOut
from robotteamsim.geometry import Pose, path_length_m
from robotteamsim.interface import Decision, Discovery, Observation, Task
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.controllers.cover import CoverControl
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector, limit_speed, next_position


class CoverController:
    """One robot of a team that covers the floor and announces each discovery to the base.

    In each iteration the robot sends an update of its knowledge and chooses v[t+1] of eq. (22): the local best is the
    place that covers the most new floor for its distance, or the loudest cell of a voice; the link keeper weighs x_CB.
    Inertia and the social term are omitted, because robots that cover a floor should be in different places; the
    navigator avoids obstacles. The base, `mission.base`, stands still, and sends updates like all others.
    """

    announces_victims = True

    def __init__(self, robot_id: int, setup: Setup) -> None:
        scenario = setup.scenario
        control = scenario.control.as_kind(CoverControl)
        self._robot_id = robot_id
        self._is_base = robot_id == scenario.base
        self._control = control
        self._iteration_ns = round(control.iteration_s * 1e9)
        self._found_within_m = scenario.mission.save_distance_m + scenario.voice.map_resolution_m
        self._level_at_1_m_db = -scenario.voice.constant_db[1]
        self._driver = Driver(robot_id, setup)
        self._cover = FloorCover(
            setup.map_of(robot_id), setup.robots[robot_id].reach_m, setup.start_m(robot_id), control.radius_m
        )
        self._links = LinkKeeper(robot_id, setup)
        self._ruled_out = RuledOut(scenario, control.rule_out_places)

        self._epoch = 0
        self._was_beside: VoiceReading | None = None
        """The voice of the previous step, if it was as loud as a victim within 1 m."""
        self._team: dict[int, tuple[float, CoverUpdate]] = {}
        """The last update of each teammate, and its time of arrival [s]."""
        self._teammates: dict[int, Vector] = {}
        self._found: list[Discovery] = []
        self._iteration = -1
        self._goal: Vector | None = None
        self._goal_m, self._goal_since_s = math.inf, 0.0
        """The shortest path length to the goal so far [m], and since when."""
        self._avoided: list[tuple[Vector, float]] = []
        """Avoided places, and until when [s]."""
        self._route = _Route(control.longest_path_m)
        self._target: Vector | None = None
        self._speed_mps = control.max_step_speed_mps

    @property
    def found(self) -> tuple[Discovery, ...]:
        """All victims that the robot knows to have been reached; it does not know their names."""
        return tuple(self._found)

    @property
    def covered_share(self) -> float:
        """The fraction of the floor that the robot knows to be covered."""
        return self._cover.share

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and, once per iteration, the message of this step."""
        self._note(observation, inbox, task)
        return self._decide(observation) if task.running else Decision()

    def _note(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        if task.epoch != self._epoch:
            self._epoch = task.epoch
            self._ruled_out.clear()
            self._note_victim(observation)
        self._driver.hot.look(observation.robot)
        voice = observation.voice
        is_beside = voice.heard and voice.local_best_level_db >= self._level_at_1_m_db
        self._was_beside = voice if is_beside else None
        for message in inbox:
            update = parse_cover_update(message.payload)
            if update is None or update.robot_id == self._robot_id or not self._cover.merge(update.covered):
                continue
            self._team[update.robot_id] = observation.sim_time_ns * 1e-9, update
            self._teammates[update.robot_id] = update.position
            self._driver.hot.hear_temperatures(update.hot or ())
            for victim in update.discoveries:
                self._add_victim(victim)

    def _decide(self, observation: Observation) -> Decision:
        sim_time_ns, pose = observation.sim_time_ns, observation.pose
        outbox: tuple[Message, ...] = ()
        iteration = sim_time_ns // self._iteration_ns
        if iteration != self._iteration:
            self._iteration = iteration
            self._driver.update_map(sim_time_ns)
            self._choose(pose, observation.voice, sim_time_ns * 1e-9)
            position, covered = (pose.x_m, pose.y_m), self._cover.to_hex()
            hot = self._driver.hot.seen or msgspec.UNSET
            update = CoverUpdate(self._robot_id, position, self._goal, covered, self.found, hot)
            outbox = (Message(self._robot_id, EVERYBODY, update.to_json()),)
        goal, target, speed_mps = self._goal, self._target, self._speed_mps
        if self._is_base:
            return Decision(outbox=outbox)
        leave = self._driver.shelter if target is None else self._driver.way_out
        cold = leave((pose.x_m, pose.y_m))
        if cold is not None:
            goal, target, speed_mps = cold, cold, self._control.max_step_speed_mps
        if target is None:
            return Decision(outbox=outbox)
        twist = self._driver.drive(observation, pose, target, speed_mps, lambda: self._teammates)
        return Decision(twist=twist, outbox=outbox, goal_m=goal)

    def _note_victim(self, observation: Observation) -> None:
        """Note a victim that the robot has reached: a voice next to it that falls silent.

        Another voice may still be heard there, but not as loud.
        """
        was = self._was_beside
        if was is None or observation.voice.local_best_level_db >= was.local_best_level_db:
            return
        pose = observation.pose
        if math.dist((pose.x_m, pose.y_m), was.local_best_m) <= self._found_within_m:
            time_s = observation.sim_time_ns * 1e-9
            self._add_victim(Discovery("victim", "", self._robot_id, was.local_best_m, time_s))

    def _add_victim(self, victim: Discovery) -> None:
        """Add a victim, unless one at that place is already known."""
        if all(math.dist(victim.position_m, known.position_m) > self._found_within_m for known in self._found):
            self._found.append(victim)

    def _choose(self, pose: Pose, voice: VoiceReading, time_s: float) -> None:
        """Choose the goal and the point for this iteration on the path to it."""
        position = (pose.x_m, pose.y_m)
        self._cover.look(position)
        if self._is_base:
            return
        self._avoided = [(place, until_s) for place, until_s in self._avoided if until_s > time_s]
        self._choose_goal(position, voice, time_s)
        velocity = self._velocity(position, time_s)
        if velocity == (0.0, 0.0):
            self._target = None
            return
        self._target = self._driver.map.grid.reachable_towards(position, next_position(position, velocity))
        self._speed_mps = max(0.1, self._control.speed_factor * math.hypot(*velocity) / self._control.iteration_s)

    def _choose_goal(self, position: Vector, voice: VoiceReading, time_s: float) -> None:
        loudest = voice.local_best_m if voice.heard else None
        self._ruled_out.add(position, loudest)
        is_avoided = loudest and any(math.dist(loudest, place) <= self._control.avoided_m for place, _ in self._avoided)
        if loudest and not is_avoided and not self._ruled_out.covers(loudest):
            if self._goal is None or math.dist(self._goal, loudest) > self._control.avoided_m:
                self._goal_m, self._goal_since_s = math.inf, time_s
            self._goal = loudest
        elif self._goal is not None and (
            self._cover.is_covered(self._goal)
            or self._driver.hot.is_hot(self._goal)
            or self._is_taken(self._goal, position)
        ):
            self._goal = None
        if self._goal is not None:
            length_m = self._route.first_stretch(self._driver.map, position, self._goal)[1]
            if length_m < self._goal_m - self._control.progress_m:
                self._goal_m, self._goal_since_s = length_m, time_s
            elif time_s - self._goal_since_s > self._control.goal_timeout_s:
                self._avoided.append((self._goal, time_s + self._control.avoided_s))
                self._goal = None
        if self._goal is None:
            self._goal = self._best_place(position)
            self._goal_m, self._goal_since_s = math.inf, time_s

    def _is_taken(self, place: Vector, position: Vector) -> bool:
        """Whether a teammate that is nearer, or as near with a lower id, goes there."""
        own = (math.dist(place, position), self._robot_id)
        return any(
            update.goal is not None
            and math.dist(place, update.goal) < self._control.apart_m
            and (math.dist(place, update.position), robot_id) < own
            for robot_id, (_, update) in self._team.items()
        )

    def _best_place(self, position: Vector) -> Vector | None:
        """Return the place that covers the most new floor for its distance; None if none is left."""
        left_out = [(place, self._control.avoided_m) for place, _ in self._avoided]
        left_out += [(update.goal, self._control.apart_m) for _, update in self._team.values() if update.goal]
        in_reach = self._links.in_reach([update.position for _, update in self._team.values()], CELL_M)
        hot = self._driver.hot.known
        if in_reach is not None:
            place = self._cover.best_place(position, left_out, self._control.nearness_m, in_reach, hot)
            if place:
                return place
        # No uncovered place has a good enough link: extend the team towards one.
        return self._cover.best_place(position, left_out, self._control.nearness_m, hot=hot)

    def _velocity(self, position: Vector, time_s: float) -> Vector:
        """Return v[t+1] of eq. (22) [m per iteration]: a full step towards the local best, and the weighted x_CB."""
        step_m = self._control.max_step_speed_mps * self._control.iteration_s
        v_x, v_y = self._way_to(self._route, self._goal, position, step_m) if self._goal else (0.0, 0.0)
        heard, missing = self._heard_and_missing(time_s)
        x_cb, weight = self._links.pull(position, heard, missing)
        if weight > 0.0:
            c_x, c_y = self._way_to(_Route(self._control.longest_path_m), x_cb, position, self._control.longest_path_m)
            v_x, v_y = v_x + weight * c_x, v_y + weight * c_y
        return limit_speed((v_x, v_y), step_m)

    def _heard_and_missing(self, time_s: float) -> tuple[dict[int, Vector], dict[int, Vector]]:
        """Return the positions of connected teammates, and of those heard less recently, by robot id."""
        ages_s = sorted((robot_id, time_s - heard_s) for robot_id, (heard_s, _) in self._team.items())
        connected_s, given_up_s = self._control.connected_s, self._control.given_up_s
        return (
            {i: self._teammates[i] for i, age_s in ages_s if age_s <= connected_s},
            {i: self._teammates[i] for i, age_s in ages_s if connected_s < age_s <= given_up_s},
        )

    def _way_to(self, route: _Route, place: Vector, position: Vector, longest_m: float) -> Vector:
        """Return the vector in the direction of the path to a place, with its length, or `longest_m` if shorter."""
        (x, y), length_m = route.first_stretch(self._driver.map, position, place)
        stretch_m = math.dist(position, (x, y))
        if stretch_m == 0.0:
            return 0.0, 0.0
        stretch = min(length_m, longest_m) / stretch_m
        return stretch * (x - position[0]), stretch * (y - position[1])


class _Route:
    """The corners of a path, reused while its end stays the same and the robot follows it."""

    def __init__(self, longest_m: float) -> None:
        """Args: longest_m: limit of the path search."""
        self._longest_m = longest_m
        self._place: Vector | None = None
        self._corners: list[Vector] = []

    def first_stretch(self, known: KnownMap, position: Vector, place: Vector) -> tuple[Vector, float]:
        """Return the first corner ahead on the path to a place, in `map` [m], and the length of the whole path [m]."""
        is_lost = self._place != place or not known.grid.is_line_free(position, self._corners[0])
        if is_lost:
            self._place, self._corners = place, [place]
            start, end = known.grid.nearest_free(position, 1.0), known.grid.nearest_free(place, 1.0)
            if start is not None and end is not None and not known.grid.is_line_free(start, end):
                self._corners = [*known.grid.waypoints(start, end, self._longest_m)[1:-1], place]
        while len(self._corners) > 1 and known.grid.is_line_free(position, self._corners[1]):
            del self._corners[0]
        return self._corners[0], path_length_m([position, *self._corners])

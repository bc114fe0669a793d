"""RDPSO as one robot runs it [dissertation, 5.2.2 and 5.3]."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from operator import attrgetter
from typing import Final, NamedTuple

import numpy as np

from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.driving.localisation import Localiser, body_of
from robotteamsim.control.driving.navigation import Navigator
from robotteamsim.control.driving.wander import Wander
from robotteamsim.control.rdpso.common_view import CommonView, common_view
from robotteamsim.control.rdpso.communication import LinkKeeper
from robotteamsim.control.rdpso.door_beliefs import DoorBeliefs
from robotteamsim.control.rdpso.local_best import LocalBestFinder
from robotteamsim.control.rdpso.membership import Membership
from robotteamsim.control.rdpso.obstacles import Surroundings
from robotteamsim.control.rdpso.ruled_out import RuledOut
from robotteamsim.control.rdpso.update import Best, RdpsoUpdate, is_voice, parse_update, updates_in
from robotteamsim.control.rdpso.velocity_memory import Momentum
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.geometry import Pose
from robotteamsim.interface import OUTSIDE, Decision, Observation, Task
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Control
from robotteamsim.swarm import (
    Vector,
    Weights,
    limit_speed,
    memory_coefficients,
    next_position,
    next_velocity,
    uniform_numbers,
)

LONGEST_DETOUR_M = 60.0
"""Best places farther than this along the path draw as the crow flies."""

SEARCHED_FOR_S = 30.0
"""A member that was not heard for longer no longer draws the robot to where it was."""

PATIENCE = 0.5
"""So much of an iteration a robot waits for the reports of those that it heard in the last one."""

HURRY = 1.25
"""A robot drives this much faster than its swarm velocity, so that it is there when the next iteration begins."""

_ITERATION, _SWARM_ID = attrgetter("iteration"), attrgetter("swarm_id")
_RANGES_M: Final = 3
"""Places in the tuples `Decision` and `RobotReading`: asked for by its name, a field takes three times as long."""


class _Settings(NamedTuple):
    """What a robot asks of its scenario in every iteration: read there, each takes several times as long."""

    iteration_s: float
    max_step_speed_mps: float
    step_m: float
    patience_ns: int
    by_path: bool
    weights: Weights
    """With a weight of 0 for the link."""
    iteration_ns: int
    plan: FloorPlan
    reach_m: float

    @classmethod
    def of(cls, scenario: Scenario, reach_m: float) -> _Settings:
        """Return what a scenario says for a robot whose body reaches so far."""
        control = scenario.control
        return cls(
            iteration_s=control.iteration_s,
            max_step_speed_mps=control.max_step_speed_mps,
            step_m=control.max_step_speed_mps * control.iteration_s,
            patience_ns=round(PATIENCE * control.iteration_s * 1e9),
            by_path=control.navigation == "path",
            weights=Weights(control.c1, control.c2, control.c3, 0.0),
            iteration_ns=round(control.iteration_s * 1e9),
            plan=scenario.plan,
            reach_m=reach_m,
        )


class RdpsoController:
    """One robot of the swarm.

    Every iteration has two phases. In its first step the robot evaluates its surroundings and reports to everybody.
    As soon as those that it heard in the last iteration have reported too (in the step after, unless messages are late
    or a teammate is out of reach), it takes the reports that arrived, finds the global best, and chooses its next
    point. All other steps drive there. Robots that heard the same reports come to the same view of the swarm.
    """

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        control = scenario.control
        body = body_of(robot_id, scenario)
        self._robot_id = robot_id
        self._settings = _Settings.of(scenario, body.reach_m)
        self._localiser = Localiser(robot_id, scenario)
        self._doors = DoorBeliefs(scenario.plan, body.laser)
        self._map = known_map(scenario.plan, body.reach_m)
        self._map_doors = self._doors.changed
        self._navigator = Navigator(body, robot_id, control.navigation)
        self._surroundings = Surroundings(body.laser, control.sensing_radius_m)
        self._links = LinkKeeper(scenario)
        self._ruled_out = RuledOut(scenario)
        self._finder = LocalBestFinder(scenario)
        self._membership = Membership(robot_id, scenario)
        self._momentum = Momentum(self.memory(control))
        self._numbers = uniform_numbers(robot_stream(scenario, "rdpso", robot_id, arrival))
        self._wander = Wander(
            control.wander, robot_stream(scenario, "wander", robot_id, arrival), control.max_step_speed_mps
        )

        # Python keeps up to 29 attributes in the object itself; of one with more, it looks each up in a dictionary.
        self._observation: Observation | None = None
        self._task = Task()
        self._team: dict[int, RdpsoUpdate] = {}
        """The last report of every teammate heard so far."""
        self._teammates = partial(_positions, self._team)
        """Tells where each teammate was when it was last heard."""
        self._iteration = -1
        self._iteration_ends_ns = 0
        self._epoch = -1
        self._own: RdpsoUpdate | None = None
        """The report of this iteration, until the next point is chosen."""
        self._reported_ns = 0
        self._known_best: Best | None = None
        self._local_best: Best | None = None
        self._goal: Vector | None = None
        self._speed_mps = control.max_step_speed_mps
        self._told = Decision()
        """The decision to stand, with what others are told of the robot."""
        self._told = self._what_is_told()

    @staticmethod
    def memory(control: Control) -> tuple[float, ...]:
        """Return the weights of v[t], v[t-1], ... in v[t+1]."""
        return memory_coefficients(control.memory, control.alpha, control.memory_terms)

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Take in what the robot perceives, the messages that arrived, and the mission's task."""
        self._observation, self._task = observation, task
        if inbox:
            team = self._team
            for report in updates_in(inbox):
                team[report.robot_id] = report
            team.pop(self._robot_id, None)

    def decide(self) -> Decision:
        """Return command and messages for this step."""
        if self._observation is None or not self._task.running:
            return self._told
        _, sim_time_ns, robot, _ = self._observation
        pose, ranges_m = self._localiser.map_T_base_link(robot), robot[_RANGES_M]
        outbox: tuple[Message, ...] = ()
        if self._own is not None and self._has_waited_enough(sim_time_ns):
            self._choose_next_point(pose, ranges_m, self._own)
            self._own = None
            self._told = self._what_is_told()
        if not self._reported_ns <= sim_time_ns < self._iteration_ends_ns:
            self._begin_iteration(sim_time_ns)
            payload = self._evaluate(pose, ranges_m).to_json()
            # As its teammates read it, so that all of one process share what follows from it.
            self._own = parse_update(payload)
            outbox = (Message(self._robot_id, EVERYBODY, payload),)
            self._told = self._what_is_told()
        # Drive: towards the next point, or wherever a wandering robot goes.
        goal, speed_mps = self._goal, self._speed_mps
        if goal is None:
            goal = self._wander.goal(self._map, pose[:2], sim_time_ns * 1e-9)
            speed_mps = self._settings.max_step_speed_mps
        twist = self._navigator.drive(self._map.grid, pose, ranges_m, goal, speed_mps, sim_time_ns, self._teammates)
        return self._told._replace(twist=twist, outbox=outbox, goal_m=goal)

    def _begin_iteration(self, sim_time_ns: int) -> None:
        """Take note of the iteration that this step is the first of."""
        iteration_ns = self._settings.iteration_ns
        self._iteration, self._reported_ns = sim_time_ns // iteration_ns, sim_time_ns
        self._iteration_ends_ns = (self._iteration + 1) * iteration_ns

    def _has_waited_enough(self, sim_time_ns: int) -> bool:
        """Whether all that reported in the last iteration have reported in this one, or patience is at its end."""
        if sim_time_ns - self._reported_ns >= self._settings.patience_ns:
            return True
        return self._iteration - 1 not in map(_ITERATION, self._team.values())

    def _evaluate(self, pose: Pose, ranges_m: np.ndarray) -> RdpsoUpdate:
        """Phase 1: return the report on what the robot knows at the start of an iteration."""
        assert self._observation is not None
        position = pose[:2]
        self._doors.look(pose, ranges_m, self._iteration)
        self._update_map()
        if self._task.epoch != self._epoch:
            self._epoch, self._known_best = self._task.epoch, None
            self._ruled_out.clear()
        voice = self._observation.voice
        loudest = voice.local_best_m if voice.heard else None
        self._ruled_out.add(position, loudest)
        area = self._task.area_center_m
        self._local_best = self._finder.find(self._map, self._ruled_out, voice, area, position)
        return RdpsoUpdate(
            self._robot_id,
            self._iteration,
            self._epoch,
            position,
            loudest,
            self._local_best,
            self._known_best,
            self._membership.swarm_id,
            self._membership.state,
            self._doors.sightings,
        )

    def _choose_next_point(self, pose: Pose, ranges_m: np.ndarray, own: RdpsoUpdate) -> None:
        """Phase 2: share the bests, judge the swarm, and set the goal to x[t+1]."""
        position = pose[:2]
        iteration = self._iteration
        reports = [own]
        for report in self._team.values():
            if report.iteration == iteration:
                reports.append(report)
        view = common_view(tuple(sorted(reports)))  # by robot ids, which come first
        bests, improved = self._share_bests(own, view)
        in_use = set(view.values)
        if len(reports) <= len(self._team):
            in_use.update(map(_SWARM_ID, self._team.values()))
        self._membership.judge(iteration, view, improved, in_use)
        # A new swarm begins with what the excluded know.
        self._known_best = bests.get(self._membership.swarm_id, bests.get(OUTSIDE))
        self._doors.hear(view.doors)
        self._update_map()
        if self._membership.excluded or self._known_best is None or self._local_best is None:
            self._goal = None
            self._momentum.forget()
            return
        self._wander.stop()
        self._momentum.note(position)
        velocity = limit_speed(self._next_velocity(position, pose, ranges_m, view), self._settings.step_m)
        self._goal = next_position(position, velocity)
        if self._settings.by_path:
            # A step ends at a wall; it does not lead around it. The way around is in the attractors.
            self._goal = self._map.reachable_towards(position, self._goal)
        v_x, v_y = velocity
        self._speed_mps = max(0.1, HURRY * math.hypot(v_x, v_y) / self._settings.iteration_s)

    def _share_bests(self, own: RdpsoUpdate, view: CommonView) -> tuple[dict[int, Best | None], list[int]]:
        """Return by swarm what its members share as global best, and the swarms that improved theirs now."""
        heard, bests_of = view.comparable(own)
        self._ruled_out.add_all(heard)
        bests, improved = {}, []
        for swarm_id, (known, local) in bests_of.items():
            before, found = self._highest(known), self._highest(local)
            if found is not None and (before is None or found.value > before.value):
                improved.append(swarm_id)
                before = found
            bests[swarm_id] = before
        return bests, improved

    def _highest(self, bests: Sequence[Best]) -> Best | None:
        """Return the first of bests, the highest first, that is not ruled out; none where there is none."""
        for best in bests:
            value, position = best
            if not (is_voice(value) and self._ruled_out.covers(position)):
                return best
        return None

    def _next_velocity(self, position: Vector, pose: Pose, ranges_m: np.ndarray, view: CommonView) -> Vector:
        """Return v[t+1] of eq. (25), before the speed limit."""
        assert self._observation
        assert self._local_best
        assert self._known_best
        clear_place = self._surroundings.attractor(pose, ranges_m)
        settings, swarm_id = self._settings, self._membership.swarm_id
        heard = dict(view.positions.get(swarm_id, ()))
        heard.pop(self._robot_id, None)
        missing = {}
        if len(view.reports) <= len(self._team):
            oldest = self._iteration - round(SEARCHED_FOR_S / settings.iteration_s)
            missing = {
                i: report.position
                for i, report in self._team.items()
                if oldest <= report.iteration != view.iteration and report.swarm_id == swarm_id
            }
        x_cb, c4 = self._links.pull(position, heard, missing)
        (local_value, local_best), (known_value, known_best) = self._local_best, self._known_best
        if is_voice(known_value) and not is_voice(local_value) and self._observation.voice.heard:
            # All that this robot hears is ruled out: while the swarm follows a voice, the area must not hold it back.
            local_best = position
        # As in `Attractors` and `Weights`, which take longer to make.
        x_lb, x_gb = self._along_path(position, local_best), self._along_path(position, known_best)
        x_ob = position if clear_place is None else clear_place
        weights: tuple[float, float, float, float] = settings.weights
        if c4 != 0.0:
            x_cb, weights = self._along_path(position, x_cb), settings.weights._replace(communication=c4)
        return next_velocity(position, self._momentum.term(), (x_lb, x_gb, x_ob, x_cb), weights, self._numbers)

    def _along_path(self, position: Vector, place: Vector) -> Vector:
        """Return a place as the path to it begins: at the path's length, in the direction of its first stretch."""
        if not self._settings.by_path:
            return place
        return self._map.along_path(position, place, LONGEST_DETOUR_M)

    def _update_map(self) -> None:
        """Take the map with the doors as believed now; bests along other paths are forgotten."""
        if self._doors.changed != self._map_doors:
            self._map_doors = self._doors.changed
            self._map = known_map(self._settings.plan, self._settings.reach_m, self._map_doors)
            self._known_best = None

    def _what_is_told(self) -> Decision:
        """Return the decision to stand, with what others are told: exclusion, the local best's value, SC and swarm."""
        swarm_id, (search_counter, _) = self._membership.swarm_id, self._membership.state
        value, _ = self._local_best or (0.0, None)
        return self._told._replace(
            excluded=swarm_id == OUTSIDE, local_best=value, search_counter=search_counter, swarm=swarm_id
        )


def _positions(team: Mapping[int, RdpsoUpdate]) -> dict[int, Vector]:
    return {robot_id: report.position for robot_id, report in team.items()}

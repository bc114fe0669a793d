"""RDPSO as one robot runs it [dissertation, 5.2.2 and 5.3]."""

import math
from collections.abc import Mapping, Sequence
from functools import partial

import msgspec

from robotteamsim import swarm
from robotteamsim.control.driving.driver import Driver, DrivesOn
from robotteamsim.control.driving.places import OtherPlaces
from robotteamsim.control.driving.wander import Wander
from robotteamsim.control.rdpso.context import ContextMeter
from robotteamsim.control.rdpso.door_beliefs import DoorBeliefs
from robotteamsim.control.rdpso.membership import Membership
from robotteamsim.control.rdpso.team import Best, CommonView, RdpsoUpdate, TeamMemory
from robotteamsim.control.rdpso.terms import Approach, LinkKeeper, LocalBestFinder, Momentum, RuledOut, Surroundings
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.geometry import Pose
from robotteamsim.interface import OUTSIDE, Decision, Observation, SwarmContext, Task
from robotteamsim.network.messages import EVERYBODY, Message, batch_of
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.fire import BLOCK_M
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


class RdpsoController(DrivesOn):
    """One robot of the swarm.

    Every iteration has two phases. In its first step the robot evaluates its surroundings and broadcasts an update.
    When the robots that it heard in the last iteration have sent theirs (one step later, unless messages are late or a
    teammate is out of range), it reads the updates, finds the global best, and chooses its next point. In all other
    steps it drives there. Robots that heard the same updates have the same view of the swarm.
    """

    membership: type[Membership] = Membership
    """The rules by which robots leave, join and found swarms."""

    def __init__(
        self, robot_id: int, setup: Setup, arrival: int = 1, *, memory: tuple[float, ...] | None = None
    ) -> None:
        """Args: memory: the weights of v[t], v[t-1], ... in v[t+1]; None: those of the fractional memory."""
        scenario, body = setup.scenario, setup.robots[robot_id]
        control = scenario.control.as_kind(RdpsoControl)
        self._robot_id = robot_id
        self._control = control
        self._weights = swarm.Weights(control.c1, control.c2, control.c3, 0.0)
        """Weights of the terms of eq. (22); that of communication is 0 while no link is endangered."""
        self._iteration_ns = round(control.iteration_s * 1e9)
        self._timeout_ns = round(control.update_timeout_share * control.iteration_s * 1e9)
        self._driver = Driver(robot_id, setup)
        self._doors = DoorBeliefs(scenario.plan, body.laser, control.doors)
        self._surroundings = Surroundings(body.laser, control.sensing_radius_m)
        self._links = LinkKeeper(robot_id, setup)
        self._meter = None
        """Measures the context; None without adaptation."""
        if control.adaptation != "none":
            self._meter = ContextMeter(control, control.adaptation, self._links)
        self._ruled_out = RuledOut(scenario, control.rule_out_places)
        self._finder = LocalBestFinder(scenario)
        self._approach = Approach()
        self._membership = self.membership(robot_id, scenario)
        fractional = swarm.memory_coefficients(control.memory, control.alpha, control.memory_terms)
        self._momentum = Momentum(fractional if memory is None else memory, control.memory_of)
        self._rng = robot_stream(scenario, "rdpso", robot_id, arrival)
        self._wander = Wander(
            control.wander, robot_stream(scenario, "wander", robot_id, arrival), control.max_step_speed_mps
        )

        self._team = TeamMemory()
        self._iteration = -1
        self._iteration_ends_ns = 0
        self._epoch = -1
        self._own: RdpsoUpdate | None = None
        """The update of this iteration; None once the next point is chosen."""
        self._sent_ns = 0
        self._known_best: Best | None = None
        self._local_best: Best | None = None
        self._area: Vector | None = None
        """The centre of the area of the task, in `map` [m]."""
        self._goal: Vector | None = None
        self._context: SwarmContext | None = None
        self._speed_mps = control.max_step_speed_mps
        self._standing = self._decide_to_stand()
        """The decision to stand still."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and, once per iteration, the message of this step."""
        self.course = None
        self._driver.hot.look(observation.robot)
        if inbox:
            self._team = self._team.after(batch_of(inbox))
        if not task.running:
            return self._standing
        sim_time_ns = observation.sim_time_ns
        pose = observation.pose
        outbox: tuple[Message, ...] = ()
        if self._own is not None and self._has_waited_enough(sim_time_ns):
            self._choose_next_point(pose, observation, self._own)
            self._own = None
            self._standing = self._decide_to_stand()
        if not self._sent_ns <= sim_time_ns < self._iteration_ends_ns:
            self._iteration, self._sent_ns = sim_time_ns // self._iteration_ns, sim_time_ns
            self._iteration_ends_ns = (self._iteration + 1) * self._iteration_ns
            self._own = self._evaluate(pose, observation, task)
            outbox = (Message(self._robot_id, EVERYBODY, self._own.to_json()),)
            self._standing = self._decide_to_stand()
        # Drive: towards the next point, or along the legs of a wandering robot.
        goal, speed_mps = self._goal, self._speed_mps
        if goal is None:
            goal = self._wander.goal(self._driver.map, (pose.x_m, pose.y_m), sim_time_ns * 1e-9)
            speed_mps = self._control.max_step_speed_mps
        teammates = partial(_teammates, self._team, self._robot_id)
        way_out = self._driver.way_out((pose.x_m, pose.y_m))
        if way_out is not None:
            goal, speed_mps = way_out, self._control.max_step_speed_mps
        elif self._goal is not None and self._own is None and not self._has_own_step():
            self.course = self._driver.course(goal, speed_mps, teammates, self._iteration_ends_ns)
        twist = self._driver.drive(observation, pose, goal, speed_mps, teammates)
        return msgspec.structs.replace(self._standing, twist=twist, outbox=outbox, goal_m=goal)

    def _has_own_step(self) -> bool:
        """Whether somebody has put another method in place of `step`, which must be called each time."""
        return type(self).step is not RdpsoController.step or "step" in vars(self)

    def _has_waited_enough(self, sim_time_ns: int) -> bool:
        """Whether all senders of the last iteration have sent an update in this one, or the timeout has expired."""
        if sim_time_ns - self._sent_ns >= self._timeout_ns:
            return True
        return not self._team.has_others_of(self._iteration - 1, self._robot_id)

    def _evaluate(self, pose: Pose, observation: Observation, task: Task) -> RdpsoUpdate:
        """Phase 1: return the update with the robot's knowledge at the start of an iteration."""
        position, voice = (pose.x_m, pose.y_m), observation.voice
        self._doors.look(pose, observation.robot.ranges_m, self._iteration)
        self._update_map(observation.sim_time_ns)
        if task.epoch != self._epoch:
            self._epoch = task.epoch
            self._discard_bests()
            self._ruled_out.clear()
        self._area = task.area_center_m
        loudest = voice.local_best_m if voice.heard else None
        self._ruled_out.add(position, loudest)
        self._local_best = self._finder.find(self._driver.map, self._is_vain, voice, task.area_center_m, position)
        return RdpsoUpdate(
            robot_id=self._robot_id,
            iteration=self._iteration,
            epoch=self._epoch,
            position=position,
            loudest=loudest,
            local_best=self._local_best,
            known_best=self._known_best,
            swarm_id=self._membership.swarm_id,
            swarm=self._membership.state,
            doors=self._doors.sightings,
            hot=self._driver.hot.in_sight or msgspec.UNSET,
            closed_area=self._driver.closed_area(task, position) or msgspec.UNSET,
            nearer=(self._approach.nearer and not self._control.exclusion.while_approaching) or msgspec.UNSET,
        )

    def _choose_next_point(self, pose: Pose, observation: Observation, own: RdpsoUpdate) -> None:
        """Phase 2: share the bests, judge the swarm, and set the goal to x[t+1]."""
        position = (pose.x_m, pose.y_m)
        team = self._team.with_update(own)
        view = team.view(own.iteration)
        bests, improved = self._share_bests(own, view)
        # Swarms that were not heard in this iteration may still exist.
        self._membership.judge(own.iteration, view, improved, team.swarm_ids)
        # A new swarm starts with the best of the excluded robots.
        global_best = self._known_best = bests.get(self._membership.swarm_id, bests.get(OUTSIDE))
        self._doors.hear(view.doors)
        self._driver.hot.hear(view.hot)
        # A best that is discarded here still leads in this iteration: without it, the robot would lose its momentum.
        self._update_map(observation.sim_time_ns)
        if self._membership.excluded or global_best is None or self._local_best is None:
            self._goal = self._context = None
            self._momentum.forget()
            self._approach.forget()
            return
        self._wander.stop()
        self._momentum.note(position)
        velocity = self._next_velocity(pose, observation, team, view, self._local_best, global_best)
        velocity = swarm.limit_speed(velocity, self._control.max_step_speed_mps * self._control.iteration_s)
        self._momentum.note_command(velocity)
        self._goal = swarm.next_position(position, velocity)
        if self._control.navigation == "path":
            # A step ends at a wall. The paths around walls are in the attractors.
            self._goal = self._driver.map.grid.reachable_towards(position, self._goal)
        self._speed_mps = max(0.1, self._control.speed_factor * math.hypot(*velocity) / self._control.iteration_s)

    def _share_bests(self, own: RdpsoUpdate, view: CommonView) -> tuple[dict[int, Best | None], list[int]]:
        """Return the global best of each swarm, and the swarms that improved theirs in this iteration."""
        comparable = view.comparable(own)
        self._ruled_out.add_all(comparable.heard)
        global_bests, improved = {}, []
        for swarm_id, bests in comparable.bests.items():
            best, found = self._highest(bests.known), self._highest(bests.local)
            if found is not None and (best is None or found.value > best.value):
                improved.append(swarm_id)
                best = found
            global_bests[swarm_id] = best
        return global_bests, improved

    def _highest(self, bests: Sequence[Best]) -> Best | None:
        """Return the first of the sorted bests that is not in vain; None if there is none."""
        for best in bests:
            if not (self._is_vain(best.position) if best.is_voice else self._is_outdated(best)):
                return best
        return None

    def _is_outdated(self, best: Best) -> bool:
        """Whether heat has made the path from a place to the area longer by more than a block since it was valued.

        Maps change at different times, so that an outdated best would come back from teammates again and again.
        """
        if self._area is None or not self._driver.hot.blocked or self._control.navigation != "path":
            return False
        return self._driver.map.distance_m(self._area, best.position) > BLOCK_M - best.value

    def _is_vain(self, place: Vector) -> bool:
        """Whether no victim can be where a voice is heard, or the robot cannot go there, because it is hot."""
        return self._ruled_out.covers(place) or self._driver.hot.is_hot(place)

    def _next_velocity(
        self,
        pose: Pose,
        observation: Observation,
        team: TeamMemory,
        view: CommonView,
        local_best: Best,
        global_best: Best,
    ) -> Vector:
        """Return v[t+1] of eq. (25), before the speed limit."""
        position, ranges_m = (pose.x_m, pose.y_m), observation.robot.ranges_m
        obstacle = self._surroundings.clearest_place(pose, ranges_m)
        heard, missing = view.others(self._membership.swarm_id, self._robot_id), self._missing(team, view)
        weights, c4 = self._weights, self._control.c4
        if self._meter is not None:
            places = {**heard, self._robot_id: position}
            clearance_m = self._surroundings.clearance_m(ranges_m)
            found = self._meter.measure(
                view.iteration, self._robot_id, places, not missing, global_best.position, clearance_m
            )
            weights, c4 = self._adapt(found), found.c4
        x_cb, c4 = self._links.pull(position, heard, missing, c4)
        x_lb = local_best.position
        if global_best.is_voice and not local_best.is_voice and observation.voice.heard:
            # Everything that this robot hears is ruled out. While the swarm follows a voice, ignore the area.
            x_lb = position
        x_gb = self._along_path(position, global_best.position)
        self._approach.note(global_best.position, math.dist(position, x_gb))
        attractors = (
            self._along_path(position, x_lb),
            x_gb,
            position if obstacle is None else obstacle,
            self._along_path(position, x_cb) if c4 > 0.0 else x_cb,
        )
        if c4 != 0.0:
            weights = weights._replace(communication=c4)
        return swarm.next_velocity(position, self._momentum.term(), attractors, weights, self._rng.random(4).tolist())

    def _adapt(self, context: SwarmContext) -> swarm.Weights:
        """Adopt the coefficients of a context; return c1 to c3."""
        control, self._context = self._control, context
        self._momentum.coefficients = swarm.memory_coefficients(control.memory, context.alpha, control.memory_terms)
        return swarm.Weights(context.c1, context.c2, context.c3, 0.0)

    def _missing(self, team: TeamMemory, view: CommonView) -> Mapping[int, Vector]:
        """Return the last positions of members that sent no update now but did recently, by robot id."""
        if len(view.updates) == len(team.updates):
            return {}
        swarm_id = self._membership.swarm_id
        oldest = view.iteration - round(self._control.member_timeout_s / self._control.iteration_s)
        return {
            update.robot_id: update.position
            for update in team.updates
            if oldest <= update.iteration != view.iteration and update.swarm_id == swarm_id
        }

    def _along_path(self, position: Vector, place: Vector) -> Vector:
        """Return the point in the direction of the first segment of the path to a place, at the path's length."""
        if self._control.navigation != "path":
            return place
        return self._driver.map.grid.along_path(position, place, self._control.longest_detour_m)

    def _update_map(self, sim_time_ns: int) -> None:
        """Use the map with doors and hot places as believed now, and discard bests, whose paths may have changed."""
        if self._driver.update_map(sim_time_ns, self._doors.changed):
            self._discard_bests()

    def _discard_bests(self) -> None:
        self._known_best = None
        self._approach.forget()

    def _decide_to_stand(self) -> Decision:
        """Return the decision to stand still, with the status of the robot and its swarm."""
        membership = self._membership
        return Decision(
            excluded=membership.excluded,
            local_best=self._local_best.value if self._local_best else 0.0,
            local_best_m=self._local_best.position if self._local_best else None,
            search_counter=membership.state.search_counter,
            swarm=membership.swarm_id,
            context=self._context,
        )


def _teammates(team: TeamMemory, robot_id: int) -> OtherPlaces:
    """Return the last known positions of the other robots. It knows no controller, which may keep it in its course."""
    return OtherPlaces(team.places, robot_id)

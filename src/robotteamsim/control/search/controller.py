"""One robot of a team that searches: it listens where victims are expected, saves whom it hears, explores areas."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from robotteamsim.control.driving.driver import Driver
from robotteamsim.control.rdpso.door_beliefs import DoorBeliefs
from robotteamsim.control.search.areas import Areas
from robotteamsim.control.search.cells import NO_CELL, cell_grid
from robotteamsim.control.search.hunt import Hunt, Hunted
from robotteamsim.control.search.knowledge import Knowledge
from robotteamsim.control.search.team import SearchUpdate, Teammates, update_of
from robotteamsim.control.search.work import Paths, WorkChoice
from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_SHOWN_S = 5.0
"""Period with which a robot publishes its belief for display [s]."""


class SearchController:
    """Bayesian search, see `docs/search.md`.

    In each iteration the robot listens, updates its belief, chooses its work, and sends an update of what it knows and
    plans. It uses its map, its readings, the messages of its teammates and the mission's order of areas.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        scenario = setup.scenario
        self._tuning = control = scenario.control.as_kind(SearchControl)
        self._robot_id, self._areas = robot_id, scenario.mission.areas
        self._iteration_ns = round(control.iteration_s * 1e9)
        self._reached_within_m = scenario.mission.save_distance_m + scenario.voice.map_resolution_m
        self._driver = Driver(robot_id, setup)
        self._doors = DoorBeliefs(scenario.plan, setup.robots[robot_id].laser, control.doors)
        self._grid = cell_grid(scenario)
        areas = Areas(scenario, self._grid)
        paths = Paths(robot_id, setup, self._grid, areas)
        self.knowledge = Knowledge(setup, robot_id, self._grid, paths.start)
        """What the robot knows about victims."""
        self._hunt = Hunt(scenario, self._grid)
        self._team = Teammates(robot_id, control.given_up_s)
        self._choice = WorkChoice(robot_id, setup, self._grid, self._driver, self.knowledge, self._team, areas, paths)

        self._epoch, self._iteration, self._elapsed_ns = 0, -1, 0
        self._last_ns: int | None = None
        """The stamp of the last step in which the mission was running."""
        self._voice: Hunted | None = None
        self._num_found = 0
        """How many found victims the robot knew in the last iteration."""
        self._was_beside: VoiceReading | None = None
        """The voice of the last step, if its victim must have been next to the robot."""
        self._next_shown_s = 0.0
        self._standing = Decision()
        """The decision to stand still in this iteration."""

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the command and, once per iteration, the message of this step."""
        self._driver.hot.look(observation.robot)
        self._note(observation, inbox, task)
        return self._decide(observation, task) if task.running else Decision()

    def best_area(self, areas: Sequence[int], position: Vector) -> int:
        """Return the area where the robot expects most for its time. Args: areas: indices.  position: in `map` [m]."""
        return areas[self._choice.best_area([self._areas[index] for index in areas], position)]

    def _note(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        if task.epoch != self._epoch:
            self._epoch = task.epoch
            self._note_found(observation)
            self._choice.begin_epoch()
        self.knowledge.noise.note(observation.voice, task.epoch)
        self._was_beside = observation.voice if self._hunt.beside(observation.voice) is not None else None
        if task.running:
            if self._last_ns is not None:
                self._elapsed_ns += observation.sim_time_ns - self._last_ns
            self._last_ns = observation.sim_time_ns
        else:
            self._last_ns = None
        for message in inbox:
            self._hear(message, observation.sim_time_ns * 1e-9)

    def _decide(self, observation: Observation, task: Task) -> Decision:
        sim_time_ns, pose, choice = observation.sim_time_ns, observation.pose, self._choice
        outbox: tuple[Message, ...] = ()
        belief: FieldMap | None = None
        iteration = sim_time_ns // self._iteration_ns
        if iteration != self._iteration:
            self._iteration = iteration
            self._iterate(pose, observation, task)
            outbox = (Message(self._robot_id, EVERYBODY, self._update(pose).to_json()),)
            belief = self._shown_belief(sim_time_ns * 1e-9)
            self._standing = Decision(goal_m=choice.shown_goal, local_best=self.knowledge.remaining, done=choice.done)
        twist, speed_mps, target = Twist(), self._tuning.max_step_speed_mps, choice.target
        leave = self._driver.shelter if target is None else self._driver.way_out
        target = leave((pose.x_m, pose.y_m)) or target
        if target is not None:
            twist = self._driver.drive(observation, pose, target, speed_mps, lambda: self._team.positions)
        return msgspec.structs.replace(self._standing, twist=twist, outbox=outbox, belief=belief)

    def _shown_belief(self, time_s: float) -> FieldMap | None:
        """Return the belief for display, once per period."""
        if time_s < self._next_shown_s or not self.knowledge.places.num_open:
            return None
        self._next_shown_s = time_s + _SHOWN_S
        grid = self._grid
        # The prior is the same in all these cells.
        percent = (100.0 * self.knowledge.places.num_open * self.knowledge.mass()).reshape(grid.rows, grid.columns)
        return FieldMap(grid.origin_m, grid.cell_m, percent.astype(np.float32))

    def _hear(self, message: Message, time_s: float) -> None:
        update = update_of(message)
        if update is None or update.robot_id == self._robot_id:
            return
        cells = update.goal, update.at, NO_CELL if update.wanted is msgspec.UNSET else update.wanted
        if max(cells) >= self._grid.size or not self.knowledge.merge(update.listened, update.found):
            return
        self._team.hear(update, time_s)
        self._doors.hear(update.doors)
        self._driver.hot.hear(update.hot or ())
        # A robot that arrives later does not know how long the mission has been running.
        self._elapsed_ns = max(self._elapsed_ns, round(update.elapsed_s * 1e9))

    def _update(self, pose: Pose) -> SearchUpdate:
        return SearchUpdate(
            robot_id=self._robot_id,
            position=(pose.x_m, pose.y_m),
            at=self._choice.at,
            work=self._choice.work,
            goal=self._choice.goal,
            voice=self._choice.announced_voice,
            noise_db=self.knowledge.measured_noise_db,
            elapsed_s=self._elapsed_ns * 1e-9,
            found=tuple(self.knowledge.found),
            listened=self.knowledge.log.to_text(self._tuning.shared_places, self._tuning.repeated_places),
            doors=self._doors.sightings,
            hot=self._driver.hot.in_sight or msgspec.UNSET,
            closed_area=self._choice.closed_area_m or msgspec.UNSET,
            wanted=self._choice.wanted,
            held=self._choice.is_long_held or msgspec.UNSET,
        )

    def _iterate(self, pose: Pose, observation: Observation, task: Task) -> None:
        """Listen, and choose the work and the goal of this iteration."""
        position, time_s = (pose.x_m, pose.y_m), observation.sim_time_ns * 1e-9
        self._team.forget_lost(time_s)
        self._doors.look(pose, observation.robot.ranges_m, self._iteration)
        doors_changed = self._doors.changed != self._driver.doors
        map_changed = self._driver.update_map(observation.sim_time_ns, self._doors.changed)
        if doors_changed:
            self.knowledge.use_doors(self._doors.changed)
        self._choice.follow(task, position, map_changed=map_changed, doors_changed=doors_changed)
        knowledge, voice = self.knowledge, observation.voice
        of_team_db = [update.noise_db for update in self._team.updates if update.noise_db is not None]
        knowledge.agree_on_noise(of_team_db)
        for place in knowledge.found[self._num_found :]:
            self._hunt.note_found(place, self._tuning.same_voice_m)
        self._num_found = len(knowledge.found)
        mass = knowledge.mass() if voice.heard or self._hunt.is_on else knowledge.places.prior
        self._voice = self._hunt.follow(voice, task.epoch, position, knowledge.losses, mass, knowledge.places.prior)
        cell = self._choice.locate(position)
        if cell != NO_CELL:
            knowledge.listen(cell, voice)
        self._choice.choose(position, self._voice, time_s, self._elapsed_ns * 1e-9)

    def _note_found(self, observation: Observation) -> None:
        """Note a victim whom the robot has reached: a voice beside it that falls silent in a new epoch.

        Another voice may still be heard there, but not as loud.
        """
        was, self._was_beside = self._was_beside, None
        if was is None or observation.voice.local_best_level_db >= was.local_best_level_db:
            return
        pose = observation.pose
        if math.dist((pose.x_m, pose.y_m), was.local_best_m) <= self._reached_within_m:
            self.knowledge.add_found(was.local_best_m)

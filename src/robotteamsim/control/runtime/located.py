"""Gives a controller what its robot believes of its place and of the building, in place of the truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import msgspec

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.interface import EVERYBODY, Controller, Decision, Message, Observation, Task
from robotteamsim.interface.survey_news import SurveyNews, survey_news, survey_news_in
from robotteamsim.maps.found_map import FoundMap
from robotteamsim.maps.localiser import Localiser
from robotteamsim.maps.survey import Survey
from robotteamsim.maps.teammates import Teammates
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.setup import Setup

_SHOWN_NS = 5_000_000_000
"""Least time between two maps for display."""

_CLOUD_NS = 1_000_000_000
"""Least time between two clouds of particles for display."""


class Located:
    """Runs a robot's controller, which learns of no other pose than that of the robot's localiser.

    Once per `control.iteration_s`, the robot tells its team where it is and, with a survey, what it has found; such
    messages do not reach the controller. Its decisions say what the robot believes.

    With unknown starts, the map of a robot has a frame of its own until it finds its place in that of its team. Until
    then the controller knows no areas, and its messages, which speak of places, are neither sent nor received; then a
    new controller begins.
    """

    def __init__(
        self,
        make: Callable[[Setup], Controller],
        robot_id: int,
        setup: Setup,
        localiser: Localiser,
        survey: Survey | None = None,
    ) -> None:
        """Args: make: makes the controller of a robot that knows of the mission what the setup says."""
        self._make, self._setup = make, setup
        self._robot_id, self._localiser, self._survey = robot_id, localiser, survey
        self._is_placed = survey is None or survey.is_placed
        self._had_to_be_placed = not self._is_placed
        self.controller = make(self._setup_of_controller())
        self._teammates = Teammates(robot_id, setup)
        self._shares = localiser.looks or survey is not None
        self._period_ns = round(setup.scenario.control.iteration_s * 1e9)
        self._due_ns = self._shown_ns = 0
        self._shown_version = 0
        """Of the map that was shown last."""
        self._cloud: tuple[Pose, ...] = ()
        """The particles that were shown last."""
        self._cloud_due_ns = 0

    @property
    def found(self) -> FoundMap | None:
        """What the robot and its team have found; None if it knows the building, or not yet where it is."""
        return self._survey.found if self._survey is not None and self._is_placed else None

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision, with the news that are due."""
        return self.decide(*self.perceive(observation, inbox, task), task)

    def perceive(
        self, observation: Observation, inbox: Sequence[Message], task: Task
    ) -> tuple[Observation, Sequence[Message]]:
        """Localise and map, and return the controller's observation and inbox: the first half of a step."""
        time_ns = observation.sim_time_ns
        if self._shares:
            inbox = self._read(inbox, time_ns)
        pose = self._localiser.pose(observation, self._teammates.discs(time_ns) if self._shares else ())
        if not self._is_placed:
            inbox = ()
            if self._survey is not None and self._survey.is_placed:
                self._is_placed = True
                self.controller = self._make(self._setup_of_controller())
        if self._survey is not None and self._is_due(time_ns, task):
            self._survey.look()
        return _believed(observation, pose), inbox

    def decide(self, believed: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the controller's decision, with the news that are due: the second half of a step.

        Args: believed, inbox: from `perceive`.
        """
        time_ns, pose = believed.sim_time_ns, believed.pose
        is_due = self._is_due(time_ns, task)
        known = task if self._is_placed else Task(task.running, task.epoch)
        decision = self.controller.step(believed, inbox, known)
        if not isinstance(decision, Decision):
            return decision  # The guard reports it, and a wrong outbox.
        if not self._is_placed:  # It may still meet somebody.
            decision = msgspec.structs.replace(decision, outbox=(), done="")
        outbox = decision.outbox
        if is_due and isinstance(outbox, (tuple, list)):
            self._due_ns = time_ns + self._period_ns
            is_sure = self._localiser.localisation.state == "tracking"
            position = (round(pose.x_m, 3), round(pose.y_m, 3)) if is_sure else None
            news = (SurveyNews(position),) if self._survey is None else self._survey.news(position, time_ns)
            outbox = (*outbox, *(Message(self._robot_id, EVERYBODY, survey_news(one)) for one in news))
        shown = {"found": self._shown(time_ns), "particles": self._particles(time_ns)}
        return msgspec.structs.replace(decision, outbox=outbox, localisation=self._localiser.localisation, **shown)

    def _is_due(self, time_ns: int, task: Task) -> bool:
        """Whether the robot tells its team now where it is and what it has found."""
        return self._shares and task.running and time_ns >= self._due_ns

    def _setup_of_controller(self) -> Setup:
        """Return the setup with the middle of the building in place of starts that the robot does not know."""
        setup = self._setup
        starts = {i: setup.middle for i in range(len(setup.robots)) if not setup.knows_start(i)}
        if not self._is_placed:
            return setup.with_starts({**starts, self._robot_id: setup.middle}).without_areas()
        if self._had_to_be_placed:
            starts[self._robot_id] = self._localiser.localisation.pose
        return setup.with_starts(starts) if starts else setup

    def _shown(self, time_ns: int) -> OccupancyGrid | None:
        """Return the map for display, if it has changed and was not shown just before."""
        found = self.found
        if found is None or time_ns < self._shown_ns or found.version == self._shown_version:
            return None
        self._shown_ns, self._shown_version = time_ns + _SHOWN_NS, found.version
        return found.known_part

    def _particles(self, time_ns: int) -> tuple[Pose, ...] | None:
        """Return the particles for display, if they have changed and were not shown just before."""
        if time_ns < self._cloud_due_ns:
            return None
        self._cloud_due_ns, before = time_ns + _CLOUD_NS, self._cloud
        self._cloud = self._localiser.particles
        return None if self._cloud == before else self._cloud

    def _read(self, inbox: Sequence[Message], time_ns: int) -> Sequence[Message]:
        """Take over the news in an inbox, and return the other messages."""
        found = [survey_news_in(message.payload) for message in inbox]
        for message, news in zip(inbox, found, strict=True):
            if news is not None and message.sender != self._robot_id:
                if news.position is not None:
                    self._teammates.note(message.sender, news.position, time_ns)
                if self._survey is not None:
                    self._survey.hear(message.sender, news, time_ns)
        return [message for message, news in zip(inbox, found, strict=True) if news is None]


def _believed(observation: Observation, pose: Pose) -> Observation:
    """Return an observation of a robot that believes to have a pose."""
    # A robot hears where a voice is as seen from itself.
    loudest = pose @ observation.robot.true_pose.inverse() @ Pose(*observation.voice.local_best_m, 0.0)
    return msgspec.structs.replace(
        observation,
        robot=msgspec.structs.replace(observation.robot, ground_truth=PoseReading.from_pose(pose)),
        voice=msgspec.structs.replace(observation.voice, local_best_m=(loudest.x_m, loudest.y_m)),
        own_pose=pose,
    )

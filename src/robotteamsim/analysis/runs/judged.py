"""Judges a recorded run, of this simulator, another one or real robots, by the mission of a scenario."""

from __future__ import annotations

import contextlib
import math
from bisect import bisect_right
from collections.abc import Sequence
from operator import itemgetter
from pathlib import Path

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.analysis.runs.recorded_run import RecordedRobot, RecordedRun
from robotteamsim.errors import PlacementError, RecordingError
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision
from robotteamsim.mission import Sensed
from robotteamsim.network.messages import Message
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.topics.decisions import OUTBOX, STATUS
from robotteamsim.scenario import Scenario
from robotteamsim.sensing.readings import OdometryReading, RobotReading
from robotteamsim.setup import Setup, resolve
from robotteamsim.simulation import Observer, Result, Simulation
from robotteamsim.simulation.trial import Trial
from robotteamsim.wording import counted

_NO_RANGES = np.zeros(0, np.float32)
_NOWHERE = Pose(math.nan, math.nan, math.nan)


def judge(run: RecordedRun, paths: Sequence[Path], scenario: Scenario, observers: Sequence[Observer] = ()) -> Result:
    """Judge the run of a bag, or of the parts of one, by the mission of a scenario, and show each step to observers.

    The poses of the robots are those of the run, and what their controllers say is that of `controller/status` and
    `network/tx` if the bag has them. All else is computed, as in a simulation: voices, radio, people, fire, doors that
    the schedule moves, and the rules of the mission. Its time begins one step before the first pose.

    Returns: the result; its `end` is "" if the recording ends before the mission does.
    Raises:  RecordingError: the run has robots that the scenario has not, or their poses are not in `map`.
    """
    setup = resolve(scenario)
    robots = _team(run, setup, paths)
    recorded = _Recorded(setup, run, robots, _Said(paths, robots, setup))
    simulation = Simulation(setup, controllers=recorded)
    simulation.sensors = recorded
    simulation.mission.start()
    trial = Trial(setup, observers)
    try:
        while True:
            recorded.begin_step(simulation)
            record = simulation.step()
            trial.add(record)
            if trial.result is not None or recorded.is_over:
                return trial.result or trial.end(record)
    finally:
        trial.abandon()


def _team(run: RecordedRun, setup: Setup, paths: Sequence[Path]) -> list[RecordedRobot | None]:
    """Return the robots of a run in the order of the scenario's; None: the run has no poses of it.

    Raises: RecordingError, as `judge`.
    """
    files, expected, name = ", ".join(map(str, paths)), len(setup.robots), setup.scenario.name
    numbered = {robot.robot_id: robot for robot in run.robots if robot.robot_id is not None}
    if not numbered and len(run.robots) == expected:
        team: list[RecordedRobot | None] = list(run.robots)
    elif numbered and len(numbered) == len(run.robots) and max(numbered) < expected:
        team = [numbered.get(robot_id) for robot_id in range(expected)]
    else:
        names = ", ".join(robot.name for robot in run.robots) or "none"
        text = f"has the poses of {counted(len(run.robots), 'robot')} ({names})"
        numbers = "robot_0" if expected == 1 else f"robot_0 to robot_{expected - 1}"
        known = f"expected {numbers} of {name}, or as many of other names" if expected else f"{name} has no robots"
        raise RecordingError(f"{files}: {text}; {known}")
    for robot in filter(None, team):
        if not robot.track.is_on_map:
            text = f"its poses are in '{robot.track.frame}', and no transform leads from map to it"
            raise RecordingError(f"{files}: {robot.name}: {text}")
    return team


class _Said:
    """What the controllers of a bag have said: their statuses, and their messages."""

    def __init__(self, paths: Sequence[Path], robots: Sequence[RecordedRobot | None], setup: Setup) -> None:
        """Read the bag. Raises: RecordingError: it cannot be read, or a message is impossible."""
        self._statuses: list[list[tuple[int, Decision]]] = [[] for _ in robots]
        self._messages: list[list[tuple[int, Message]]] = [[] for _ in robots]
        topics = [(i, topic, robot) for i, robot in enumerate(robots) if robot for topic in (STATUS, OUTBOX)]
        wanted = {f"{robot.namespace}/{topic.name}": (i, topic) for i, topic, robot in topics}
        with BagReader(paths) as bag:
            types = bag.topics
            known = {name for name, (_, topic) in wanted.items() if types.get(name) == topic.type_name}
            for name, stamp_ns, message in bag.messages(set(filter(bag.is_known, known))):
                robot_id, topic = wanted[name]
                assert topic.read is not None
                try:
                    value = topic.read(message, setup, robot_id)
                except ValueError as error:
                    raise RecordingError(f"{', '.join(map(str, paths))}: {name}: {error}") from None
                if topic is STATUS:
                    self._statuses[robot_id].append((stamp_ns, value))
                else:
                    self._messages[robot_id] += [(stamp_ns, one) for one in value]
        for statuses, messages in zip(self._statuses, self._messages, strict=True):
            statuses.sort(key=itemgetter(0))
            messages.sort(key=itemgetter(0))

    def decision(self, robot_id: int, before_ns: int, stamp_ns: int) -> Decision:
        """Return the last status up to a stamp, with the messages since another one [ns]."""
        statuses, messages = self._statuses[robot_id], self._messages[robot_id]
        last = bisect_right(statuses, stamp_ns, key=itemgetter(0)) - 1
        first, end = (bisect_right(messages, at_ns, key=itemgetter(0)) for at_ns in (before_ns, stamp_ns))
        status = statuses[last][1] if last >= 0 else Decision()
        return msgspec.structs.replace(status, outbox=tuple(message for _, message in messages[first:end]))


class _Recorded:
    """Sensors and controllers of robots that do what a bag says."""

    def __init__(self, setup: Setup, run: RecordedRun, robots: Sequence[RecordedRobot | None], said: _Said) -> None:
        self._robots, self._said, self._step_ns = robots, said, setup.scenario.run.step_ns
        stamps_ns = [robot.track.stamps_ns[[0, -1]] for robot in robots if robot]
        first_ns, self._end_ns = run.start_ns, run.end_ns
        if stamps_ns:
            first_ns, self._end_ns = int(np.min(stamps_ns)), int(np.max(stamps_ns))
        self._stamp_ns = first_ns - self._step_ns
        """Of the current step."""

    @property
    def faults(self) -> Sequence[str]:
        """As for all controllers."""
        return [""] * len(self._robots)

    @property
    def is_over(self) -> bool:
        """Whether there is no further step."""
        return self._stamp_ns + self._step_ns > self._end_ns

    def begin_step(self, simulation: Simulation) -> None:
        """Begin the next step: put the bodies where the robots are at its end, and let robots leave or come."""
        self._stamp_ns += self._step_ns
        world = simulation.world
        for robot_id, robot in enumerate(self._robots):
            reading = self._reading(robot)
            # Where there is no room, the body stays where it was.
            with contextlib.suppress(PlacementError, ValueError):
                if reading is None:
                    simulation.remove_robot(robot_id)
                elif not world.present[robot_id]:
                    simulation.spawn_robot(robot_id, reading.true_pose)
                else:
                    world.set_pose(robot_id, reading.true_pose)

    def read(self) -> _core.state.State:
        """As for all sensors."""
        state = _core.state.State(len(self._robots))
        for robot_id, robot in enumerate(self._robots):
            if (reading := self._reading(robot)) is not None:
                state.put_reading(robot_id, reading)
            else:
                state.place(robot_id, _NOWHERE)
        return state

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers. A robot has no command, because its body is moved."""
        before_ns = self._stamp_ns - self._step_ns
        return tuple(
            self._said.decision(i, before_ns, self._stamp_ns) if is_there else Decision()
            for i, is_there in enumerate(sensed.present.tolist())
        )

    def _reading(self, robot: RecordedRobot | None) -> RobotReading | None:
        """Return the reading of a robot; None: it is not there now."""
        if robot is None or self._stamp_ns < robot.track.stamps_ns[0] or not robot.track.is_present(self._stamp_ns):
            return None
        track, contact = robot.track, robot.contact
        index = track.index_at(self._stamp_ns)
        x_m, y_m, yaw_rad = track.poses[index].tolist()
        pose = PoseReading.from_pose(Pose(x_m, y_m, yaw_rad))
        if track.source == "truth":
            pose = PoseReading(x_m, y_m, *track.turns[index].tolist())  # as recorded, to the bit
        touches = contact is not None and bool(contact.at(self._stamp_ns))
        return RobotReading(pose, Twist(), OdometryReading(pose, Twist()), _NO_RANGES, touches)

"""Judges a recorded run, of this simulator, another one or real robots, by the mission of a scenario."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.analysis.runs.recorded_run import RecordedRobot, RecordedRun
from robotteamsim.errors import PlacementError, RecordingError
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.interface import Decision
from robotteamsim.mission import Sensed
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.topics.decisions import OUTBOX, STATUS
from robotteamsim.scenario import Scenario
from robotteamsim.sensing.readings import OdometryReading, RobotReading
from robotteamsim.setup import Setup, resolve
from robotteamsim.simulation import Observer, Result, Simulation
from robotteamsim.simulation.trial import Trial
from robotteamsim.wording import counted

_NO_RANGES = np.zeros(0, np.float32)


def judge(run: RecordedRun, paths: Sequence[Path], scenario: Scenario, observers: Sequence[Observer] = ()) -> Result:
    """Judge the run of a bag, or of the parts of one, by the mission of a scenario, and show each step to observers.

    The poses of the robots are those of the run, and what their controllers say is that of `controller/status` and
    `network/tx` if the bag has them. All else is computed, as in a simulation: voices, radio, people, fire, doors that
    the schedule moves, and the rules of the mission. Its time begins one step before the first pose.

    Returns: the result; its `end` is "" if the recording ends before the mission does.
    Raises:  RecordingError: the run has not the robots of the scenario, or their poses are not in `map`.
    """
    setup = resolve(scenario)
    robots = _team(run, setup, paths)
    recorded = _Recorded(setup, run, robots, _decisions(paths, robots, setup))
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


def _team(run: RecordedRun, setup: Setup, paths: Sequence[Path]) -> list[RecordedRobot]:
    """Return the robots of a run in the order of the scenario's. Raises: RecordingError, as `judge`."""
    files, expected = ", ".join(map(str, paths)), len(setup.robots)
    robots = sorted(run.robots, key=lambda robot: (robot.robot_id is None, robot.robot_id or 0))
    numbers = [robot.robot_id for robot in robots]
    if len(robots) != expected or not (numbers == [*range(expected)] or set(numbers) == {None}):
        names = ", ".join(robot.name for robot in robots) or "none"
        text = f"has the poses of {counted(len(robots), 'robot')} ({names})"
        raise RecordingError(
            f"{files}: {text}; expected those of the {counted(expected, 'robot')} of {setup.scenario.name}"
        )
    for robot in robots:
        if not robot.track.is_on_map:
            frame = robot.track.frame
            raise RecordingError(
                f"{files}: {robot.name}: its poses are in '{frame}', and no transform leads from map to it"
            )
    return robots


def _decisions(
    paths: Sequence[Path], robots: Sequence[RecordedRobot], setup: Setup
) -> Mapping[tuple[int, int], Decision]:
    """Return what controllers have said, by stamp [ns] and robot; empty if the bag does not say it."""
    wanted = {
        f"{robot.namespace}/{topic.name}": (i, topic) for i, robot in enumerate(robots) for topic in (STATUS, OUTBOX)
    }
    found: dict[tuple[int, int], Decision] = {}
    with BagReader(paths) as bag:
        known = {
            name
            for name, (_, topic) in wanted.items()
            if bag.topics.get(name) == topic.type_name and bag.is_known(name)
        }
        for name, stamp_ns, message in bag.messages(known):
            robot_id, topic = wanted[name]
            assert topic.read is not None
            try:
                value = topic.read(message, setup, robot_id)
            except ValueError as error:
                raise RecordingError(f"{', '.join(map(str, paths))}: {name}: {error}") from None
            before = found.get((stamp_ns, robot_id), Decision())
            if topic is STATUS:
                found[stamp_ns, robot_id] = msgspec.structs.replace(value, outbox=before.outbox)
            else:
                found[stamp_ns, robot_id] = msgspec.structs.replace(before, outbox=tuple(value))
    return found


class _Recorded:
    """Sensors and controllers of robots that do what a bag says."""

    def __init__(
        self,
        setup: Setup,
        run: RecordedRun,
        robots: Sequence[RecordedRobot],
        decisions: Mapping[tuple[int, int], Decision],
    ) -> None:
        self._robots, self._decisions, self._step_ns = robots, decisions, setup.scenario.run.step_ns
        stamps_ns = [robot.track.stamps_ns[[0, -1]] for robot in robots]
        first_ns, self._end_ns = run.start_ns, run.end_ns
        if robots:
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
            # Schedules do the same; what else has happened is seen when it has happened.
            is_there = robot.track.is_present(self._stamp_ns - self._step_ns)
            # Where there is no room, the body stays where it was.
            with contextlib.suppress(PlacementError, ValueError):
                if is_there and not world.present[robot_id]:
                    simulation.spawn_robot(robot_id, self._reading(robot).true_pose)
                elif not is_there and world.present[robot_id]:
                    simulation.remove_robot(robot_id)
                world.set_pose(robot_id, self._reading(robot).true_pose)

    def read(self) -> _core.state.State:
        """As for all sensors."""
        state = _core.state.State(len(self._robots))
        for robot_id, robot in enumerate(self._robots):
            if robot.track.is_present(self._stamp_ns):
                state.put_reading(robot_id, self._reading(robot))
        return state

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers; a robot stands, because its body is moved."""
        still = Decision()
        team = [self._decisions.get((self._stamp_ns, i), still) for i in range(len(self._robots))]
        return tuple(one if is_there else still for one, is_there in zip(team, sensed.present.tolist(), strict=True))

    def _reading(self, robot: RecordedRobot) -> RobotReading:
        track = robot.track
        index = track.index_at(self._stamp_ns)
        (x_m, y_m, _), (qz, qw) = track.poses[index].tolist(), track.turns[index].tolist()
        pose = PoseReading(x_m, y_m, qz, qw)
        touches = robot.contact is not None and bool(
            robot.contact.values[_last(robot.contact.stamps_ns, self._stamp_ns)]
        )
        return RobotReading(pose, Twist(), OdometryReading(pose, Twist()), _NO_RANGES, touches)


def _last(stamps_ns: np.ndarray, stamp_ns: int) -> int:
    """Return the index of the last stamp at or before another one, or 0 if there is none."""
    return max(int(np.searchsorted(stamps_ns, stamp_ns, side="right")) - 1, 0)

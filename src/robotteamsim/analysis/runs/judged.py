"""Judges a recorded run, of this simulator, another one or real robots, by the mission of a scenario."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from operator import itemgetter

import msgspec
import numpy as np

from robotteamsim.errors import RecordingError
from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.interface import Decision
from robotteamsim.network.messages import Message
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.replay.recorded_run import RecordedRobot, RecordedRun
from robotteamsim.recording.topics.decisions import OUTBOX, STATUS
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result
from robotteamsim.simulation.judge import Judge
from robotteamsim.wording import counted


def judge(run: RecordedRun, setup: Setup, observers: Sequence[Observer] = ()) -> Result:
    """Judge a run by the mission of a scenario, and show each step to observers.

    The poses of the robots are those of the run, and what their controllers say is that of `controller/status` and
    `network/tx` if the bag has them. All else is computed, as in a simulation: voices, radio, people, fire, doors that
    the schedule moves, and the rules of the mission. Its time begins one step before the first pose.

    Returns: the result; its `end` is "" if the recording ends before the mission does.
    Raises:  RecordingError: the run has robots that the scenario has not, or their poses are not in `map`.
    """
    robots = _team(run, setup)
    said, step_ns = _Said(run, robots, setup), setup.scenario.run.step_ns
    stamps_ns = [robot.track.stamps_ns[[0, -1]] for robot in robots if robot] or [np.array([run.start_ns, run.end_ns])]
    first_ns, end_ns = int(np.min(stamps_ns)), int(np.max(stamps_ns))
    judged = Judge(setup, observers)
    try:
        for stamp_ns in range(first_ns, end_ns + 1, step_ns):
            poses = [_pose(robot, stamp_ns) for robot in robots]
            touching = [_touches(robot, stamp_ns) for robot in robots]
            decisions = [said.decision(i, stamp_ns - step_ns, stamp_ns) for i in range(len(robots))]
            record = judged.follow(poses, touching, decisions)
            if judged.trial.result is not None:
                return judged.trial.result
        return judged.trial.end(record)
    finally:
        judged.trial.abandon()


def _team(run: RecordedRun, setup: Setup) -> list[RecordedRobot | None]:
    """Return the robots of a run in the order of the scenario's; None: the run has no poses of it.

    Raises: RecordingError, as `judge`.
    """
    files, expected, name = ", ".join(map(str, run.paths)), len(setup.robots), setup.scenario.name
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

    def __init__(self, run: RecordedRun, robots: Sequence[RecordedRobot | None], setup: Setup) -> None:
        """Read the bag. Raises: RecordingError: it cannot be read, or a message is impossible."""
        self._statuses: list[list[tuple[int, Decision]]] = [[] for _ in robots]
        self._messages: list[list[tuple[int, Message]]] = [[] for _ in robots]
        topics = [(i, topic, robot) for i, robot in enumerate(robots) if robot for topic in (STATUS, OUTBOX)]
        wanted = {f"{robot.namespace}/{topic.name}": (i, topic) for i, topic, robot in topics}
        with BagReader(run.paths) as bag:
            types = bag.topics
            known = {name for name, (_, topic) in wanted.items() if types.get(name) == topic.type_name}
            for name, stamp_ns, message in bag.messages(set(filter(bag.is_known, known))):
                robot_id, topic = wanted[name]
                assert topic.read is not None
                try:
                    value = topic.read(message, setup, robot_id)
                except ValueError as error:
                    raise RecordingError(f"{', '.join(map(str, run.paths))}: {name}: {error}") from None
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


def _pose(robot: RecordedRobot | None, stamp_ns: int) -> PoseReading | None:
    """Return the pose of a robot; None: it is not there."""
    if robot is None or stamp_ns < robot.track.stamps_ns[0] or not robot.track.is_present(stamp_ns):
        return None
    track = robot.track
    index = track.index_at(stamp_ns)
    x_m, y_m, yaw_rad = track.poses[index].tolist()
    if track.source == "truth":
        return PoseReading(x_m, y_m, *track.turns[index].tolist())  # as recorded, to the bit
    return PoseReading.from_pose(Pose(x_m, y_m, yaw_rad))


def _touches(robot: RecordedRobot | None, stamp_ns: int) -> bool:
    return robot is not None and robot.contact is not None and bool(robot.contact.at(stamp_ns))

"""What agents perceive and remember in a mission, as arrays with a row per agent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import msgspec
import numpy as np

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.interface import Message, Observation, Task
from robotteamsim.interface.payload import Point, Update, update_reader
from robotteamsim.learning.arrays import numbers_of
from robotteamsim.learning.observe import Observe, Percepts, cos_sin
from robotteamsim.mission import Sensed
from robotteamsim.network.messages import Batch, batch_of
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.setup import Setup


class Said(Update, frozen=True):
    """The message of a robot to its teammates: the sender's position in `map` [m], and the numbers of its policy."""

    at: Point
    say: tuple[Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)], ...] = ()


_read = update_reader(Said, kept=256)


class Senses:
    """The agents' side of a mission: remembers what teammates say, and puts readings into arrays.

    It has no knowledge but that of a controller: readings, voices, the task, and messages.
    """

    def __init__(self, setup: Setup, observe: Observe) -> None:
        """Args: observe: says who the agents are, and what they perceive."""
        self._observe, self._ids = observe, list(observe.robot_ids)
        self._are_all = self._ids == list(range(len(setup.robots)))
        by_odometry = setup.scenario.control.localisation == "odometry"
        starts = [PoseReading.from_pose(Pose(*setup.robots[i].start_pose)) for i in self._ids]
        self.map_T_odom = np.array([msgspec.structs.astuple(start) for start in starts]) if by_odometry else None
        self.memory = observe.remembers(setup, self._ids)
        senders = range(max(len(setup.robots), observe.teammates + 1))
        others = [[sender for sender in senders if sender != i][: observe.teammates] for i in self._ids]
        self.of_others = np.arange(len(self._ids))[:, None], np.array(others, int)
        """Where `heard` has each agent's teammates, the first others in id order."""
        self.heard = np.zeros((len(self._ids), len(senders), 4 + observe.said))
        """Per agent and sender: a row of `Percepts.heard`, but with the time of the message [ns]."""

    def note(self, time_ns: int, inboxes: Sequence[Sequence[Message]], readings: Sequence[RobotReading]) -> None:
        """Note a step: what teammates say, without messages of other kinds, and readings, if the memory looks at them.

        Args: inboxes, readings: one per agent.
        """
        if self.memory.looks:
            self.memory.look(readings)
        agents: dict[Batch, list[int]] = {}
        for agent, inbox in enumerate(inboxes):
            if inbox:
                agents.setdefault(batch_of(inbox), []).append(agent)
        for batch, receivers in agents.items():
            senders, rows = _said_in(batch, self._observe.said)
            where = np.array(receivers)[:, None], senders
            self.heard[where] = rows
            self.heard[(*where, 3)] = time_ns

    def note_team(self, sensed: Sensed) -> None:
        """Note a step, see `note`."""
        readings = [sensed.readings[i] for i in self._ids] if self.memory.looks else ()
        self.note(sensed.sim_time_ns, [sensed.inboxes[i] for i in self._ids], readings)

    def of_team(self, sensed: Sensed) -> Percepts:
        """Return what the agents of a team perceive; numbers of absent ones mean nothing, but are finite."""
        state = sensed.state
        poses = state.true_pose if self.map_T_odom is None else state.odometry_pose
        if not sensed.present.all():
            poses = np.where(sensed.present[:, None], poses, 0.0)
        voices = np.column_stack((state.voice_heard, state.local_best_level_db, state.local_best_m))
        ids = slice(None) if self._are_all else self._ids
        return self._percepts(
            state.ranges_m[ids], poses[ids], state.odometry_twist[ids], voices[ids], sensed.task, sensed.sim_time_ns
        )

    def of_robot(self, observation: Observation, task: Task) -> Percepts:
        """Return what the only agent perceives, from the observation of its controller."""
        robot = observation.robot
        pose = robot.ground_truth if self.map_T_odom is None else robot.odometry.pose
        poses, twists = (np.array([msgspec.structs.astuple(record)]) for record in (pose, robot.odometry.twist))
        voice, ranges_m = observation.voice, np.full((1, self._observe.beams), np.inf, np.float32)
        ranges_m[0, : len(robot.ranges_m)] = robot.ranges_m
        voices = np.array([(voice.heard, voice.local_best_level_db, *voice.local_best_m)], float)
        return self._percepts(ranges_m, poses, twists, voices, task, observation.sim_time_ns)

    def _percepts(
        self,
        ranges_m: np.ndarray,
        poses: np.ndarray,
        twists: np.ndarray,
        voices: np.ndarray,
        task: Task,
        time_ns: int,
    ) -> Percepts:
        area = task.area_center_m
        heard = self.heard[self.of_others]
        heard[..., 3] = (time_ns - heard[..., 3]) * 1e-9
        percepts = Percepts(
            ranges_m,
            poses if self.map_T_odom is None else composed(self.map_T_odom, poses),
            twists,
            voices,
            np.array([(0.0, 0.0, 0.0) if area is None else (1.0, *area)]),
            heard,
            np.zeros((len(self._ids), 0)),
        )
        shape = len(self._ids), self._observe.remembered
        name, remembered = type(self.memory).__name__, self.memory.after(percepts, time_ns * 1e-9)
        return percepts._replace(remembered=numbers_of(f"{name}.after", remembered, shape))


def _said_in(batch: Batch, said: int) -> tuple[list[int], np.ndarray]:
    """Return who says so many numbers in a batch, and their rows of `Percepts.heard`, with time 0."""
    rows = {}
    for message in batch.messages:
        content = _read(message.payload)
        if content is not None and len(content.say) == said:
            rows[message.sender] = (1.0, *content.at, 0.0, *content.say)
    return list(rows), np.array(list(rows.values()), float).reshape(-1, 4 + said)


def composed(first: np.ndarray, then: np.ndarray) -> np.ndarray:
    """Return the transforms one after the other, all in the form of `Percepts.poses`, also of stacked missions."""
    x_m, y_m, qz, qw = np.moveaxis(first, -1, 0)
    (other_x_m, other_y_m, other_qz, other_qw), (cos, sin) = np.moveaxis(then, -1, 0), cos_sin(first)
    return np.stack(
        (
            x_m + cos * other_x_m - sin * other_y_m,
            y_m + sin * other_x_m + cos * other_y_m,
            qw * other_qz + qz * other_qw,
            qw * other_qw - qz * other_qz,
        ),
        -1,
    )

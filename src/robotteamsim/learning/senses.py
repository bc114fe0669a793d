"""What agents perceive and remember in missions, as arrays with a row per mission and agent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.interface import Message, Observation, Task
from robotteamsim.interface.payload import Point, Update, update_reader
from robotteamsim.learning.arrays import array_of, numbers_of, shown
from robotteamsim.learning.driven import Believed
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.observe import Memory, Observe, Percepts, area_of, cos_sin
from robotteamsim.mission import Sensed
from robotteamsim.network.messages import Batch, batch_of
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.setup import Setup

Rows = slice | np.ndarray
"""Some of the missions, as an index of arrays."""


class Said(Update, frozen=True):
    """The message of a robot to its teammates: the sender's position in `map` [m], and the numbers of its policy."""

    at: Point
    say: tuple[Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)], ...] = ()


_read = update_reader(Said, kept=256)


class Senses:
    """The agents' side of missions: remembers what teammates say, and puts readings into arrays.

    It has no knowledge but that of a controller: readings, voices, the task, and messages.
    """

    def __init__(self, setup: Setup, observe: Observe, missions: int = 1) -> None:
        """Args: setup: of the missions, which differ by their seeds.
        observe: says who the agents are, and what they perceive.
        """
        self._observe, self._ids = observe, list(observe.robot_ids)
        self._by_odometry = setup.scenario.control.localisation == "odometry"
        shape, senders = (missions, len(self._ids)), range(max(len(setup.robots), observe.teammates + 1))
        self._map_T_odom = np.zeros((*shape, 4))
        others = [[sender for sender in senders if sender != i][: observe.teammates] for i in self._ids]
        self._of_others = np.arange(len(self._ids))[:, None], np.array(others, int)
        """Where `_heard` has each agent's teammates, the first others in id order."""
        self._heard = np.zeros((*shape, len(senders), 4 + observe.said))
        """Per agent and sender: a row of `Percepts.heard`, but with the time of the message [ns]."""
        self._memories: list[Memory] = [observe.remembers(setup, self._ids)] * missions
        self.percepts = Percepts(
            np.zeros((*shape, observe.beams), np.float32),
            np.zeros((*shape, 4)),
            np.zeros((*shape, 3)),
            np.zeros((*shape, 4)),
            np.zeros((missions, 1, 3)),
            np.zeros((*shape, observe.teammates, 4 + observe.said)),
            np.zeros((*shape, observe.remembered)),
        )
        """What was perceived last in each mission; numbers of absent agents mean nothing, but are finite."""

    def looks(self, mission: int) -> bool:
        """Whether the agents of a mission look at the readings of each step, see `Memory.looks`."""
        return self._memories[mission].looks

    def begin(self, mission: int, setup: Setup) -> None:
        """Let a mission begin, in which nothing has been perceived."""
        self._heard[mission] = 0.0
        starts = [PoseReading.from_pose(Pose(*setup.robots[i].start_pose)) for i in self._ids]
        self._map_T_odom[mission] = [msgspec.structs.astuple(start) for start in starts]
        self._memories[mission] = self._observe.remembers(setup, self._ids)

    def note(
        self,
        mission: int,
        time_ns: int,
        inboxes: Sequence[Sequence[Message]],
        readings: Sequence[RobotReading],
    ) -> None:
        """Note a step: what teammates say, without messages of other kinds, and readings, if the memory looks at them.

        Args: inboxes, readings: one per agent.
        """
        if self.looks(mission):
            self._memories[mission].look(readings)
        agents: dict[Batch, list[int]] = {}
        for agent, inbox in enumerate(inboxes):
            if inbox:
                agents.setdefault(batch_of(inbox), []).append(agent)
        for batch, receivers in agents.items():
            senders, rows = _said_in(batch, self._observe.said)
            where = mission, np.array(receivers)[:, None], senders
            self._heard[where] = rows
            self._heard[(*where, 3)] = time_ns

    def note_team(self, mission: int, sensed: Sensed, believed: Believed | None = None) -> None:
        """Note a step of a whole team, see `note`. Args: believed: by the agents, in place of what was sensed."""
        readings = [sensed.readings[i] for i in self._ids] if self.looks(mission) else []
        inboxes: Sequence[Sequence[Message]] = [sensed.inboxes[i] for i in self._ids]
        if believed is not None:
            own, inboxes = believed
            readings = [read if one is None else one.robot for read, one in zip(readings, own, strict=False)]
        self.note(mission, sensed.sim_time_ns, inboxes, readings)

    def hear(
        self, missions: Rows, hears: np.ndarray, positions_m: np.ndarray, say: np.ndarray, times_ns: np.ndarray
    ) -> None:
        """Note what agents, who are the whole team, hear of each other's `Said`.

        Args:   hears: who hears whom, bool, shape (k, n, n): mission, receiver, sender.
                positions_m, say: that each sends, shapes (k, n, 2) and (k, n, said).
                times_ns: of arrival, shape (k,).
        """
        rows = np.empty((*positions_m.shape[:2], 4 + self._observe.said))
        rows[..., 0], rows[..., 1:3], rows[..., 3], rows[..., 4:] = 1.0, positions_m, times_ns[:, None], say
        heard = self._heard[missions]
        np.copyto(heard[:, :, : rows.shape[1]], rows[:, None], where=hears[..., None])
        self._heard[missions] = heard

    def perceive_together(
        self, missions: Rows, state: _core.state.State, areas: np.ndarray, times_ns: np.ndarray
    ) -> None:
        """Let the agents of k missions of a batch, who are the whole team, perceive a step.

        Args: areas: rows of `Percepts.area`, shape (k, 3).  times_ns: stamps, shape (k,).
        """
        self._perceive(missions, self._measured(state, missions), areas, times_ns)

    def perceive_team(self, mission: int, sensed: Sensed, believed: Believed | None = None) -> None:
        """Let the agents of a mission perceive a step. Args: believed: see `note_team`."""
        if believed is not None:
            self.perceive_each(mission, believed.observations, sensed.task, sensed.sim_time_ns)
            return
        measured, are_absent = self._measured(sensed.state, self._ids), ~sensed.present[self._ids]
        for part in measured:
            part[are_absent] = 0.0  # not NaN
        self._perceive_alone(mission, measured, sensed.task, sensed.sim_time_ns)

    def perceive_each(self, mission: int, observations: Sequence[Observation | None], task: Task, time_ns: int) -> None:
        """Let the agents of a mission perceive, by the observations of their controllers; None for absent agents."""
        state = _core.state.State(len(observations), self._observe.beams)
        for agent, observation in enumerate(observations):
            if observation is not None:
                state.put_reading(agent, observation.robot)
                state.put_voice(agent, observation.voice)
        measured = self._measured(state, np.arange(len(observations)))
        are_absent = [observation is None for observation in observations]
        for part in measured:
            part[are_absent] = 0.0  # not NaN
        self._perceive_alone(mission, measured, task, time_ns)

    def vectors(self, present: np.ndarray) -> np.ndarray:
        """Return the observation of each agent, float32, shape (missions, n, size of the space); 0 for absent ones.

        Raises: LearningError: the class of observations returns something else than it says.
        """
        observe = self._observe
        vectors = array_of(observe.vectors(Percepts(*(part.copy() for part in self.percepts))))
        shape = (*present.shape, *observe.space.shape)
        if vectors.shape != shape or vectors.dtype != observe.space.dtype:
            found = f"observations {shown(vectors)}, shape {vectors.shape}"
            raise LearningError(f"{found}; expected {observe.space.dtype} within [-1, 1], shape {shape}")
        vectors[~present] = 0.0
        are_within = np.abs(vectors) <= 1.0  # NaN is not
        if not are_within.all():
            *_, row, number = place = tuple(np.argwhere(~are_within)[0])
            part = next(part for part in observe.parts if number < part.begin + part.size)
            found = f"robot_{observe.robot_ids[row]}: observation: part {part.name}[{number - part.begin}]"
            raise LearningError(f"{found}: {vectors[place]}; expected a number within [-1, 1]")
        return vectors

    def _measured(self, state: _core.state.State, rows: Rows | list[int]) -> tuple[np.ndarray, ...]:
        """Return ranges, poses by `control.localisation`, twists and voices (heard, level, place) of some rows."""
        poses = state.odometry_pose if self._by_odometry else state.true_pose
        voices = state.voice_heard, state.local_best_level_db, state.local_best_m
        return tuple(array[rows] for array in (state.ranges_m, poses, state.odometry_twist, *voices))

    def _perceive_alone(self, mission: int, measured: Sequence[np.ndarray], task: Task, time_ns: int) -> None:
        rows = slice(mission, mission + 1)
        self._perceive(rows, measured, np.array([area_of(task)]), np.array([time_ns]))

    def _perceive(
        self, missions: Rows, measured: Sequence[np.ndarray], areas: np.ndarray, times_ns: np.ndarray
    ) -> None:
        of, (ranges_m, poses, twists, are_heard, levels_db, places_m) = self.percepts, measured
        of.ranges_m[missions], of.twists[missions], of.area[missions, 0] = ranges_m, twists, areas
        of.poses[missions] = composed(self._map_T_odom[missions], poses) if self._by_odometry else poses
        of.voices[missions, :, 0], of.voices[missions, :, 1] = are_heard, levels_db
        of.voices[missions, :, 2:] = places_m
        agents, senders = self._of_others
        heard = self._heard[missions][:, agents, senders]
        heard[..., 3] = (times_ns[:, None, None] - heard[..., 3]) * 1e-9
        of.heard[missions] = heard
        if self._observe.remembers is not Memory:
            self._remember(missions, times_ns)

    def _remember(self, missions: Rows, times_ns: np.ndarray) -> None:
        """Let memories look at what was perceived, mission by mission."""
        shape = self.percepts.remembered.shape[1:]
        numbers = range(len(self._memories))[missions] if isinstance(missions, slice) else missions.tolist()
        for mission, time_ns in zip(numbers, times_ns.tolist(), strict=True):
            memory, of = self._memories[mission], Percepts(*(part[mission].copy() for part in self.percepts))
            remembered = memory.after(of._replace(remembered=np.zeros((shape[0], 0))), time_ns * 1e-9)
            self.percepts.remembered[mission] = numbers_of(f"{type(memory).__name__}.after", remembered, shape)


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

"""What the policy of each robot perceives, as one vector."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from gymnasium.spaces import Box

from robotteamsim import _core
from robotteamsim.interface import Task
from robotteamsim.learning.errors import LearningError
from robotteamsim.propagation import shared_radio_field
from robotteamsim.scenario.scenario import MAX_ROBOTS
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.setup import Setup

LARGEST_PART = 10**6
"""Numbers in a part of the vector, and in a message."""

LARGEST_VECTOR = 10**7

MOST_TEAMMATES = MAX_ROBOTS - 1


class Part(NamedTuple):
    """A part of the vector: where it begins, how many numbers it has, and what they mean."""

    name: str
    begin: int
    size: int
    meaning: str


class Percepts(NamedTuple):
    """What n agents perceive in one step. Stacked missions have one more axis in front.

    ranges_m: float32, shape (n, beams); beams that a robot does not have are infinite.
    poses:    x, y [m], qz, qw in `map` by `control.localisation`, shape (n, 4).
    twists:   speed ahead and to the left [m/s] and turn [rad/s] by odometry, shape (n, 3).
    voices:   whether a voice is heard, the level of the loudest cell [dB], its x and y in `map` [m], shape (n, 4).
    area:     whether there is an area to explore, x and y of its centre in `map` [m], shape (1, 3).
    heard:    per teammate: whether it has been heard of, x and y in `map` [m], the time since then [s], and what it
              said, shape (n, teammates, 4 + said).
    remembered: numbers of its `Memory`, which `Observe.vectors` clips to [-1, 1], shape (n, as many as it has).
    """

    ranges_m: np.ndarray
    poses: np.ndarray
    twists: np.ndarray
    voices: np.ndarray
    area: np.ndarray
    heard: np.ndarray
    remembered: np.ndarray


def cos_sin(poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return cosine and sine of the yaws, from the quaternions of `Percepts.poses`."""
    qz, qw = poses[..., 2], poses[..., 3]
    return 1.0 - 2.0 * qz * qz, 2.0 * qz * qw


def seen_from(poses: np.ndarray, places_m: np.ndarray) -> np.ndarray:
    """Return places in `map`, shape (..., n, k, 2), ahead and to the left of each of n robots [m].

    Args: poses: as of `Percepts`.
    """
    offsets_m, seen_m = places_m - poses[..., None, :2], np.empty(places_m.shape)
    cos, sin = (part[..., None] for part in cos_sin(poses))
    seen_m[..., 0] = cos * offsets_m[..., 0] + sin * offsets_m[..., 1]
    seen_m[..., 1] = cos * offsets_m[..., 1] - sin * offsets_m[..., 0]
    return seen_m


def area_of(task: Task) -> tuple[float, float, float]:
    """Return a row of `Percepts.area`."""
    center_m = task.area_center_m
    return (0.0, 0.0, 0.0) if center_m is None else (1.0, *center_m)


class Memory:
    """What the agents of a mission remember besides messages: nothing. Each mission has a new one.

    A subclass replaces `parts_of` and `after`, and, with `looks`, `look`.
    """

    looks = False
    """Whether `look` is called in each step of the simulation."""

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """Args: setup: of the mission, which has a seed of its own.  robot_ids: of the agents."""
        self.setup, self.robot_ids = setup, tuple(robot_ids)

    @classmethod
    def parts_of(cls, setup: Setup) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part of the numbers."""
        return []

    def look(self, readings: Sequence[RobotReading]) -> None:
        """Note the readings of a step, one per agent: those of most additional sensors are not in every step."""

    def after(self, percepts: Percepts, time_s: float) -> np.ndarray:
        """Return the numbers of each agent at a decision, shape (n, numbers); `Observe.vectors` clips them to [-1, 1].

        Those of absent agents are ignored, but must be finite.

        Args: percepts: without `remembered`.  time_s: of the simulation [s].
        """
        return np.zeros((len(percepts.poses), 0))


class Observe:
    """The vectors of a team's agents, float32, all numbers within [-1, 1]; `parts` names them in order.

    They know only what controllers know: readings, voices, the task, and what teammates have sent. The signal of a
    teammate is predicted by the radio model from both positions, eq. (3); the mission's links are those of the network.
    A subclass replaces `parts_of` and `vectors`, or `remembers`, which may also look at additional sensors.
    """

    remembers: type[Memory] = Memory
    """What agents remember: the last parts of the vectors, `Percepts.remembered`."""

    def __init__(self, setup: Setup, robot_ids: Sequence[int], said: int = 0, teammates: int | None = None) -> None:
        """Args: robot_ids: of the agents.
        said:       how many numbers each message has.
        teammates:  how many there is room for, the first others in id order; None: for all.
        """
        robots, bounds = [setup.robots[i] for i in robot_ids], setup.plan.bounds
        self.setup, self.robot_ids, self.said = setup, tuple(robot_ids), said
        self.teammates = setup.scenario.num_robots - 1 if teammates is None else teammates
        self.beams = max(robot.laser.beams for robot in setup.robots)
        self._low_m, self._extent_m = np.array(bounds.min), np.array(bounds.max) - bounds.min
        self._units = _core.learning.Units(
            range_max_m=[robot.laser.range_max_m for robot in robots],
            max_speed_mps=[robot.drive.max_speed_mps for robot in robots],
            max_turn_radps=[robot.drive.max_turn_radps for robot in robots],
            low_m=bounds.min,
            extent_m=tuple(self._extent_m),
            diagonal_m=math.dist(bounds.min, bounds.max),
            voice_radius_m=setup.scenario.voice.local_best_radius_m + setup.scenario.voice.map_resolution_m,
        )
        radio = shared_radio_field(setup.building, setup.scenario.radio)
        self._radio = radio.core_faces, radio.core_model
        own, remembered = self.parts_of(), self.remembers.parts_of(setup)
        self.parts = tuple(self._placed([*own, *remembered]))
        self.remembered = sum(part.size for part in self.parts[len(own) :])
        """How many numbers each agent remembers."""
        self.space = Box(-1.0, 1.0, (sum(part.size for part in self.parts),), np.float32)

    def parts_of(self) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part but those of the memory, which follow them."""
        teammate = "heard of, x and y from the robot / diagonal, signal (0 to 1), age of the message / 10 s"
        said = f", {self.said} numbers that it said" if self.said else ""
        return [
            ("laser", self.beams, "ranges / range_max_m, from right to left; 1 without a return"),
            ("pose", 4, "x and y in the building from -1 to 1, cosine and sine of the yaw"),
            ("twist", 2, "odometry: speed ahead / max_speed_mps, turn / max_turn_radps"),
            ("voice", 4, "heard, level / 100 dB, x and y of the loudest cell from the robot / radius"),
            ("area", 3, "there is one to explore, x and y of its centre from the robot / diagonal"),
            *((f"teammate_{i}", 5 + self.said, teammate + said) for i in range(self.teammates)),
        ]

    @staticmethod
    def _placed(parts: list[tuple[str, int, str]]) -> list[Part]:
        for name, size, _ in parts:
            if not isinstance(size, int | np.integer) or not 0 <= size <= LARGEST_PART:
                raise LearningError(f"part {name}: {size!r} numbers; expected a whole number from 0 to {LARGEST_PART}")
        begins = np.cumsum([0, *(size for _, size, _ in parts)]).tolist()
        if begins[-1] > LARGEST_VECTOR:
            raise LearningError(f"observation: {begins[-1]} numbers; expected at most {LARGEST_VECTOR}")
        return [Part(name, begin, size, meaning) for begin, (name, size, meaning) in zip(begins, parts, strict=False)]

    def vectors(self, percepts: Percepts) -> np.ndarray:
        """Return the vector of each agent, shape (..., n, size of the space); the same inputs give the same bits.

        Raises: LearningError: parts of percepts have other shapes or types than they should, or a number is NaN.
        """
        try:
            vectors = _core.learning.vectors(self._units, *self._radio, self.said, *percepts)
        except (ValueError, TypeError) as error:
            text = str(error).partition("\n")[0]
            raise LearningError(f"percepts: {text}") from None
        return vectors.reshape(*percepts.poses.shape[:-1], -1)

    def in_bounds(self, places_m: np.ndarray) -> np.ndarray:
        """Return places in `map` [m], shape (..., 2), from -1 to 1 between the bounds of the plan."""
        return np.asarray(2.0 * (places_m - self._low_m) / self._extent_m - 1.0)

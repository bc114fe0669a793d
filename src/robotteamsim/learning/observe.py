"""What the policy of one robot perceives, as one vector."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import msgspec
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import ArrayLike

from robotteamsim.control.driving.own_pose import OwnPose
from robotteamsim.geometry import Pose
from robotteamsim.interface import Message, Observation, Task
from robotteamsim.interface.payload import Point, read_payload, to_payload
from robotteamsim.propagation import shared_radio_field
from robotteamsim.scenario import FloorPlan
from robotteamsim.setup import Setup

LOUDEST_DB = 100.0
"""Voice levels are divided by this."""

WEAKEST_DBM, STRONGEST_DBM = -100.0, -20.0
"""Signals become 0 to 1 between these."""

OLDEST_S = 10.0
"""The age of a message becomes 0 to 1 up to this [s]."""


class Part(NamedTuple):
    """A part of the vector: where it begins, how many numbers it has, and what they mean."""

    name: str
    begin: int
    size: int
    meaning: str


class Said(msgspec.Struct, frozen=True):
    """What robots tell each other: the sender's position in `map` [m], and the numbers of its policy."""

    at: Point
    say: tuple[Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)], ...] = ()

    def to_payload(self) -> str:
        """Return it as the payload of a message."""
        return to_payload(self)


_reader = msgspec.json.Decoder(Said)


class Observe:
    """The vector of one robot, float32, all numbers within [-1, 1]; `parts` names them in order.

    It knows only what a controller knows: readings, voices, the task, and what teammates have sent. The signal of a
    teammate is predicted by the radio model from both positions, eq. (3); the mission's links are those of the network.
    A subclass replaces `parts_of` and `vector`.
    """

    def __init__(self, setup: Setup, robot_id: int, said: int = 0) -> None:
        """Args: said: how many numbers each message has."""
        robot, bounds = setup.robots[robot_id], setup.plan.bounds
        self.setup, self.robot_id, self.said = setup, robot_id, said
        self.teammates = [i for i in range(setup.scenario.num_robots) if i != robot_id]
        """The ids of the other robots, in the order in which they are in the vector."""
        self._laser, self._drive = robot.laser, robot.drive
        self._own_pose = OwnPose(robot_id, setup)
        self._diagonal_m = math.dist(bounds.min, bounds.max)
        self._voice_radius_m = setup.scenario.voice.local_best_radius_m + setup.scenario.voice.map_resolution_m
        self._radio = shared_radio_field(setup.building, setup.scenario.radio)
        self._tx_power_dbm = setup.scenario.radio.tx_power_dbm
        self.parts = tuple(self._placed(self.parts_of()))
        self.space = Box(-1.0, 1.0, (sum(part.size for part in self.parts),), np.float32)
        self._heard: dict[int, tuple[int, Said]] = {}

    def parts_of(self) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part."""
        teammate = "heard of, x and y from the robot / diagonal, signal (0 to 1), age of the message / 10 s"
        said = f", {self.said} numbers that it said" if self.said else ""
        return [
            ("laser", self._laser.beams, "ranges / range_max_m, from right to left; 1 without a return"),
            ("pose", 4, "x and y in the building from -1 to 1, cosine and sine of the yaw"),
            ("twist", 2, "odometry: speed ahead / max_speed_mps, turn / max_turn_radps"),
            ("voice", 4, "heard, level / 100 dB, x and y of the loudest cell from the robot / radius"),
            ("area", 3, "there is one to explore, x and y of its centre from the robot / diagonal"),
            *((f"robot_{i}", 5 + self.said, teammate + said) for i in self.teammates),
        ]

    @staticmethod
    def _placed(parts: list[tuple[str, int, str]]) -> list[Part]:
        begins = np.cumsum([0, *(size for _, size, _ in parts)]).tolist()
        return [Part(name, begin, size, meaning) for begin, (name, size, meaning) in zip(begins, parts, strict=False)]

    def note(self, observation: Observation, inbox: Sequence[Message]) -> None:
        """Remember what teammates say in a step; of messages of other kinds, nothing."""
        for message in inbox:
            said = read_payload(_reader, message.payload)
            if said is not None and len(said.say) == self.said:
                self._heard[message.sender] = observation.sim_time_ns, said

    def vector(self, observation: Observation, task: Task) -> np.ndarray:
        """Return the vector of a step, after `note`; the same inputs give the same bits."""
        robot, voice, pose = observation.robot, observation.voice, self.pose(observation)
        ranges = np.clip(robot.ranges_m / self._laser.range_max_m, 0.0, 1.0)
        x, y = in_bounds(self.setup.plan, (pose.x_m, pose.y_m))
        twist = robot.odometry.twist
        speed, turn = twist.linear_x_mps / self._drive.max_speed_mps, twist.angular_z_radps / self._drive.max_turn_radps
        heard = self._towards(pose, voice.local_best_m, self._voice_radius_m) if voice.heard else (0.0, 0.0)
        area = task.area_center_m
        goal = (0.0, 0.0, 0.0) if area is None else (1.0, *self._towards(pose, area, self._diagonal_m))
        numbers = [
            *(x, y, math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)),
            *(speed, turn),
            *(float(voice.heard), voice.local_best_level_db / LOUDEST_DB, *heard),
            *goal,
        ]
        for teammate in self.teammates:
            numbers += self._teammate(teammate, pose, observation.sim_time_ns)
        return np.concatenate((ranges, np.clip(numbers, -1.0, 1.0)), dtype=np.float32, casting="same_kind")

    def pose(self, observation: Observation) -> Pose:
        """Return the pose in `map` that the robot uses as its own, see `OwnPose`."""
        return self._own_pose.at(observation)

    def _teammate(self, teammate: int, pose: Pose, time_ns: int) -> list[float]:
        if teammate not in self._heard:
            return [0.0] * (5 + self.said)
        then_ns, said = self._heard[teammate]
        signal_dbm = self._tx_power_dbm - self._radio.path_loss_db((pose.x_m, pose.y_m), said.at)
        signal = (signal_dbm - WEAKEST_DBM) / (STRONGEST_DBM - WEAKEST_DBM)
        age = (time_ns - then_ns) * 1e-9 / OLDEST_S
        return [1.0, *self._towards(pose, said.at, self._diagonal_m), max(signal, 0.0), age, *said.say]

    @staticmethod
    def _towards(pose: Pose, place_m: tuple[float, float], unit_m: float) -> tuple[float, float]:
        """Return a place in `map` [m] as x and y in `base_link`, in some unit."""
        seen = pose.inverse() @ Pose(*place_m, 0.0)
        return seen.x_m / unit_m, seen.y_m / unit_m


def in_bounds(plan: FloorPlan, places_m: ArrayLike) -> np.ndarray:
    """Return places in `map` [m], shape (..., 2), from -1 to 1 between the bounds of a plan."""
    low_m, high_m = np.array(plan.bounds.min), np.array(plan.bounds.max)
    return np.asarray(2.0 * (np.asarray(places_m) - low_m) / (high_m - low_m) - 1.0)

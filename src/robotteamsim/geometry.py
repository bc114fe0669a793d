"""Poses, velocities and angles in the plane (REP-103: x forward, y left, yaw counter-clockwise)."""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Iterable

import msgspec
import numpy as np

_LARGEST = sys.float_info.max


def normalise_angle(angle_rad: float) -> float:
    """Return the same direction as an angle in (-pi, pi]."""
    wrapped_rad = math.remainder(angle_rad, math.tau)
    return math.pi if wrapped_rad == -math.pi else wrapped_rad


def path_length_m(points: Iterable[tuple[float, float]]) -> float:
    """Return the length of a path through points [m], added from the first to the last.

    Unlike `sum`, which adds more exactly from Python 3.12 on, it has the same bits in every version.
    """
    length_m = 0.0
    for before, point in itertools.pairwise(points):
        length_m += math.dist(before, point)
    return length_m


def are_finite(*values: object) -> bool:
    """Whether all values are numbers, and none is NaN or infinite."""
    numbers = [value for value in values if isinstance(value, int | float | np.integer | np.floating)]
    return len(numbers) == len(values) and all(-_LARGEST <= number <= _LARGEST for number in numbers)


class Pose(msgspec.Struct, frozen=True):
    """A rigid transform of the plane; `a_T_b @ b_T_c` is `a_T_c`."""

    x_m: float
    y_m: float
    yaw_rad: float

    def __matmul__(self, other: Pose) -> Pose:
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Pose(
            self.x_m + cos * other.x_m - sin * other.y_m,
            self.y_m + sin * other.x_m + cos * other.y_m,
            normalise_angle(self.yaw_rad + other.yaw_rad),
        )

    def inverse(self) -> Pose:
        """Return the transform that undoes this one."""
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Pose(
            -cos * self.x_m - sin * self.y_m,
            sin * self.x_m - cos * self.y_m,
            normalise_angle(-self.yaw_rad),
        )


class PoseReading(msgspec.Struct, frozen=True):
    """A pose in the form of ROS messages: position and the unit quaternion (0, 0, qz, qw).

    Controllers and recorders read all poses in this form, so that headless runs and ROS runs have identical values:
    yaw -> quaternion -> yaw is not exact in floating point.
    """

    x_m: float
    y_m: float
    qz: float
    qw: float

    @classmethod
    def from_pose(cls, pose: Pose) -> PoseReading:
        """Return the reading of a pose; qw >= 0 as yaw lies in (-pi, pi]."""
        half_rad = 0.5 * normalise_angle(pose.yaw_rad)
        return cls(pose.x_m, pose.y_m, math.sin(half_rad), math.cos(half_rad))

    @property
    def pose(self) -> Pose:
        """The pose with its yaw in (-pi, pi]."""
        yaw_rad = 2.0 * math.atan2(self.qz, self.qw)
        return Pose(self.x_m, self.y_m, yaw_rad if -math.pi < yaw_rad <= math.pi else normalise_angle(yaw_rad))


class Twist(msgspec.Struct, frozen=True):
    """A velocity in `base_link`: forward and left [m/s], counter-clockwise [rad/s]."""

    linear_x_mps: float = 0.0
    linear_y_mps: float = 0.0
    angular_z_radps: float = 0.0

    @property
    def is_finite(self) -> bool:
        """Whether no component is NaN or infinite."""
        # NaN and infinity survive a sum.
        return math.isfinite(self.linear_x_mps + self.linear_y_mps + self.angular_z_radps)

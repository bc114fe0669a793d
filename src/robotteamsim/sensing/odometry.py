"""Odometry: what a robot believes of its way from what it really did."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.geometry import Pose, PoseReading, Twist, normalise_angle
from robotteamsim.scenario.sections import Odometry as OdometryModel
from robotteamsim.sensing.readings import OdometryReading

_STEPS_PER_DRAW = 64


class Odometry:
    """One robot's odometry: true motion plus drift, in a frame `odom` that begins where the robot does.

    The drift is that of the odometry motion model [Probabilistic Robotics, Table 5.6]: a motion is a turn, a distance
    and a second turn, each with Gaussian noise of the variances

        turns:    alpha1 turn^2 + alpha2 distance^2
        distance: alpha3 distance^2 + alpha4 (first turn^2 + second turn^2)

    so a robot that stands still, blocked or not, does not drift. Two cases that the model leaves open: a distance is
    negative when the robot drives backwards, as turning round was no part of that; and a robot that is pushed aside
    or slides has turned no more than its body did, whatever the direction it went.
    """

    def __init__(self, model: OdometryModel, step_s: float, generator: np.random.Generator) -> None:
        """Begin at (0, 0, 0). The generator gives three numbers a step, so equal streams give equal drifts."""
        self._alphas = (model.alpha1, model.alpha2, model.alpha3, model.alpha4)
        self._step_s = step_s
        self._generator = generator
        self._noise: list[float] = []
        self._pose = Pose(0.0, 0.0, 0.0)

    def step(self, motion: Pose, twist: Twist) -> OdometryReading:
        """Return the reading after one more step.

        Args: motion: the way of the step, seen from its beginning. twist: its mean velocity, in `base_link`.
        """
        alpha1, alpha2, alpha3, alpha4 = self._alphas
        first_noise, distance_noise, second_noise = self._draw()
        distance_m, heading_rad = _signed_distance(motion)
        turn_rad = twist.angular_z_radps * self._step_s
        rest_rad = turn_rad - heading_rad
        first2 = min(abs(heading_rad), abs(turn_rad)) ** 2
        second2 = min(abs(rest_rad), abs(turn_rad)) ** 2
        distance2 = distance_m * distance_m
        first_error_rad = first_noise * math.sqrt(alpha1 * first2 + alpha2 * distance2)
        distance_error_m = distance_noise * math.sqrt(alpha3 * distance2 + alpha4 * (first2 + second2))
        second_error_rad = second_noise * math.sqrt(alpha1 * second2 + alpha2 * distance2)
        self._move(distance_m + distance_error_m, heading_rad + first_error_rad, rest_rad + second_error_rad)
        return OdometryReading(
            PoseReading.from_pose(self._pose),
            Twist(
                twist.linear_x_mps + distance_error_m / self._step_s,
                twist.linear_y_mps,
                twist.angular_z_radps + (first_error_rad + second_error_rad) / self._step_s,
            ),
        )

    def _move(self, distance_m: float, first_turn_rad: float, second_turn_rad: float) -> None:
        pose = self._pose
        course_rad = pose.yaw_rad + first_turn_rad
        self._pose = Pose(
            pose.x_m + distance_m * math.cos(course_rad),
            pose.y_m + distance_m * math.sin(course_rad),
            normalise_angle(course_rad + second_turn_rad),
        )

    def _draw(self) -> tuple[float, float, float]:
        if not self._noise:
            self._noise = self._generator.standard_normal(3 * _STEPS_PER_DRAW).tolist()
        return self._noise.pop(), self._noise.pop(), self._noise.pop()


def _signed_distance(motion: Pose) -> tuple[float, float]:
    """Return the length of a way [m], below 0 when it went backwards, and its heading in [-pi/2, pi/2]."""
    distance_m = math.hypot(motion.x_m, motion.y_m)
    if motion.x_m < 0.0:
        return -distance_m, math.atan2(-motion.y_m, -motion.x_m)
    return distance_m, math.atan2(motion.y_m, motion.x_m)

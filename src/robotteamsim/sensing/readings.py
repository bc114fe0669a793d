"""What a robot perceives in one step, in the form in which ROS messages carry it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import overload

import msgspec
import numpy as np

from robotteamsim.geometry import PoseReading, Twist


class OdometryReading(msgspec.Struct, frozen=True, gc=False):
    """A pose in `odom` and the twist in `base_link` that the wheels measured.

    pose_covariance: of x, y [m] and yaw [rad], the upper triangle row by row: xx, xy, x yaw, yy, y yaw, yaw yaw.
    twist_variances: of the speeds forward and to the left [m^2/s^2] and of the turn [rad^2/s^2]; to the left it is 0
                     unless the robot is omnidirectional.
    """

    pose: PoseReading
    twist: Twist
    pose_covariance: tuple[float, ...] = (0.0,) * 6
    twist_variances: tuple[float, ...] = (0.0,) * 3


class VoiceReading(msgspec.Struct, frozen=True, gc=False):
    """What a robot hears.

    level_db:            voice level at the robot [dB]; 0 where no voice is above the noise.
    heard:               whether any cell within the local-best radius is above the noise.
    local_best_m:        centre of the loudest cell within the radius, in `map` [m]; the robot itself if not heard.
    local_best_level_db: its level [dB]; 0 if not heard.
    """

    level_db: float
    heard: bool
    local_best_m: tuple[float, float]
    local_best_level_db: float


class Fix(msgspec.Struct, frozen=True, gc=False):
    """A position on the earth by satellite: on the ellipsoid WGS84, with the variance to the east and to the north."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    variance_m2: float


class FurtherReadings(msgspec.Struct, frozen=True, gc=False, eq=False):
    """Readings of the sensors that not every robot has; None of a sensor that has none in this step.

    scans_m:  of `robots.lasers`, in their order: float32, shape (beams,) [m].
    sonars_m: of `robots.sonars`, in their order: float32 [m].
    fix:      of `robots.gps`.
    """

    scans_m: tuple[np.ndarray | None, ...] = ()
    sonars_m: tuple[float, ...] = ()
    fix: Fix | None = None


NOTHING_FURTHER = FurtherReadings()

NOTHING_HEARD = VoiceReading(0.0, False, (math.nan, math.nan), 0.0)
"""The voice reading of a robot that is not there."""


class RobotReading(msgspec.Struct, frozen=True, gc=False, eq=False):
    """What the world gives one robot in one step.

    ranges_m: float32, shape (beams,), first beam at angle_min; no return as the scenario says.
    contact_angles_rad: directions of contacts from base_link, ascending in (-pi, pi].
    further:  of sensors that not every robot has.
    """

    ground_truth: PoseReading
    twist: Twist
    odometry: OdometryReading
    ranges_m: np.ndarray
    in_contact: bool
    contact_angles_rad: tuple[float, ...] = ()
    further: FurtherReadings = NOTHING_FURTHER


# Not frozen: it keeps the records that `one_by_one` makes.
@dataclass(slots=True, eq=False)
class TeamReadings(Sequence[RobotReading]):
    """The readings of all robots in one step, in id order: as arrays, or one by one.

    ground_truth: float64, shape (n, 4): x, y [m], qz, qw in `map`; NaN of a robot that is not there, whose other
                  readings mean nothing.
    positions_m:  float64, shape (n, 2): x, y of the same.
    twists:       float64, shape (n, 3): forward, left [m/s], counter-clockwise [rad/s] in `base_link`.
    odometry:     float64, shape (n, 16): x, y [m], qz, qw in `odom`, the twist that the wheels measured, then the
                  covariances of `OdometryReading`, six and three.
    ranges_m:     float32 per robot, shape (beams,) [m].
    in_contact:   bool, shape (n,).
    contact_angles_rad: of those that touch something, by their ids.
    further:      of sensors that not every robot has; empty where none has any.
    """

    ground_truth: np.ndarray
    positions_m: np.ndarray
    twists: np.ndarray
    odometry: np.ndarray
    ranges_m: Sequence[np.ndarray] | np.ndarray
    in_contact: np.ndarray
    contact_angles_rad: Mapping[int, tuple[float, ...]] = field(default_factory=dict)
    further: Sequence[FurtherReadings] = ()
    _readings: tuple[RobotReading, ...] = field(default=(), init=False, repr=False)

    def __len__(self) -> int:
        return len(self.ranges_m)

    @overload
    def __getitem__(self, index: int) -> RobotReading: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[RobotReading]: ...
    def __getitem__(self, index: int | slice) -> RobotReading | Sequence[RobotReading]:
        return self.one_by_one()[index]

    def __iter__(self) -> Iterator[RobotReading]:
        return iter(self.one_by_one())

    def one_by_one(self) -> tuple[RobotReading, ...]:
        """Return the readings as records, which are made on the first call.

        Raises: ValueError: the arrays have different lengths.
        """
        if not self._readings:
            further = self.further or [NOTHING_FURTHER] * len(self)
            rows = zip(
                self.ground_truth.tolist(),
                self.twists.tolist(),
                self.odometry.tolist(),
                self.ranges_m,
                self.in_contact.tolist(),
                further,
                strict=True,
            )
            readings = []
            for robot_id, (truth, twist, odometry, ranges_m, in_contact, rest) in enumerate(rows):
                angles_rad = self.contact_angles_rad.get(robot_id, ()) if in_contact else ()
                readings.append(
                    RobotReading(
                        PoseReading(*truth),
                        Twist(*twist),
                        _odometry_reading(odometry),
                        ranges_m,
                        in_contact,
                        angles_rad,
                        rest,
                    )
                )
            self._readings = tuple(readings)
        return self._readings


def _odometry_reading(row: list[float]) -> OdometryReading:
    return OdometryReading(PoseReading(*row[:4]), Twist(*row[4:7]), tuple(row[7:13]), tuple(row[13:]))


def ground_truth_rows(readings: Sequence[RobotReading]) -> np.ndarray:
    """Return the true poses as `TeamReadings` has them: float64, shape (n, 4)."""
    if isinstance(readings, TeamReadings):
        return readings.ground_truth
    rows = [pose_row(reading.ground_truth) for reading in readings]
    return np.array(rows, dtype=np.float64).reshape(-1, 4)


def pose_row(pose: PoseReading) -> tuple[float, float, float, float]:
    """Return a pose as a row of `TeamReadings.ground_truth`."""
    return pose.x_m, pose.y_m, pose.qz, pose.qw


def contact_flags(readings: Sequence[RobotReading]) -> np.ndarray:
    """Return whether each robot touches something, as `TeamReadings` has it: bool, shape (n,)."""
    if isinstance(readings, TeamReadings):
        return readings.in_contact
    return np.array([reading.in_contact for reading in readings], dtype=bool)


_NOWHERE = PoseReading(math.nan, math.nan, math.nan, math.nan)

NOT_THERE = RobotReading(_NOWHERE, Twist(), OdometryReading(_NOWHERE, Twist()), np.zeros(0, np.float32), False)
"""The reading of a robot that is not there."""

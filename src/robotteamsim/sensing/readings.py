"""The readings of a robot's sensors in one step, in the form in which ROS messages carry them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import repeat
from typing import overload

import msgspec
import numpy as np
from msgspec.structs import astuple

from robotteamsim.geometry import Pose, PoseReading, Twist, pose_of


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
    """A position by satellite on the ellipsoid WGS84, with its variance to the east and to the north."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    variance_m2: float


class HeatReading(msgspec.Struct, frozen=True, gc=False):
    """What a thermal camera measures.

    temperature_c: of the air at the robot [degC].
    hot_m:         centres of the hot places in sight, in `map` [m].
    """

    temperature_c: float
    hot_m: tuple[tuple[float, float], ...] = ()


class FurtherReadings(msgspec.Struct, frozen=True, gc=False, eq=False):
    """Readings of sensors that only some robots have; None for a sensor without a reading in this step.

    scans_m:  of `robots.lasers`, in their order: float32, shape (beams,) [m].
    sonars_m: of `robots.sonars`, in their order: float32 [m].
    fix:      of `robots.gps`.
    images:   of `robots.cameras`, in their order: uint8, shape (height, width, 3), red, green, blue; or, of depth
              cameras, float32, shape (height, width) [m].
    lights_lx: of `robots.light_sensors`, in their order [lx].
    heat:     of `robots.heat`, in the steps in which fire and smoke advance.
    """

    scans_m: tuple[np.ndarray | None, ...] = ()
    sonars_m: tuple[float, ...] = ()
    fix: Fix | None = None
    images: tuple[np.ndarray | None, ...] = ()
    lights_lx: tuple[float, ...] = ()
    heat: HeatReading | None = None


NOTHING_FURTHER = FurtherReadings()

NOTHING_HEARD = VoiceReading(0.0, False, (math.nan, math.nan), 0.0)
"""The voice reading of an absent robot."""


ROW_LENGTH = 24
"""Numbers in a row of `TeamReadings.rows`."""


class RobotReading(msgspec.Struct, frozen=True, gc=False, eq=False):
    """What one robot measures in one step.

    row:      pose, velocity, odometry and contact as a row of `TeamReadings.rows`; the properties decode it.
    ranges_m: float32, shape (beams,), first beam at angle_min; no return as the scenario defines it.
    contact_angles_rad: directions of contacts from base_link, ascending in (-pi, pi].
    further:  of sensors that only some robots have.
    """

    row: Sequence[float]
    ranges_m: np.ndarray
    contact_angles_rad: tuple[float, ...] = ()
    further: FurtherReadings = NOTHING_FURTHER

    @classmethod
    def of(
        cls,
        ground_truth: PoseReading,
        twist: Twist,
        odometry: OdometryReading,
        ranges_m: np.ndarray,
        in_contact: bool,
        contact_angles_rad: tuple[float, ...] = (),
        further: FurtherReadings = NOTHING_FURTHER,
    ) -> RobotReading:
        """Return the reading that consists of these parts."""
        row = (
            *astuple(ground_truth),
            *astuple(twist),
            *astuple(odometry.pose),
            *astuple(odometry.twist),
            *odometry.pose_covariance,
            *odometry.twist_variances,
            float(in_contact),
        )
        return cls(row, ranges_m, contact_angles_rad, further)

    @property
    def ground_truth(self) -> PoseReading:
        """The true pose in `map`; NaN for an absent robot, whose other readings mean nothing."""
        return PoseReading(*self.row[:4])

    @property
    def true_pose(self) -> Pose:
        """The true pose in `map` with its yaw in (-pi, pi]."""
        x_m, y_m, qz, qw = self.row[:4]
        return pose_of(x_m, y_m, qz, qw)

    @property
    def twist(self) -> Twist:
        """The true velocity in `base_link`."""
        return Twist(*self.row[4:7])

    @property
    def odometry(self) -> OdometryReading:
        """The pose and the velocity that the wheels measured."""
        row = self.row
        return OdometryReading(PoseReading(*row[7:11]), Twist(*row[11:14]), tuple(row[14:20]), tuple(row[20:23]))

    @property
    def in_contact(self) -> bool:
        """Whether the robot touches something."""
        return self.row[23] > 0.0


# Not frozen: it keeps the records that `one_by_one` makes.
@dataclass(slots=True, eq=False)
class TeamReadings(Sequence[RobotReading]):
    """The readings of all robots in one step, in id order: as arrays, or one by one.

    rows:     float64, shape (n, 24). Columns: the true pose x, y [m], qz, qw in `map`; the true velocity forward, left
              [m/s], counter-clockwise [rad/s] in `base_link`; the pose in `odom` and the velocity that the wheels
              measured; the covariances of `OdometryReading`, six and three; 1 for a robot that touches something.
              An absent robot's true pose is NaN, and its other readings mean nothing.
    ranges_m: float32 per robot, shape (beams,) [m].
    contact_angles_rad: of the robots that touch something, by id.
    further:  of sensors that only some robots have; empty if no robot has any.
    """

    rows: np.ndarray
    ranges_m: Sequence[np.ndarray] | np.ndarray
    contact_angles_rad: Mapping[int, tuple[float, ...]] = field(default_factory=dict)
    further: Sequence[FurtherReadings] = ()
    _readings: tuple[RobotReading, ...] = field(default=(), init=False, repr=False)

    @property
    def ground_truth(self) -> np.ndarray:
        """The true poses, shape (n, 4)."""
        return self.rows[:, :4]

    @property
    def positions_m(self) -> np.ndarray:
        """The true positions in `map`, C-contiguous, shape (n, 2) [m]."""
        return np.ascontiguousarray(self.rows[:, :2])

    @property
    def twists(self) -> np.ndarray:
        """The true velocities, shape (n, 3)."""
        return self.rows[:, 4:7]

    @property
    def odometry(self) -> np.ndarray:
        """The readings of the odometry, shape (n, 16)."""
        return self.rows[:, 7:23]

    @property
    def in_contact(self) -> np.ndarray:
        """Whether each robot touches something, bool, shape (n,)."""
        return self.rows[:, 23] > 0.0

    def __len__(self) -> int:
        return len(self.rows)

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
            rows, angles = self.rows.tolist(), self.contact_angles_rad
            n, further = len(rows), self.further or (NOTHING_FURTHER,) * len(rows)
            if len(self.ranges_m) != n or len(further) != n:
                raise ValueError(f"{n} rows, {len(self.ranges_m)} scans and {len(further)} further readings")
            angles_rad = [angles.get(robot_id, ()) for robot_id in range(n)] if angles else repeat((), n)
            self._readings = tuple(map(RobotReading, rows, self.ranges_m, angles_rad, further))
        return self._readings


def reading_rows(readings: Sequence[RobotReading]) -> np.ndarray:
    """Return the readings as `TeamReadings.rows`: float64, shape (n, 24)."""
    if isinstance(readings, TeamReadings):
        return readings.rows
    return np.array([reading.row for reading in readings], dtype=np.float64).reshape(-1, ROW_LENGTH)


_NOWHERE = PoseReading(math.nan, math.nan, math.nan, math.nan)

NOT_THERE = RobotReading.of(_NOWHERE, Twist(), OdometryReading(_NOWHERE, Twist()), np.zeros(0, np.float32), False)
"""The reading of an absent robot."""

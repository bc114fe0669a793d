"""Odometry and scans as nodes of this package hear them: only what they need is read of the bytes.

genpy makes a dozen objects of an Odometry and hundreds of a LaserScan, for each robot in each step. To rospy and to
publishers these are messages of the usual types.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

import nav_msgs.msg
import numpy as np
import sensor_msgs.msg

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import OdometryReading

_ODOMETRY = struct.Struct("<85d")
"""Position, orientation, covariance of both; velocity, turning, covariance of both."""
_LIMITS_OF_SCAN = struct.Struct("<7f")
_COUNT = struct.Struct("<I")
_HEADER = struct.Struct("<4I")


class Stamp(NamedTuple):
    """A time as in a header [s, ns]."""

    secs: int
    nsecs: int


class BareHeader(NamedTuple):
    """A header without frame."""

    stamp: Stamp


class PlanarOdometry(nav_msgs.msg.Odometry):  # type: ignore[misc]
    """nav_msgs/Odometry of a robot on a floor; `reading` has what it tells, without height, roll and pitch."""

    reading: OdometryReading

    def __init__(self) -> None:
        """Nothing is told yet; the fields of the usual message are never filled in."""

    def deserialize(self, data: bytes) -> PlanarOdometry:
        """Read the bytes of a message. Raises: struct.error: they are too few."""
        self.header, start = _header(data)
        (length,) = _COUNT.unpack_from(data, start)  # of child_frame_id
        v = _ODOMETRY.unpack_from(data, start + 4 + length)
        self.reading = OdometryReading(
            PoseReading(v[0], v[1], v[5], v[6]),
            Twist(v[43], v[44], v[48]),
            pose_covariance=(v[7], v[8], v[12], v[14], v[18], v[42]),
            twist_variances=(v[49], v[56], v[84]),
        )
        return self


class BareScan(sensor_msgs.msg.LaserScan):  # type: ignore[misc]
    """sensor_msgs/LaserScan of which only the ranges are read, as float32 of shape (beams,) [m]."""

    ranges: np.ndarray

    def __init__(self) -> None:
        """Nothing is told yet; but for `ranges`, the fields of the usual message are never filled in."""

    def deserialize(self, data: bytes) -> BareScan:
        """Read the bytes of a message. Raises: struct.error, ValueError: they are too few."""
        self.header, start = _header(data)
        start += _LIMITS_OF_SCAN.size
        (count,) = _COUNT.unpack_from(data, start)
        self.ranges = np.frombuffer(data, "<f4", count, start + _COUNT.size).astype(np.float32)
        return self


def _header(data: bytes) -> tuple[BareHeader, int]:
    """Return the header that a message begins with, and where it ends."""
    _, secs, nsecs, length = _HEADER.unpack_from(data)
    return BareHeader(Stamp(secs, nsecs)), _HEADER.size + length

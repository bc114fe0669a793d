from __future__ import annotations

import struct
from io import BytesIO

import genpy
import numpy as np
import pytest
from geometry_msgs.msg import Point, Quaternion, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header

from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.quick_messages import BareScan, PlanarOdometry

STAMP = genpy.Time(12, 345_678_901)


def serialized(message) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


@pytest.fixture(params=["", "robot_7/odom", "ä/odom"])
def odometry(request) -> Odometry:
    """An odometry in which every number is another one without a short binary form."""
    numbers = iter((np.arange(1.0, 86.0) / 7.0).tolist())
    message = Odometry(header=Header(seq=3, stamp=STAMP, frame_id=request.param), child_frame_id=f"{request.param}x")
    pose, twist = message.pose.pose, message.twist.twist
    pose.position = Point(next(numbers), next(numbers), next(numbers))
    pose.orientation = Quaternion(*(next(numbers) for _ in range(4)))
    message.pose.covariance = [next(numbers) for _ in range(36)]
    twist.linear, twist.angular = (Vector3(next(numbers), next(numbers), next(numbers)) for _ in range(2))
    message.twist.covariance = [next(numbers) for _ in range(36)]
    return message


def test_odometry_is_read_as_from_the_usual_message(odometry):
    quick = PlanarOdometry().deserialize(serialized(odometry))
    assert quick.reading == conversion.odometry_reading(odometry)
    assert conversion.stamp_ns(quick) == STAMP.to_nsec()


@pytest.mark.parametrize("intensities", [[], [1.0, 2.0, 3.0]])
def test_scan_is_read_as_from_the_usual_message(intensities):
    header = Header(seq=3, stamp=STAMP, frame_id="robot_7/base_laser_link")
    scan = LaserScan(header=header, range_max=8.0, ranges=[0.1, float("inf"), 1.0 / 3.0], intensities=intensities)
    quick = BareScan().deserialize(serialized(scan))
    ranges_m = conversion.ranges_m(quick)
    assert ranges_m.dtype == np.float32
    np.testing.assert_array_equal(ranges_m, np.asarray(scan.ranges, dtype=np.float32))
    ranges_m[0] = 0.0  # a controller may write into it
    assert conversion.stamp_ns(quick) == STAMP.to_nsec()


def test_scan_without_beams_is_read():
    assert len(BareScan().deserialize(serialized(LaserScan())).ranges) == 0


def test_bytes_that_are_too_few_are_refused(odometry):
    for message, quick in ((odometry, PlanarOdometry), (LaserScan(ranges=[1.0, 2.0]), BareScan)):
        data = serialized(message)
        for length in (3, 10, 20, len(data) - 8):
            with pytest.raises((struct.error, ValueError)):
                quick().deserialize(data[:length])


def test_publishers_see_the_usual_types():
    for quick, usual in ((PlanarOdometry, Odometry), (BareScan, LaserScan)):
        assert (quick._type, quick._md5sum) == (usual._type, usual._md5sum)

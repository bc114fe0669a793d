import math

import numpy as np
import pytest
from sensor_msgs.msg import LaserScan

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.laser import IN_FRONT_M, ScanView, cloud, scan_points_m
from robotteamsim.ros.scene.team import robot_colour

ORIGIN = Pose(0.0, 0.0, 0.0)


def scan(ranges_m, *, robot_id=0, laser=ORIGIN):
    message = LaserScan(angle_min=-math.pi / 2, angle_increment=math.pi / 2, range_min=0.05, range_max=5.0)
    message.ranges = ranges_m
    return ScanView(robot_id, laser, 0.25, message)


def test_points_lie_along_the_beams_in_the_map_frame():
    points_m = scan_points_m(scan(np.array([1.0, 2.0, 3.0]) + IN_FRONT_M, laser=Pose(10.0, 20.0, math.pi / 2)))
    assert points_m == pytest.approx(np.array([[11.0, 20.0], [10.0, 22.0], [7.0, 20.0]]))


@pytest.mark.parametrize("nothing_m", [5.0, math.inf, math.nan, 0.0])
def test_beam_without_return_gives_no_point(nothing_m):
    assert len(scan_points_m(scan([1.0, nothing_m, 1.0]))) == 2


def test_cloud_holds_all_points_in_their_robots_colours():
    message = cloud([scan([1.0, 1.0, 1.0]), scan([5.0, 2.0, 5.0], robot_id=1)])
    assert message.header.frame_id == "map"
    assert (message.width, message.height, len(message.data)) == (4, 1, 4 * message.point_step)
    values = np.frombuffer(message.data, dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")])
    assert values["z"] == pytest.approx([0.25] * 4)
    red, green, blue = (round(255 * part) for part in robot_colour(1)[:3])
    assert values["rgb"][3] == red << 16 | green << 8 | blue
    assert values["rgb"][0] != values["rgb"][3]


def test_cloud_of_nothing_is_empty():
    assert cloud([]).width == 0

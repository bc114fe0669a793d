import math

import numpy as np
import pytest
from geometry_msgs.msg import Point
from visualization_msgs.msg import Marker

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.objects import RIM_M, covered, object_markers
from robotteamsim.scenario.objects import MovableObject

CRATE = MovableObject(name="crate", size_m=(0.6, 0.4), height_m=0.5, pose=(0.0, 0.0, 0.0))
DRUM = MovableObject(name="drum", kind="barrel", radius_m=0.3, height_m=0.9, pose=(0.0, 2.0, 0.0))


def above_ground(item):
    points = np.array([(point.x, point.y, point.z) for point in item.points])
    return points[points[:, 2] > 0.1]


def test_objects_are_drawn_to_scale_where_they_are():
    box, barrel = object_markers([CRATE, DRUM], [Pose(1.0, 2.0, math.pi / 2), Pose(3.0, 4.0, 0.0)]).markers
    assert (box.id, barrel.id, box.header.frame_id) == (0, 1, "map")
    assert above_ground(box).max(axis=0) == pytest.approx((0.3, 0.2, 0.5), abs=RIM_M + 1e-9)
    assert above_ground(box).min(axis=0)[:2] == pytest.approx((-0.3, -0.2))
    assert above_ground(barrel).max(axis=0) == pytest.approx((0.3, 0.3, 0.9), abs=2 * RIM_M)
    assert (box.pose.position.x, box.pose.position.y, box.pose.position.z) == (1.0, 2.0, 0.0)
    assert box.pose.orientation.z == pytest.approx(math.sqrt(0.5))
    assert (barrel.pose.position.x, barrel.pose.position.y) == (3.0, 4.0)


def test_each_corner_has_a_colour_and_nothing_is_see_through():
    for item in object_markers([CRATE, DRUM], [Pose(0.0, 0.0, 0.0)] * 2).markers:
        assert len(item.points) == len(item.colors) > 0
        assert {tint.a for tint in item.colors} == {1.0}


def test_equal_objects_stand_at_places_of_their_own():
    first, second = object_markers([CRATE, CRATE], [Pose(1.0, 0.0, 0.0), Pose(2.0, 0.0, 0.0)]).markers
    assert (first.pose.position.x, second.pose.position.x) == (1.0, 2.0)


def test_objects_that_are_gone_are_cleared_away():
    (clearing,) = object_markers((), (), replace=True).markers
    assert clearing.action == Marker.DELETEALL
    assert object_markers((), ()).markers == []


def test_object_as_high_as_the_camera_covers_a_finite_part_of_the_floor():
    at_eye, above = (Marker(points=[Point(x=0.5, z=z)]) for z in (20.0, 1e6))
    for drawn in (at_eye, above):
        assert math.isfinite(covered([drawn], (10.0, -5.0, 20.0)).area)

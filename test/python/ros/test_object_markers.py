from __future__ import annotations

import math

import pytest
from visualization_msgs.msg import Marker

from robotteamsim.geometry import Pose
from robotteamsim.nodes.objects import object_markers
from robotteamsim.ros.messages import RosTypes
from robotteamsim.scenario.objects import MovableObject

CRATE = MovableObject(name="crate", size_m=(0.6, 0.4), height_m=0.5, pose=(0.0, 0.0, 0.0))
DRUM = MovableObject(name="drum", kind="barrel", radius_m=0.3, height_m=0.9, pose=(0.0, 2.0, 0.0))


def test_objects_are_drawn_to_scale_where_they_are():
    box, barrel = object_markers(RosTypes(), [CRATE, DRUM], [Pose(1.0, 2.0, math.pi / 2), Pose(3.0, 4.0, 0.0)]).markers
    assert (box.type, box.id, box.header.frame_id) == (Marker.CUBE, 0, "map")
    assert (box.scale.x, box.scale.y, box.scale.z) == (0.6, 0.4, 0.5)
    assert (box.pose.position.x, box.pose.position.y, box.pose.position.z) == (1.0, 2.0, 0.25)
    assert box.pose.orientation.z == pytest.approx(math.sqrt(0.5))
    assert (barrel.type, barrel.id) == (Marker.CYLINDER, 1)
    assert (barrel.scale.x, barrel.scale.y, barrel.scale.z) == (0.6, 0.6, 0.9)
    assert (barrel.pose.position.x, barrel.pose.position.y) == (3.0, 4.0)


def test_objects_that_are_gone_are_cleared_away():
    (clearing,) = object_markers(RosTypes(), (), (), replace=True).markers
    assert clearing.action == Marker.DELETEALL
    assert object_markers(RosTypes(), (), ()).markers == []

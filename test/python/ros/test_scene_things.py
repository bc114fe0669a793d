import math

import pytest
from visualization_msgs.msg import Marker

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene_things import thing_markers
from robotteamsim.scenario.things import Thing

CRATE = Thing(name="crate", size_m=(0.6, 0.4), height_m=0.5, pose=(0.0, 0.0, 0.0))
DRUM = Thing(name="drum", kind="barrel", radius_m=0.3, height_m=0.9, pose=(0.0, 2.0, 0.0))


def test_things_are_drawn_to_scale_where_they_are():
    box, barrel = thing_markers([CRATE, DRUM], [Pose(1.0, 2.0, math.pi / 2), Pose(3.0, 4.0, 0.0)]).markers
    assert (box.type, barrel.type) == (Marker.CUBE, Marker.CYLINDER)
    assert (box.id, barrel.id, box.header.frame_id) == (0, 1, "map")
    assert (box.scale.x, box.scale.y, box.scale.z, box.pose.position.z) == pytest.approx((0.6, 0.4, 0.5, 0.25))
    assert (barrel.scale.x, barrel.scale.y, barrel.scale.z) == pytest.approx((0.6, 0.6, 0.9))
    assert box.pose.orientation.z == pytest.approx(math.sqrt(0.5))
    assert (barrel.pose.position.x, barrel.pose.position.y) == (3.0, 4.0)

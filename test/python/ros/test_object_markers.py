from __future__ import annotations

import math

import pytest
from visualization_msgs.msg import Marker

from robotteamsim.geometry import Pose
from robotteamsim.recording.bag_types import message_type
from robotteamsim.recording.topics.markers import ARRAY
from robotteamsim.recording.topics.world import objects, read_objects
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.world.contract import NO_OBJECTS, ObjectStates

CRATE = MovableObject(name="crate", size_m=(0.6, 0.4), height_m=0.5, pose=(0.0, 0.0, 0.0))
DRUM = MovableObject(name="drum", kind="barrel", radius_m=0.3, height_m=0.9, pose=(0.0, 2.0, 0.0))


PLACED = ObjectStates((CRATE, DRUM), (Pose(1.0, 2.0, math.pi / 2), Pose(3.0, 4.0, 0.0)))


def sent(message):
    return message_type(ARRAY).decode(message_type(ARRAY).encode(message))


def test_objects_are_drawn_to_scale_where_they_are():
    box, barrel = sent(objects(0, PLACED)).markers
    assert (box.type, box.id, box.header.frame_id, box.text) == (Marker.CUBE, 0, "map", "crate")
    assert (box.scale.x, box.scale.y, box.scale.z) == (0.6, 0.4, 0.5)
    assert (box.pose.position.x, box.pose.position.y, box.pose.position.z) == (1.0, 2.0, 0.25)
    assert box.pose.orientation.z == pytest.approx(math.sqrt(0.5))
    assert (barrel.type, barrel.id) == (Marker.CYLINDER, 1)
    assert (barrel.scale.x, barrel.scale.y, barrel.scale.z) == (0.6, 0.6, 0.9)
    assert (barrel.pose.position.x, barrel.pose.position.y) == (3.0, 4.0)


def test_objects_that_are_gone_are_cleared_away():
    (clearing,) = sent(objects(0, NO_OBJECTS, replace=True)).markers
    assert clearing.action == Marker.DELETEALL
    assert sent(objects(0, NO_OBJECTS)).markers == []


def test_objects_are_read_as_they_were_written():
    found = read_objects(sent(objects(0, PLACED, replace=True)))
    assert [(obj.name, obj.size_m, obj.radius_m, obj.height_m) for obj in found.models] == [
        ("crate", (0.6, 0.4), None, 0.5),
        ("drum", None, 0.3, 0.9),
    ]
    for pose, expected in zip(found.poses, PLACED.poses, strict=True):
        assert (pose.x_m, pose.y_m) == (expected.x_m, expected.y_m)
        assert pose.yaw_rad == pytest.approx(expected.yaw_rad)


@pytest.mark.parametrize("change", [{"x": math.nan}, {"y": math.inf}])
def test_object_at_no_place_is_refused(change):
    message = sent(objects(0, PLACED))
    for name, value in change.items():
        setattr(message.markers[0].pose.position, name, value)
    with pytest.raises(ValueError, match=r"^object: "):
        read_objects(message)

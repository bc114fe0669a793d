"""Places of frames from messages of /tf and /tf_static, with a node that is not one of ROS."""

from __future__ import annotations

import math

import pytest

from robotteamsim.message_parts import header
from robotteamsim.nodes.transforms import Transforms
from robotteamsim.recording.bag_types import message_type

S = 10**9


class Node:
    """Passes messages on as they are."""

    def __init__(self):
        self.receivers = {}

    def listen(self, topic, type_name, receive, **_):
        self.receivers[topic] = receive

    def read(self, type_name, data):
        return 0, message_type(type_name).decode(data)


@pytest.fixture
def node():
    return Node()


@pytest.fixture
def transforms(node):
    return Transforms(node)


def send(node, topic, parent, child, *, time_ns=0, at=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0, 1.0)):
    place, rotation = (dict(zip("xyzw", numbers, strict=False)) for numbers in (at, turn))
    transform = {"translation": place, "rotation": rotation}
    link = {"header": header(time_ns, parent), "child_frame_id": child, "transform": transform}
    type_name = "tf2_msgs/TFMessage"
    node.receivers[topic](message_type(type_name).encode({"transforms": [link]}))


def yawed(yaw_rad):
    return (0.0, 0.0, math.sin(yaw_rad / 2.0), math.cos(yaw_rad / 2.0))


def test_place_is_composed_of_the_transforms_on_the_way_and_has_their_oldest_stamp(node, transforms):
    send(node, "/tf", "map", "odom", time_ns=5 * S, at=(1.0, 2.0, 0.0), turn=yawed(math.pi / 2.0))
    send(node, "/tf", "odom", "base_footprint", time_ns=4 * S, at=(3.0, 0.0, 0.0), turn=yawed(math.pi / 4.0))
    send(node, "/tf_static", "base_footprint", "base_link", time_ns=1 * S, at=(0.0, 0.0, 0.3))
    (stamp_ns, *place), reason = transforms.newest("map", "base_link")
    assert (stamp_ns, reason) == (4 * S, "")
    assert place == pytest.approx([1.0, 5.0, 0.75 * math.pi])


def test_inclined_frame_on_the_way_turns_those_below_it(node, transforms):
    half = math.sqrt(0.5)
    send(node, "/tf_static", "map", "ramp", turn=(0.0, half, 0.0, half))  # 90 degrees about y: x points down
    send(node, "/tf_static", "ramp", "base_link", at=(1.0, 0.0, 2.0))
    assert transforms.newest("map", "base_link")[0][1:3] == pytest.approx((2.0, 0.0))


def test_static_place_has_stamp_0(node, transforms):
    send(node, "/tf_static", "map", "odom", time_ns=9 * S)
    assert transforms.newest("map", "odom") == ((0, 0.0, 0.0, 0.0), "")


def test_last_transform_counts_even_if_time_has_jumped_back(node, transforms):
    send(node, "/tf", "map", "odom", time_ns=9 * S)
    send(node, "/tf", "/map", "/odom", time_ns=1 * S, at=(2.0, 0.0, 0.0))
    assert transforms.newest("map", "odom")[0] == (1 * S, 2.0, 0.0, 0.0)


def test_missing_transform_is_named_and_a_cycle_is_noticed(node, transforms):
    send(node, "/tf", "odom", "base_link")
    assert transforms.newest("map", "base_link") == (None, "no transform leads to odom")
    send(node, "/tf", "base_link", "odom")
    assert transforms.newest("map", "base_link") == (None, "the transforms to base_link are a cycle")


def test_only_static_transforms_are_remembered(node, transforms):
    send(node, "/tf_static", "map", "odom")
    send(node, "/tf", "odom", "base_link", time_ns=S)
    transforms.clear()
    assert transforms.newest("map", "odom")[0] is not None
    assert transforms.newest("map", "base_link") == (None, "no transform leads to base_link")


@pytest.mark.parametrize(
    ("names", "numbers", "reason"),
    [
        (("map", "odom"), {"at": (math.nan, 0.0, 0.0)}, "map -> odom: expected finite numbers"),
        (("map", "odom"), {"turn": (0.0, 0.0, 0.0, 0.0)}, "map -> odom: expected finite numbers and a quaternion"),
        (("map", "odom"), {"turn": (0.0, 0.0, 0.0, math.nan)}, "map -> odom: expected finite numbers and a quaternion"),
        (("map", "map"), {}, "'map' -> 'map': expected the names of two frames"),
        (("", "odom"), {}, "'' -> 'odom': expected the names of two frames"),
    ],
)
def test_wrong_transforms_are_ignored_with_one_warning(node, transforms, caplog, names, numbers, reason):
    for _ in range(2):
        send(node, "/tf", *names, **numbers)
    assert transforms.newest("map", "odom")[0] is None
    (warning,) = caplog.messages
    assert warning.startswith(f"/tf: ignoring messages that cannot be read: {reason}")

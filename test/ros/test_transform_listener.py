"""The newest transforms of /tf and /tf_static, over roscpp."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator

import pytest
import rospy
from geometry_msgs.msg import TransformStamped
from peers import master, wait_until
from tf2_msgs.msg import TFMessage

from robotteamsim import _ros_transport as roscpp
from robotteamsim.ros.transport.topics import Output

# rosgraph leaves its sockets to the garbage collector.
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module", autouse=True)
def ros(tmp_path_factory) -> Iterator[None]:
    """A master, with this process as a node of roscpp."""
    with master(tmp_path_factory.mktemp("transforms")):
        roscpp.start_node("transform_test", ["test"])
        yield
        roscpp.shut_down()
    gc.collect()  # while its warnings are ignored


def transform(parent: str, child: str, stamp_s: float, place: tuple[float, float, float]) -> TransformStamped:
    """Return a transform whose place is x, y [m] and yaw [rad]."""
    x_m, y_m, yaw_rad = place
    link = TransformStamped(child_frame_id=child)
    link.header.frame_id, link.header.stamp = parent, rospy.Time.from_sec(stamp_s)
    link.transform.translation.x, link.transform.translation.y = x_m, y_m
    link.transform.rotation.z, link.transform.rotation.w = math.sin(yaw_rad / 2.0), math.cos(yaw_rad / 2.0)
    return link


def test_newest_transform_is_composed_of_moving_and_static_ones_until_time_jumps_back():
    listener = roscpp.TransformListener()
    moving = Output("/tf", TFMessage, latched=True)
    static = Output("/tf_static", TFMessage, latched=True)
    static.publish(TFMessage([transform("r/base_footprint", "r/base_link", 0.0, (1.0, 0.0, 0.0))]))
    pose, reason = listener.newest("map", "r/base_link")
    assert pose is None
    assert "map" in reason or "r/base_link" in reason

    def sent(stamp_s: float, y_m: float) -> tuple[int, ...] | None:
        """Publish a transform, and return the newest one as soon as it has that stamp."""
        moving.publish(TFMessage([transform("map", "r/base_footprint", stamp_s, (2.0, y_m, math.pi / 2.0))]))
        stamp_ns = round(stamp_s * 1e9)
        wait_until(lambda: (listener.newest("map", "r/base_link")[0] or (-1,))[0] == stamp_ns, f"tf at {stamp_s} s")
        return listener.newest("map", "r/base_link")[0]

    # One metre ahead of a footprint that looks along y.
    assert sent(100.0, 3.0) == pytest.approx((100 * 10**9, 2.0, 4.0, math.pi / 2.0))
    listener.clear()
    assert sent(1.0, 5.0) == pytest.approx((10**9, 2.0, 6.0, math.pi / 2.0))


def test_transform_of_static_frames_has_stamp_0():
    listener = roscpp.TransformListener()
    static = Output("/tf_static", TFMessage, latched=True)
    static.publish(TFMessage([transform("map", "fixed/base_link", 7.0, (3.0, 4.0, 0.0))]))
    wait_until(lambda: listener.newest("map", "fixed/base_link")[0] is not None, "the transform")
    assert listener.newest("map", "fixed/base_link") == ((0, 3.0, 4.0, 0.0), "")

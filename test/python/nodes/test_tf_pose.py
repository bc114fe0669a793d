"""Poses of robots from tf, with a table of transforms instead of tf's buffer."""

from __future__ import annotations

import math

import pytest

from robotteamsim.nodes.tf_pose import TfPose

S = 10**9
LOST = "/tf: no transform map -> robot_1/base_link for 0.3 s (control.tf_timeout_s)"


class Table:
    """The newest transform, as set."""

    newest_one: tuple[int, float, float, float] | None = None

    def newest(self, *frames: str) -> tuple[tuple[int, float, float, float] | None, str]:
        assert frames == ("map", "robot_1/base_link")
        return self.newest_one, "" if self.newest_one else "no such frame"


@pytest.fixture
def table() -> Table:
    return Table()


@pytest.fixture
def tf(table) -> TfPose:
    return TfPose(table.newest, "robot_1", 0.3)


def test_pose_is_that_of_base_link_in_the_map(tf, table):
    table.newest_one = (5 * S, 2.0, 3.0, math.pi / 2.0)
    assert tf.follow(5 * S) == ""
    assert (tf.newest.x_m, tf.newest.y_m, tf.newest.qz) == pytest.approx((2.0, 3.0, math.sqrt(0.5)))


def test_robot_is_lost_when_no_transform_came_for_the_timeout_and_keeps_its_last_pose(tf, table):
    table.newest_one = (5 * S, 2.0, 3.0, 0.0)
    assert [tf.follow(5 * S + tenths * S // 10) for tenths in range(5)] == ["", "", "", LOST, LOST]
    table.newest_one = None  # out of tf's memory
    assert tf.follow(20 * S) == LOST
    assert (tf.newest.x_m, tf.newest.y_m) == (2.0, 3.0)
    table.newest_one = (20 * S, 4.0, 3.0, 0.0)
    assert tf.follow(20 * S) == ""


@pytest.mark.parametrize(
    ("timeout_s", "lost_s", "line"),
    [(0.3, 10, "10 s"), (15.0, 15, "15 s (control.tf_timeout_s)")],
    ids=["shorter than a start", "longer"],
)
def test_robot_that_is_never_located_waits_at_the_start_and_is_then_lost_without_a_pose(table, timeout_s, lost_s, line):
    tf = TfPose(table.newest, "robot_1", timeout_s)
    answers = [tf.follow(7 * S + seconds * S) for seconds in range(lost_s + 1)]
    assert answers == [*(lost_s * [""]), f"/tf: no transform map -> robot_1/base_link for {line}"]
    assert tf.newest is None
    assert tf.reason == "no such frame"


def test_transforms_that_are_too_old_when_they_arrive_do_not_count(tf, table):
    tf.follow(5 * S)
    table.newest_one = (5 * S - 4 * S // 10, 2.0, 3.0, 0.0)
    assert tf.follow(5 * S) == LOST


def test_clock_ahead_does_not_hide_that_transforms_have_stopped(tf, table):
    table.newest_one = (3600 * S, 2.0, 3.0, 0.0)
    assert [tf.follow(5 * S + tenths * S // 10) for tenths in range(4)] == ["", "", "", LOST]


def test_static_transform_is_never_too_old(tf, table):
    table.newest_one = (0, 2.0, 3.0, 0.0)
    assert [tf.follow(stamp_ns) for stamp_ns in (5 * S, 500 * S)] == ["", ""]


def test_transform_beyond_1000_km_does_not_count(tf, table):
    table.newest_one = (5 * S, 2e6, 0.0, 0.0)
    tf.follow(5 * S)
    assert tf.newest is None
    assert tf.reason == "position: (2e+06, 0); expected finite numbers within 1000 km"


def test_restart_forgets_the_pose(tf, table):
    table.newest_one = (5 * S, 2.0, 3.0, 0.0)
    tf.follow(5 * S)
    table.newest_one = None
    tf.restart()
    assert tf.follow(S // 10) == ""
    assert tf.newest is None

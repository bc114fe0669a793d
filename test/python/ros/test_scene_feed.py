import pytest

from robotteamsim.ros.scene.feed import robot_topics, thinned


@pytest.mark.parametrize(
    ("at_most", "kept"), [(1, [9]), (2, [4, 9]), (3, [1, 5, 9]), (10, list(range(10))), (99, list(range(10)))]
)
def test_thinned_items_are_evenly_spread_and_end_with_the_newest(at_most, kept):
    assert thinned(list(range(10)), at_most) == kept


def test_nothing_is_thinned_to_nothing():
    assert thinned([], 3) == []


def test_robots_are_found_by_their_ground_truth_in_id_order():
    published = [
        "/clock",
        "/robot_10/base_pose_ground_truth",
        "/robot_2/base_pose_ground_truth",
        "/robot_2/odom",
        "/other/robot_3/base_pose_ground_truth",
    ]
    assert list(robot_topics(published).items()) == [(2, "/robot_2/"), (10, "/robot_10/")]


def test_lone_robot_without_a_namespace_is_robot_0():
    assert robot_topics(["/base_pose_ground_truth"]) == {0: "/"}

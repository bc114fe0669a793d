import math

import numpy as np
import pytest
from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.nodes.scene.team import (
    EXCLUDED,
    RobotPicture,
    link_markers,
    robot_colour,
    team_markers,
    trail_marker,
)
from robotteamsim.recording.topics.radio import PublishedNetwork
from robotteamsim.scenario.sections import Robot

TEXT_Z_M = 1.9


def drawn(*robots):
    return list(team_markers(robots, 1.0, TEXT_Z_M))


def robot(robot_id, x_m=0.0, y_m=0.0, yaw_rad=0.0, **more):
    return RobotPicture(robot_id, pose=Pose(x_m, y_m, yaw_rad), **more)


def tint(item):
    return item.tint[:3]


def named(markers, namespace):
    return [item for item in markers if item.ns == namespace]


def test_ids_of_a_team_are_unique():
    markers = drawn(*(robot(i, i, 2.0 * i, 0.1 * i) for i in range(30)))
    assert len({(item.ns, item.id) for item in markers}) == len(markers)


def test_robot_without_a_pose_is_not_drawn():
    assert drawn(RobotPicture(0)) == []


def test_first_robots_have_different_colours():
    assert len({robot_colour(robot_id) for robot_id in range(30)}) == 30


def test_body_has_the_robots_size_at_its_place():
    markers = drawn(robot(4, 3.0, 5.0, math.pi / 2, model=Robot(radius_m=0.3, height_m=0.4)))
    (body,), (deck,) = named(markers, "bodies"), named(markers, "decks")
    assert (body.scale[0], body.scale[1]) == (0.6, 0.6)
    assert (body.position[0], body.position[1]) == (3.0, 5.0)
    assert deck.position[2] + deck.scale[2] / 2.0 == pytest.approx(0.4)
    assert tint(deck) == robot_colour(4)[:3]
    assert named(markers, "robot_ids")[0].text == "R4"


def test_arrow_points_ahead():
    (item,) = named(drawn(robot(0, yaw_rad=1.0)), "arrows")
    assert item.yaw_rad == 1.0
    assert max(point[0] for point in item.points) > -min(point[0] for point in item.points)


def test_body_with_corners_is_drawn_over_its_footprint():
    model = Robot(footprint_m=((-0.1, -0.2), (0.5, -0.2), (0.5, 0.2), (-0.1, 0.2)), height_m=0.3)
    (body,) = named(drawn(robot(1, 2.0, 3.0, math.pi / 2.0, model=model)), "bodies")
    assert body.type == Marker.TRIANGLE_LIST
    xs, ys, zs = zip(*body.points, strict=True)
    assert (min(xs), max(xs), min(ys), max(ys)) == pytest.approx((-0.1, 0.5, -0.2, 0.2))
    assert (min(zs), max(zs)) == pytest.approx((0.0, 0.3))
    assert (body.position[0], body.position[1]) == (2.0, 3.0)
    assert body.yaw_rad == math.pi / 2.0


@pytest.mark.parametrize(
    ("state", "colour"),
    [
        ({}, robot_colour(2)),
        ({"excluded": True}, EXCLUDED),
        ({"swarm": 1}, robot_colour(1)),
        ({"excluded": True, "swarm": -1}, EXCLUDED),
    ],
)
def test_ring_has_the_colour_of_the_robot_or_its_swarm_and_is_grey_if_excluded(state, colour):
    markers = drawn(robot(2, **state))
    assert tint(named(markers, "rings")[0]) == colour[:3]
    assert tint(named(markers, "decks")[0]) == robot_colour(2)[:3]


def test_number_is_north_of_a_lone_robot_and_away_from_the_rest_of_a_team():
    (number,) = named(drawn(robot(0, 1.0, 1.0)), "robot_ids")
    assert number.position[0] == pytest.approx(1.0)
    assert number.position[1] > 1.0
    west, east = named(drawn(robot(0, 1.0, 1.0), robot(1, 2.0, 1.0)), "robot_ids")
    assert west.position[0] < 0.5
    assert east.position[0] > 2.5
    assert {west.position[2], east.position[2]} == {TEXT_Z_M}


def test_base_has_a_second_ring_and_is_named_and_no_other_robot_is():
    markers = drawn(robot(0, is_base=True), robot(1, x_m=9.0))
    (base,), (ring, _) = named(markers, "bases"), named(markers, "rings")
    assert base.id == 0
    assert max(point[0] for point in base.points) > max(point[0] for point in ring.points)
    assert [number.text for number in named(markers, "robot_ids")] == ["base R0", "R1"]


def test_firefighter_has_a_helmet_and_a_letter_and_the_centre_its_name():
    centre = robot(5, x_m=9.0, role="command_centre", is_base=True)
    markers = drawn(robot(4, role="firefighter"), centre, robot(6, x_m=15.0))
    assert {item.id for item in named(markers, "bodies")} == {5, 6}
    assert palette.rgb(palette.HELMET) in {tint(item) for item in named(markers, "firefighters")}
    assert {item.text for item in named(markers, "robot_ids")} == {"F4", "centre", "R6"}
    assert len({(item.ns, item.id) for item in markers}) == len(markers)


def driven(path, *, step_s=1.0):
    found = RobotPicture(0)
    for i, (x_m, y_m) in enumerate(path):
        found.move(i * step_s, Pose(x_m, y_m, 0.0))
    return found


def test_trail_has_points_at_its_spacing_and_restarts_when_time_jumps_back_or_the_robot_jumps():
    found = driven([(0.1 * i, 0.0) for i in range(10)])
    assert [x for x, _ in found.trail_m] == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8], abs=0.11)
    found.move(0.5, Pose(1.2, 0.0, 0.0))
    assert list(found.trail_m) == [(1.2, 0.0)]
    assert list(driven([(0.0, 0.0), (0.5, 0.0), (9.0, 0.0)]).trail_m) == [(9.0, 0.0)]
    assert list(driven([(0.0, 0.0)] * 50 + [(0.5, 0.0)]).trail_m) == [(0.0, 0.0), (0.5, 0.0)]


def test_trail_fades_toward_its_oldest_point():
    item = trail_marker(1, [(float(i), 0.0) for i in range(5)], 1.0)
    opacities = [point_colour[3] for point_colour in item.tints]
    assert opacities == sorted(opacities)
    assert len(item.points) == len(item.tints) == 5
    assert item.tint[3] < 1.0


POSITIONS_M = {0: (0.0, 0.0), 1: (10.0, 0.0), 2: (30.0, 0.0)}


def network(adjacency, endangered=None):
    endangered = np.zeros_like(adjacency) if endangered is None else endangered
    return PublishedNetwork(adjacency, endangered, np.zeros(adjacency.shape, dtype=np.int32), 0.0)


def among(count, pairs):
    result = np.zeros((count, count), dtype=bool)
    for i, j in pairs:
        result[i, j] = result[j, i] = True
    return result


def ends(markers):
    """Return the robots' x at the ends of each link."""
    (links,) = markers
    return [(a[0], b[0]) for a, b in zip(links.points[::2], links.points[1::2], strict=True)]


def test_links_are_green_and_endangered_ones_red():
    links = network(among(3, [(0, 1), (1, 2)]), among(3, [(1, 2)]))
    (item,) = link_markers(links, POSITIONS_M, 1.0)
    assert ends([item]) == [(0.0, 10.0), (10.0, 30.0)]
    codes = [palette.STRONG_LINK, palette.STRONG_LINK, palette.ENDANGERED_LINK, palette.ENDANGERED_LINK]
    assert [c[:3] for c in item.tints] == [palette.rgb(code) for code in codes]


def test_link_of_an_unknown_robot_is_not_drawn_and_that_of_robots_in_one_place_is():
    assert ends(link_markers(network(among(9, [(0, 1), (0, 8)])), POSITIONS_M, 1.0)) == [(0.0, 10.0)]
    assert link_markers(network(among(9, [(0, 1)])), {}, 1.0) == []
    assert link_markers(None, POSITIONS_M, 1.0) == []

    assert ends(link_markers(network(among(2, [(0, 1)])), {0: (1.0, 1.0), 1: (1.0, 1.0)}, 1.0)) == [(1.0, 1.0)]


def test_of_many_robots_the_shortest_links_that_connect_them_are_drawn():
    pairs = [(i, j) for i in range(12) for j in range(i) if (i < 6) == (j < 6)]
    positions_m = {i: (3.0 * i, 0.0) for i in range(12)}
    found = ends(link_markers(network(among(12, pairs)), positions_m, 1.0))
    assert sorted(found) == [(3.0 * i, 3.0 * i + 3.0) for i in range(11) if i != 5]

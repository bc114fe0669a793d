import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.network.compact import LinksDecoder, LinksEncoder
from robotteamsim.network.messages import NetworkState
from robotteamsim.ros.scene.lettering import Lettering, Written
from robotteamsim.ros.scene.shapes import colour, label
from robotteamsim.ros.scene.team import (
    EXCLUDED,
    LinkView,
    RobotView,
    Trail,
    link_markers,
    link_views,
    link_views_without_signals,
    robot_colour,
    team_markers,
    team_numbers,
    trail_marker,
)

PLAIN = Lettering(unit=1.0, eye_m=(0.0, -26.0, 51.0), highest_m=1.1)


def drawn(view):
    return team_markers([view], PLAIN)


def tint(item):
    return (item.color.r, item.color.g, item.color.b)


def named(markers, namespace):
    return [item for item in markers if item.ns == namespace]


def test_ids_of_a_team_are_unique_and_no_frame_has_a_leading_slash():
    markers = team_markers([RobotView(i, Pose(i, 2.0 * i, 0.1 * i)) for i in range(30)], PLAIN)
    assert len({(item.ns, item.id) for item in markers}) == len(markers)
    assert {item.header.frame_id for item in markers} == {"map"}


def test_first_robots_have_different_colours():
    assert len({robot_colour(robot_id) for robot_id in range(30)}) == 30


def test_body_has_the_robots_size_and_every_part_its_place():
    markers = drawn(RobotView(4, Pose(3.0, 5.0, math.pi / 2), radius_m=0.3, height_m=0.4))
    (body,) = named(markers, "bodies")
    assert (body.scale.x, body.scale.y) == (0.6, 0.6)
    assert body.pose.position.z + body.scale.z / 2.0 <= 0.4
    (laser,) = named(markers, "lasers")
    assert (laser.pose.position.x, laser.pose.position.y) == pytest.approx((3.0, 5.0 + 0.45 * 0.3))
    assert named(markers, "robot_ids")[0].text == "R4"


def test_rim_is_red_where_a_robot_touches_something_and_nowhere_else():
    view = RobotView(0, Pose(1.0, 2.0, 0.5), radius_m=0.3, contact_angles_rad=(-1.2, 2.9))
    (bumper,) = named(drawn(view), "bumpers")
    angles = np.array([math.atan2(point.y, point.x) for point in bumper.points])
    off_rad = np.abs(np.angle(np.exp(1j * (angles[:, None] - np.array([-1.2, 2.9])))))
    assert off_rad.min(axis=1).max() == pytest.approx(0.35)
    assert (off_rad < 0.36).sum(axis=0).tolist() == [42, 42]
    assert {round(math.hypot(point.x, point.y), 6) for point in bumper.points} == {0.225, 0.33}
    assert len(bumper.points) % 3 == 0
    assert (bumper.pose.position.x, bumper.pose.position.y) == (1.0, 2.0)
    assert not named(drawn(RobotView(0, Pose(1.0, 2.0, 0.5))), "bumpers")


def test_rim_of_a_body_with_corners_is_red_along_its_footprint():
    corners_m = ((1.0, 0.3), (-1.0, 0.3), (-1.0, -0.3), (1.0, -0.3))
    view = RobotView(0, Pose(0.0, 0.0, 0.0), radius_m=1.05, corners_m=corners_m, contact_angles_rad=(math.pi / 2,))
    (bumper,) = named(drawn(view), "bumpers")
    assert {round(point.y, 6) for point in bumper.points} == {0.225, 0.33}


def test_arc_outside_the_ring_lies_in_the_direction_of_a_contact():
    markers = drawn(RobotView(0, Pose(1.0, 2.0, 0.5), radius_m=0.3, contact_angles_rad=(2.0,)))
    (hit,), (ring,) = named(markers, "hits"), named(markers, "rings")
    away_m = [math.hypot(point.x, point.y) for point in hit.points]
    assert min(away_m) > max(math.hypot(point.x, point.y) for point in ring.points)
    assert np.mean([math.atan2(point.y, point.x) for point in hit.points]) == pytest.approx(2.0, abs=0.05)
    assert not named(drawn(RobotView(0, Pose(1.0, 2.0, 0.5))), "hits")


def test_each_laser_is_a_drum_at_its_place():
    view = RobotView(1, Pose(2.0, 0.0, math.pi / 2), radius_m=0.5, lasers_m=((0.4, 0.0), (0.0, 0.3)))
    drums = named(drawn(view), "lasers")
    places = [(drum.pose.position.x, drum.pose.position.y) for drum in drums]
    assert places == [pytest.approx((2.0, 0.4)), pytest.approx((1.7, 0.0))]
    assert len({drum.id for drum in drums}) == 2


def test_heading_shows_in_the_pose_of_wedge_and_arrow():
    for namespace in ("wedges", "arrows"):
        (item,) = named(drawn(RobotView(0, Pose(0.0, 0.0, 1.0))), namespace)
        assert 2.0 * math.atan2(item.pose.orientation.z, item.pose.orientation.w) == pytest.approx(1.0)
        assert max(point.x for point in item.points) > -min(point.x for point in item.points)


def test_body_with_corners_is_drawn_over_its_footprint():
    corners_m = ((-0.1, -0.2), (0.5, -0.2), (0.5, 0.2), (-0.1, 0.2))
    view = RobotView(1, Pose(2.0, 3.0, math.pi / 2.0), radius_m=0.54, height_m=0.3, corners_m=corners_m)
    (body,) = named(drawn(view), "bodies")
    assert body.type == Marker.TRIANGLE_LIST
    xs, ys, zs = zip(*((point.x, point.y, point.z) for point in body.points), strict=True)
    assert (min(xs), max(xs)) == pytest.approx((1.8, 2.2))
    assert (min(ys), max(ys)) == pytest.approx((2.9, 3.5))
    assert (min(zs), max(zs)) == pytest.approx((0.0, 0.27))


def test_excluded_robot_is_ringed_in_grey_and_keeps_its_deck():
    included, excluded = (drawn(RobotView(2, Pose(0.0, 0.0, 0.0), excluded=flag)) for flag in (False, True))
    assert tint(named(included, "rings")[0]) == robot_colour(2)[:3]
    assert tint(named(excluded, "rings")[0]) == EXCLUDED[:3]
    assert tint(named(excluded, "decks")[0]) == robot_colour(2)[:3]
    assert [(item.ns, item.id) for item in included] == [(item.ns, item.id) for item in excluded]


def test_robots_of_several_swarms_are_ringed_in_the_colour_of_theirs():
    views = [RobotView(robot_id, Pose(2.0 * robot_id, 0.0, 0.0), swarm=swarm) for robot_id, swarm in ((2, 0), (3, 1))]
    rings = named(team_markers(views, PLAIN), "rings")
    assert [tint(ring) for ring in rings] == [robot_colour(0)[:3], robot_colour(1)[:3]]
    lost = RobotView(3, Pose(0.0, 0.0, 0.0), excluded=True, swarm=-1)
    assert tint(named(drawn(lost), "rings")[0]) == EXCLUDED[:3]


def test_number_is_north_of_a_lone_robot_and_stays_on_its_side_while_it_can():
    view = RobotView(0, Pose(1.0, 1.0, 0.0))
    (number,) = team_numbers([view], PLAIN).values()
    assert number.middle_m[0] == 1.0
    assert number.middle_m[1] > 1.0
    east = replace(number, side=2)
    assert team_numbers([view], PLAIN, before={0: east})[0].middle_m[0] > 1.5


def test_numbers_of_a_dense_team_cover_neither_each_other_nor_robots_nor_other_texts():
    views = [RobotView(i, Pose(2.5 * (i % 3), 2.5 * (i // 3), 0.0)) for i in range(6)]
    name = Written("victim 1", (2.5, 4.6), 1.1)
    boxes = [number.box for number in team_numbers(views, PLAIN, [name.box]).values()]
    assert all(not a.intersects(b) for a, b in itertools.combinations([*boxes, name.box], 2))
    bodies = [shapely.Point(view.pose.x_m, view.pose.y_m).buffer(view.radius_m) for view in views]
    assert not any(box.intersects(body) for box in boxes for body in bodies)


def test_base_is_in_a_square_and_named_and_no_other_robot_is():
    markers = team_markers([RobotView(0, Pose(0.0, 0.0, 1.0), base=True), RobotView(1, Pose(9.0, 0.0, 0.0))], PLAIN)
    (square,) = named(markers, "bases")
    (ring, _) = named(markers, "rings")
    assert square.id == 0
    assert max(point.x for point in square.points) > max(point.x for point in ring.points)
    assert [number.text for number in named(markers, "robot_ids")] == ["base R0", "R1"]


def drive(trail, path, *, step_s=1.0, max_points=100):
    for i, (x, y) in enumerate(path):
        trail.add(x, y, i * step_s, max_speed_mps=1.0, max_points=max_points)


def test_trail_keeps_points_at_its_spacing():
    trail = Trail(spacing_m=0.5)
    drive(trail, [(0.2 * i, 0.0) for i in range(10)])
    assert [x for x, _ in trail.points_m] == pytest.approx([0.0, 0.6, 1.2, 1.8])


def test_trail_forgets_its_oldest_points():
    trail = Trail()
    drive(trail, [(float(i), 0.0) for i in range(10)], max_points=3)
    assert trail.points_m == ((7.0, 0.0), (8.0, 0.0), (9.0, 0.0))


def test_trail_begins_anew_when_time_runs_backwards():
    trail = Trail()
    drive(trail, [(0.0, 0.0), (1.0, 0.0)])
    trail.add(1.2, 0.0, 0.5, max_speed_mps=1.0, max_points=100)
    assert trail.points_m == ((1.2, 0.0),)


def test_trail_begins_anew_when_the_robot_was_put_elsewhere():
    trail = Trail()
    drive(trail, [(0.0, 0.0), (1.0, 0.0), (9.0, 0.0)])
    assert trail.points_m == ((9.0, 0.0),)


def test_trail_of_a_robot_that_stood_long_goes_on():
    trail = Trail()
    drive(trail, [(0.0, 0.0)] * 50 + [(0.5, 0.0)])
    assert trail.points_m == ((0.0, 0.0), (0.5, 0.0))


def test_trail_fades_toward_its_oldest_point():
    item = trail_marker(1, [(float(i), 0.0) for i in range(5)])
    opacities = [point_colour.a for point_colour in item.colors]
    assert opacities == sorted(opacities)
    assert len(item.points) == len(item.colors) == 5
    assert item.color.a < 1.0


POSITIONS_M = {0: (0.0, 0.0), 1: (10.0, 0.0), 2: (30.0, 0.0)}


@pytest.mark.parametrize(
    ("rssi_dbm", "code"),
    [
        (-50.0, palette.STRONG_LINK),
        (-70.0, palette.WEAK_LINK),
        (-80.0, palette.ENDANGERED_LINK),
        (-90.0, palette.ENDANGERED_LINK),
    ],
)
def test_link_is_green_when_strong_yellow_at_70_and_red_from_80_dbm(rssi_dbm, code):
    (links,) = link_markers([LinkView(0, 1, rssi_dbm, True, 1)], POSITIONS_M, PLAIN)
    assert (links.colors[0].r, links.colors[0].g, links.colors[0].b) == pytest.approx(colour(code)[:3])


def test_direct_link_has_no_number_and_a_relayed_one_states_its_hops():
    assert not named(link_markers([LinkView(0, 1, -60.0, True, 1)], POSITIONS_M, PLAIN), "hops")
    _, number = link_markers([LinkView(0, 2, -99.0, False, 2)], POSITIONS_M, PLAIN)
    assert number.type == Marker.TEXT_VIEW_FACING
    assert number.text == "2 hops"


def test_pair_that_needs_a_relay_is_dashed_and_lost_pair_is_not_drawn():
    links = [LinkView(0, 1, -60.0, True, 1), LinkView(1, 2, -75.0, True, 1), LinkView(0, 2, -99.0, False, 2)]
    markers = link_markers(links, POSITIONS_M, PLAIN)
    solid, dashed = named(markers, "links")
    assert len(solid.points) == 4
    assert len(dashed.points) > 20
    assert [item.text for item in named(markers, "hops")] == ["2 hops"]
    assert link_markers([LinkView(0, 1, -99.0, False, -1)], POSITIONS_M, PLAIN) == []


def test_link_does_not_reach_into_the_robots():
    (links,) = link_markers([LinkView(0, 1, -60.0, True, 1)], POSITIONS_M, PLAIN)
    assert 0.2 < links.points[0].x < 0.5
    assert 9.5 < links.points[1].x < 9.8


def test_many_robots_have_links_without_hop_counts():
    positions_m = {i: (5.0 * i, 0.0) for i in range(9)}
    markers = link_markers([LinkView(i, i + 1, -70.0, True, 1) for i in range(8)], positions_m, PLAIN)
    assert [item.ns for item in markers] == ["links"]


def test_link_of_an_unknown_robot_is_left_out():
    assert link_markers([LinkView(0, 9, -60.0, True, 1)], POSITIONS_M, PLAIN) == []


def test_robots_in_the_same_place_can_be_linked():
    assert link_markers([LinkView(0, 1, -40.0, True, 1)], {0: (1.0, 1.0), 1: (1.0, 1.0)}, PLAIN)


def network(rssi_dbm, hop_count):
    adjacency = (rssi_dbm > -94.0) & ~np.eye(len(rssi_dbm), dtype=bool)
    nothing = np.zeros_like(rssi_dbm)
    return NetworkState(rssi_dbm, rssi_dbm, adjacency, hop_count, nothing, 1.0, nothing.astype(bool))


def test_every_pair_of_few_robots_is_viewed_once():
    rssi_dbm = np.array([[0.0, -60.0, -95.0], [-60.0, 0.0, -70.0], [-95.0, -70.0, 0.0]])
    hop_count = np.array([[0, 1, 2], [1, 0, 1], [2, 1, 0]], dtype=np.int32)
    assert link_views(network(rssi_dbm, hop_count)) == [
        LinkView(0, 1, -60.0, True, 1),
        LinkView(0, 2, -95.0, False, 2),
        LinkView(1, 2, -70.0, True, 1),
    ]


def test_of_many_robots_the_links_are_viewed_that_have_no_better_way_around():
    ids = np.arange(12)
    rssi_dbm = -60.0 - 3.0 * np.abs(ids[:, None] - ids)
    np.fill_diagonal(rssi_dbm, 0.0)
    links = link_views(network(rssi_dbm, np.ones((12, 12), dtype=np.int32)))
    assert [(link.first, link.second) for link in links] == [(i, i + 1) for i in range(11)]


def test_links_without_signals_connect_the_same_robots_by_the_shortest_links():
    rssi_dbm = np.full((12, 12), -60.0)
    rssi_dbm[:6, 6:] = rssi_dbm[6:, :6] = -99.0
    state = network(rssi_dbm, np.ones((12, 12), dtype=np.int32))
    state.endangered[2, 3] = state.endangered[3, 2] = True
    restored = LinksDecoder().decode(LinksEncoder().encode(state))
    positions_m = {i: (3.0 * i, 0.0) for i in range(11)}  # nobody knows where robot 11 is
    links = link_views_without_signals(restored, positions_m)
    assert [(link.first, link.second) for link in links] == [(i, i + 1) for i in range(10) if i != 5]
    assert [link.first for link in links if link.rssi_dbm == -80.0] == [2]
    assert link_views_without_signals(restored, {}) == []


def test_label_of_an_excluded_robot_is_grey():
    (number,) = named(drawn(RobotView(0, Pose(0.0, 0.0, 0.0), excluded=True)), "robot_ids")
    assert tint(number) == tint(label("", 0, "", EXCLUDED, (0.0, 0.0, 0.0), 1.0))

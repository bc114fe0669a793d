import math
from pathlib import Path

import pytest
import shapely
import visualization_msgs.msg
import yaml

from robotteamsim.nodes.scene.shapes import PITCH_RAD, Mesh, colour, drawn_below, label, lines, unit
from robotteamsim.recording.topics.markers import CYLINDER, Marker, marker_message
from robotteamsim.scenario import Bounds

ROOT = Path(__file__).resolve().parents[3]
RED, BLUE = colour("#ff0000"), colour("#0000ff")


def test_colour_code_is_read_as_red_green_blue_and_opacity():
    assert colour("#0080ff", 0.5) == (0.0, 128 / 255, 1.0, 0.5)


def test_marker_has_a_frame_without_slash_stamp_0_and_a_unit_quaternion():
    item = marker_message(Marker("bodies", 3, CYLINDER, RED, (1.0, 2.0, 3.0), math.pi / 2))
    assert item["header"] == {"stamp": 0, "frame_id": "map"}
    assert item["pose"]["orientation"] == pytest.approx({"z": math.sqrt(0.5), "w": math.sqrt(0.5)})
    assert item["pose"]["position"] == {"x": 1.0, "y": 2.0, "z": 3.0}


def test_label_is_opaque_and_lighter_than_its_colour():
    item = label("names", 0, "ann", (1.0, 0.0, 0.0, 0.2), (0.0, 0.0, 1.0), 0.8)
    assert item.type == visualization_msgs.msg.Marker.TEXT_VIEW_FACING
    assert item.tint == (1.0, 0.5, 0.5, 1.0)
    assert (item.text, item.scale[2]) == ("ann", 0.8)


def test_lines_have_two_points_and_two_colours_per_segment():
    item = lines("links", 0, [((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), RED), ((0.0, 1.0, 0.0), (1.0, 1.0, 0.0), BLUE)], 0.1)
    assert len(item.points) == len(item.tints) == 4
    assert [tint[2] for tint in item.tints] == [0.0, 0.0, 1.0, 1.0]


def test_lines_are_as_opaque_as_their_faintest_segment_or_rviz_would_not_blend_them():
    segments = [((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), tint) for tint in (RED, (0.0, 0.0, 1.0, 0.4))]
    assert lines("links", 0, segments, 0.1).tint[3] == 0.4


def test_sunken_origin_leaves_the_points_where_they_were():
    item = lines("links", 0, [((1.0, 2.0, 0.5), (3.0, 4.0, 0.5), RED)], 0.1)
    drawn_below(item, 2)
    assert item.position[2] < -100.0
    assert [item.position[2] + point[2] for point in item.points] == [0.5, 0.5]


def test_label_is_on_the_line_of_sight_of_the_default_view_to_its_place_on_the_floor():
    x_m, y_m, z_m = label("names", 0, "ann", RED, (3.0, 4.0, 2.0), 0.8).position
    assert (x_m, z_m) == (3.0, 2.0)
    assert math.atan2(z_m, 4.0 - y_m) == pytest.approx(PITCH_RAD)


def test_default_view_is_that_of_the_file_of_rviz():
    config = yaml.safe_load((ROOT / "rviz" / "robotteamsim.rviz").read_text(encoding="utf-8"))
    assert config["Visualization Manager"]["Views"]["Current"]["Pitch"] == PITCH_RAD


def test_sizes_are_equal_on_the_screen_in_every_building():
    assert unit(Bounds(max=(60.0, 40.0))) == 1.0
    assert unit(Bounds(max=(6.0, 4.0))) == pytest.approx(0.1)


def area_m2(item):
    triangles = [item.points[i : i + 3] for i in range(0, len(item.points), 3)]
    return sum(shapely.Polygon([p[:2] for p in triangle]).area for triangle in triangles)


def test_polygon_with_a_hole_is_covered_by_triangles_exactly():
    mesh = Mesh()
    mesh.polygon(shapely.box(0, 0, 10, 10) - shapely.box(4, 4, 6, 6), 0.5, RED)
    item = mesh.marker("floor", 0)
    assert area_m2(item) == pytest.approx(96.0)
    assert len(item.tints) == len(item.points)
    assert {point[2] for point in item.points} == {0.5}


def test_ring_area_is_that_of_the_disc_without_the_hole():
    mesh = Mesh()
    mesh.ring((5.0, 5.0), 1.0, 2.0, 0.0, RED)
    assert area_m2(mesh.marker("areas", 0)) == pytest.approx(3.0 * math.pi, rel=0.01)

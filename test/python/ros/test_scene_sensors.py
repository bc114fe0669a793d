import dataclasses
import math

import numpy as np
import pytest
from visualization_msgs.msg import Marker

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.sensors import FixView, SonarView, fix_markers, sonar_markers

NEAR = SonarView(Pose(1.0, 2.0, math.pi / 2), 0.25, 0.5, 3.0, 2.0)
NOTHING = SonarView(Pose(1.0, 2.0, 0.0), 0.25, 0.5, 3.0, 3.0)


@pytest.mark.parametrize("range_m", [math.inf, -math.inf, -1.0, 1e300])
def test_cone_of_a_range_beyond_its_limits_ends_at_them(range_m):
    (cone,) = named(sonar_markers({0: [dataclasses.replace(NEAR, range_m=range_m)]}), "sonars")
    reach_m = [math.hypot(point.x - 1.0, point.y - 2.0) for point in cone.points]
    assert max(reach_m) == pytest.approx(3.0 if range_m > 0.0 else 0.0)


def named(markers, namespace):
    return [item for item in markers if item.ns == namespace]


def points(item):
    return np.array([(point.x, point.y, point.z) for point in item.points])


def test_cone_reaches_from_the_sonar_to_what_it_told():
    (cone,) = named(sonar_markers({3: [NEAR]}), "sonars")
    assert cone.id == 3
    corners = points(cone)
    away_m = np.hypot(corners[:, 0] - 1.0, corners[:, 1] - 2.0)
    assert sorted(set(away_m.round(6).tolist())) == [0.0, 2.0]
    rim = corners[away_m > 1.0]
    angles_rad = np.arctan2(rim[:, 1] - 2.0, rim[:, 0] - 1.0) - math.pi / 2
    assert (angles_rad.min(), angles_rad.max()) == pytest.approx((-0.25, 0.25))
    assert set(corners[:, 2].tolist()) == {0.25}


def test_sonar_without_a_return_is_fainter_and_ends_in_no_arc():
    markers = sonar_markers({0: [NOTHING], 1: [NEAR]})
    faint, clear = named(markers, "sonars")
    assert max(tint.a for tint in faint.colors) < max(tint.a for tint in clear.colors)
    assert [item.id for item in named(markers, "sonar_returns")] == [1]


def test_robots_without_sonars_or_fixes_draw_nothing():
    assert sonar_markers({0: []}) == []
    assert fix_markers({0: ()}) == []


def test_newest_fix_is_a_pin_over_a_disc_of_its_deviation_and_older_ones_are_dots():
    fixes = [FixView((0.0, 0.0), 0.7), FixView((1.0, 0.5), 0.7), FixView((2.0, 3.0), 0.7)]
    markers = fix_markers({2: fixes})
    (pin,), (disc,), (dots,) = (named(markers, name) for name in ("fixes", "fix_discs", "old_fixes"))
    assert (pin.type, pin.pose.position.x, pin.pose.position.y) == (Marker.SPHERE, 2.0, 3.0)
    assert np.hypot(points(disc)[:, 0] - 2.0, points(disc)[:, 1] - 3.0).max() == pytest.approx(0.7)
    assert points(dots)[:, :2].tolist() == [[0.0, 0.0], [1.0, 0.5]]
    assert dots.colors[0].a < dots.colors[1].a
    assert len({(item.ns, item.id) for item in markers}) == len(markers)


def test_first_fix_has_no_dots():
    assert named(fix_markers({0: [FixView((0.0, 0.0), 0.0)]}), "old_fixes") == []

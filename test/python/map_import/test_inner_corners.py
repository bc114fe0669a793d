"""Walls that meet come apart by cuts."""

from __future__ import annotations

import pytest
import shapely
from shapely.affinity import rotate

from robotteamsim.map_import.inner_corners import cut_at_inner_corners


def _areas(polygon: shapely.Polygon, longest: float = 10.0) -> list[float]:
    parts = cut_at_inner_corners(polygon, longest)
    assert shapely.union_all(parts).symmetric_difference(polygon).area == pytest.approx(0.0, abs=1e-6)
    return sorted(round(part.area, 3) for part in parts)


@pytest.mark.parametrize("angle_deg", [0.0, 20.0, 45.0])
def test_wall_that_joins_another_comes_apart_along_its_foot(angle_deg: float) -> None:
    tee = rotate(shapely.union_all([shapely.box(0, 0, 60, 5), shapely.box(28, 5, 32, 40)]), angle_deg)
    assert _areas(tee) == [140.0, 300.0]


def test_walls_of_a_corner_come_apart_by_one_cut() -> None:
    corner = shapely.union_all([shapely.box(0, 0, 60, 5), shapely.box(0, 0, 4, 40)])
    assert _areas(corner) == [140.0, 300.0]


def test_pillar_between_walls_comes_apart_from_both() -> None:
    row = shapely.union_all([shapely.box(0, 4, 50, 8), shapely.box(20, 0, 32, 12)])
    assert _areas(row) == [72.0, 80.0, 144.0]


def test_crossing_walls_come_apart_along_three_sides_of_their_crossing() -> None:
    cross = shapely.union_all([shapely.box(0, 20, 50, 24), shapely.box(20, 0, 24, 50)])
    assert _areas(cross) in ([80.0, 80.0, 104.0, 120.0], [80.0, 96.0, 104.0, 104.0])


def test_walls_around_a_room_keep_the_room_free() -> None:
    room = shapely.box(0, 0, 50, 40).difference(shapely.box(4, 4, 46, 36))
    assert sum(_areas(room)) == pytest.approx(room.area)
    assert len(_areas(room)) == 4


def test_corner_with_a_longer_diagonal_stays_whole() -> None:
    corner = shapely.union_all([shapely.box(0, 0, 60, 25), shapely.box(0, 0, 20, 60)])
    assert len(_areas(corner, longest=15.0)) == 1
    assert len(_areas(corner, longest=26.0)) == 2


def test_slight_bend_stays_whole() -> None:
    bend = shapely.LineString([(0, 0), (40, 0), (80, 4)]).buffer(3.0, cap_style="flat", join_style="mitre")
    assert len(_areas(bend)) == 1

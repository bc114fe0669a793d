"""How thick the walls are that outlines enclose."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from robotteamsim.map_import.thickness import edge_thickness, piece_thickness


def _wall(length: float, width: float, angle_deg: float = 0.0) -> shapely.Polygon:
    return shapely.affinity.rotate(shapely.box(0.0, 0.0, length, width), angle_deg, origin=(0.0, 0.0))


@pytest.mark.parametrize("angle_deg", [0.0, 12.0, 45.0])
def test_all_sides_of_a_wall_have_its_thickness(angle_deg: float) -> None:
    np.testing.assert_allclose(edge_thickness(_wall(40.0, 6.0, angle_deg), most=50.0), 6.0, atol=0.01)


def test_wall_thicker_than_the_most_counts_as_the_most() -> None:
    assert edge_thickness(_wall(90.0, 60.0), most=20.0).tolist() == [20.0] * 4


def test_wall_that_joins_does_not_thicken_the_other() -> None:
    tee = shapely.union_all([shapely.box(0, 0, 60, 5), shapely.box(28, 5, 32, 40)])
    by_side = dict(zip(map(tuple, shapely.get_coordinates(tee.exterior)[:-1]), edge_thickness(tee, 50.0), strict=True))
    # Edges run from the corner on; the polygon may be oriented either way, so every corner names a thin or thick side.
    assert set(np.round(list(by_side.values()), 1)) == {4.0, 5.0}


def test_bent_wall_has_one_thickness() -> None:
    arc = shapely.LineString([(30 * np.cos(a), 30 * np.sin(a)) for a in np.linspace(0.0, 2.0, 40)])
    thickness = edge_thickness(arc.buffer(3.0, cap_style="flat"), most=50.0)
    assert thickness.min() > 5.5
    assert thickness.max() < 7.0


def test_pieces_take_the_thickness_of_the_wall_that_they_are_part_of() -> None:
    wall, slices = _wall(30.0, 8.0), [_wall(30.0, 8.0).intersection(shapely.box(0, y, 30, y + 2)) for y in (0, 2, 6)]
    corners = [shapely.get_coordinates(piece)[:-1] for piece in slices]
    first, inner, last = piece_thickness(wall, corners, most=50.0)
    assert (first, inner, last) == pytest.approx((8.0, 8.0, 8.0), abs=0.01)


def test_piece_without_an_outer_side_has_no_thickness() -> None:
    inside = shapely.get_coordinates(shapely.box(10, 3, 20, 5))[:-1]
    assert np.isnan(piece_thickness(_wall(30.0, 8.0), [inside], most=50.0)).all()

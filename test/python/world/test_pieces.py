import math

import pytest
import shapely

from robotteamsim.world.core_parts import MAX_CORNERS, convex_pieces

SQUARE = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
L_SHAPE = ((0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0))
IN_LINE = ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))


def ring(corners: int) -> tuple[tuple[float, float], ...]:
    angles = (math.tau * i / corners for i in range(corners))
    return tuple((math.cos(angle), math.sin(angle)) for angle in angles)


def test_convex_polygon_of_eight_corners_stays_whole():
    assert convex_pieces(SQUARE) == (SQUARE,)
    assert convex_pieces(ring(8)) == (ring(8),)


@pytest.mark.parametrize("corners", [L_SHAPE, IN_LINE, ring(9)], ids=["L", "corners in line", "nine corners"])
def test_other_polygons_become_pieces_that_box2d_takes(corners):
    check(corners)


def check(corners: tuple[tuple[float, float], ...]) -> None:
    pieces = [shapely.Polygon(piece) for piece in convex_pieces(corners)]
    assert all(len(piece.exterior.coords) - 1 <= MAX_CORNERS for piece in pieces)
    assert all(piece.exterior.is_ccw for piece in pieces)
    assert all(piece.convex_hull.area == pytest.approx(piece.area, rel=1e-9) for piece in pieces)
    # They cover the polygon, and none covers another.
    assert shapely.union_all(pieces).symmetric_difference(shapely.Polygon(corners)).area < 1e-9
    assert sum(piece.area for piece in pieces) == pytest.approx(shapely.Polygon(corners).area)

"""Solid cells as straight walls and polygons."""

from __future__ import annotations

import numpy as np
import shapely

from robotteamsim.map_import.cells import darkness, lightness, solid_cells
from robotteamsim.map_import.pieces import PolygonPiece, StraightPiece, solid_pieces


def test_thin_rectangle_of_cells_is_a_straight_piece_along_its_middle() -> None:
    solid = np.zeros((40, 60), dtype=bool)
    solid[10:12, 5:55] = True
    pieces = solid_pieces(solid, (-1.0, 2.0), (0.1, 0.1))
    assert pieces == [StraightPiece(start=(-0.5, 3.1), end=(4.5, 3.1), thickness_m=0.2)]


def test_rectangle_thicker_than_the_loss_table_is_a_polygon_of_its_area() -> None:
    solid = np.zeros((40, 60), dtype=bool)
    solid[10:30, 20:40] = True
    (piece,) = solid_pieces(solid, (0.0, 0.0), (0.1, 0.1))
    assert isinstance(piece, PolygonPiece)
    assert shapely.Polygon(piece.corners).equals(shapely.box(2.0, 1.0, 4.0, 3.0))
    assert piece.thickness_m == 1.0  # whatever is thicker counts as this


def test_specks_are_dropped_pockets_filled_and_the_border_closed() -> None:
    occupied = np.zeros((30, 30), dtype=bool)
    occupied[5, 5] = True  # a speck
    occupied[10:14, 10:14] = True
    occupied[11:13, 11:13] = False  # a pocket of 0.04 m^2
    solid = solid_cells(occupied.astype(float), 0.65, 0.196, 0.1, closed=True)
    assert not solid[5, 5]
    assert solid[10:14, 10:14].all()
    assert np.concatenate([solid[0], solid[-1], solid[:, 0], solid[:, -1]]).all()


def test_cells_that_touch_by_a_corner_alone_are_joined() -> None:
    occupied = np.zeros((30, 30), dtype=bool)
    occupied[np.arange(8, 20), np.arange(8, 20)] = True
    solid = solid_cells(occupied.astype(float), 0.65, 0.196, 0.1, closed=True)
    a, b, c, d = solid[:-1, :-1], solid[:-1, 1:], solid[1:, :-1], solid[1:, 1:]
    assert not ((a & d & ~b & ~c) | (b & c & ~a & ~d)).any()


def test_darkness_has_the_lowest_row_first_and_black_as_1() -> None:
    image = np.array([[255, 255], [0, 255]], dtype=np.uint8)
    dark, negated = (darkness(lightness(image, negate=negate, with_alpha=True)) for negate in (False, True))
    np.testing.assert_array_equal(dark, [[1.0, 0.0], [0.0, 0.0]])
    np.testing.assert_array_equal(negated, [[0.0, 1.0], [1.0, 1.0]])

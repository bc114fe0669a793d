"""The outline on the floor of a shape in SDF."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robotteamsim.gazebo.xml_tree import Node
from robotteamsim.scenario.plan import Corners
from robotteamsim.scenario.yaml_text import shown
from robotteamsim.wording import printable

_UPRIGHT = math.cos(1e-3)
"""A shape that leans by less than a milliradian is upright."""

_CORNERS_OF_DISC = 24


class ShapeError(Exception):
    """A shape that cannot become a wall or a block; the text says why."""


@dataclass(frozen=True, slots=True)
class Outline:
    """An upright solid: its corners in order in the world [m], from bottom_m to top_m.

    The first side of a box is along its own x axis unless that is vertical.
    """

    corners: Corners
    bottom_m: float
    top_m: float


def outline_of(geometry: Node, matrix: np.ndarray) -> Outline | None:
    """Return the outline of a <geometry>; None: it is a level plane, such as the ground, or empty.

    Args:   matrix: of the shape's frame in the world.
    Raises: ShapeError: the shape has no vertical sides, or leans. ScenarioError: a number is wrong.
    """
    shape = next(iter(geometry.children), None)
    if shape is None or shape.tag == "empty":
        return None
    if shape.tag == "plane":
        _check_level(shape, matrix)
        return None
    if shape.tag == "box":
        return _box(shape.required("size").lengths(3), matrix)
    if shape.tag == "cylinder":
        return _cylinder(shape, matrix)
    if shape.tag == "polyline":
        return _polyline(geometry, shape, matrix)
    raise ShapeError(f"a {_name_of(shape)} cannot become a wall")


def _name_of(shape: Node) -> str:
    tag, uri = printable(shape.tag), shape.child("uri")
    return f"{tag} {shown(uri.text)}" if uri is not None else tag


def _check_level(plane: Node, matrix: np.ndarray) -> None:
    given = plane.child("normal")
    normal = np.array(given.numbers(3) if given else (0.0, 0.0, 1.0))
    length = float(np.linalg.norm(normal))
    if length < 1e-9 or abs((matrix[:3, :3] @ normal)[2]) < _UPRIGHT * length:
        raise ShapeError("a plane that is not level cannot become a wall")


def _box(size_m: tuple[float, ...], matrix: np.ndarray) -> Outline:
    turn = matrix[:3, :3]
    upright = int(np.argmax(np.abs(turn[2])))
    _check_upright(turn[2, upright])
    first, second = (axis for axis in range(3) if axis != upright)
    along, aside = 0.5 * size_m[first] * turn[:2, first], 0.5 * size_m[second] * turn[:2, second]
    x, y, z = matrix[:3, 3]
    corners = np.array([-along - aside, along - aside, along + aside, aside - along]) + np.array((x, y))
    half_m = 0.5 * size_m[upright]
    return Outline(_points(corners), float(z) - half_m, float(z) + half_m)


def _cylinder(shape: Node, matrix: np.ndarray) -> Outline:
    (radius_m,), (length_m,) = shape.required("radius").lengths(1), shape.required("length").lengths(1)
    _check_upright(matrix[2, 2])
    x, y, z = matrix[:3, 3]
    angles = np.arange(_CORNERS_OF_DISC) * (2.0 * math.pi / _CORNERS_OF_DISC)
    corners = radius_m * np.column_stack((np.cos(angles), np.sin(angles))) + np.array((x, y))
    return Outline(_points(corners), float(z) - 0.5 * length_m, float(z) + 0.5 * length_m)


def _polyline(geometry: Node, shape: Node, matrix: np.ndarray) -> Outline:
    if len(list(geometry.all("polyline"))) > 1:
        raise ShapeError("several polylines with holes cannot become a wall")
    (height_m,) = shape.required("height").lengths(1)
    _check_upright(matrix[2, 2])
    points = [point.numbers(2) for point in shape.all("point")]
    if len(points) > 1 and math.dist(points[0], points[-1]) < 1e-4:
        points.pop()  # closed
    if len(points) < 3:
        raise shape.error(f"{len(points)} different points are too few; expected at least 3")
    places = np.column_stack((points, np.zeros(len(points)), np.ones(len(points)))) @ matrix.T
    z, top = float(matrix[2, 3]), float(matrix[2, 3] + math.copysign(height_m, matrix[2, 2]))
    return Outline(_points(places[:, :2]), min(z, top), max(z, top))


def _check_upright(cosine: float) -> None:
    if abs(cosine) < _UPRIGHT:
        raise ShapeError("it leans; expected vertical sides")


def _points(corners: np.ndarray) -> Corners:
    return tuple((x, y) for x, y in corners.tolist())

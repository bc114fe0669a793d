"""Convex pieces of polygons, as Box2D requires."""

from __future__ import annotations

import shapely

from robotteamsim.scenario.plan import Corners

MAX_CORNERS = 8
"""Box2D's limit for polygons."""

_MIN_AREA_M2 = 1e-9
"""Smaller triangles are rounding errors between collinear corners."""


def convex_pieces(corners: Corners) -> tuple[Corners, ...]:
    """Return convex polygons of at most eight corners whose union is a simple polygon.

    A convex polygon with few corners is returned as it is; any other is cut into the triangles of its constrained
    Delaunay triangulation. All corners are counter-clockwise [m].
    """
    if len(corners) <= MAX_CORNERS and _is_strictly_convex(corners):
        return (tuple(corners),)
    triangles = shapely.constrained_delaunay_triangles(shapely.Polygon(corners)).geoms
    return tuple(
        tuple(shapely.geometry.polygon.orient(triangle).exterior.coords[:-1])
        for triangle in triangles
        if triangle.area > _MIN_AREA_M2
    )


def _is_strictly_convex(corners: Corners) -> bool:
    turned = zip(corners, corners[1:] + corners[:1], corners[2:] + corners[:2], strict=True)
    return all((x1 - x0) * (y2 - y1) - (y1 - y0) * (x2 - x1) > 0.0 for (x0, y0), (x1, y1), (x2, y2) in turned)

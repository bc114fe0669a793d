"""Small buildings of Open-RMF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import shapely
import yaml

from robotteamsim.formats import Imported
from robotteamsim.formats.open_rmf import OpenRmfImporter
from robotteamsim.scenario.plan import wall_corners

PLAIN = {"alpha": [3, 1.0]}


def metres(distance: float) -> dict[str, Any]:
    """Return the parameters of a measurement."""
    return {"distance": [3, distance]}


def level(**more: Any) -> dict[str, Any]:
    """Return a room of 10 x 5 m whose east wall has a gap of 1 m, in pixels of 2 cm, y downwards."""
    vertices = [[0, 0], [500, 0], [500, 100], [500, 150], [500, 250], [0, 250], [0, 100], [250, 100]]
    return {
        "elevation": 0,
        "vertices": [[x, y, 0, ""] for x, y in vertices],
        "walls": [[a, b, PLAIN] for a, b in ((0, 1), (1, 2), (3, 4), (4, 5), (5, 0))] + [[6, 7, {"alpha": [3, 0.5]}]],
        "doors": [[2, 3, {"name": [1, "gate"], "type": [1, "hinged"]}]],
        # Of 10.1 and 9.9 m for the same 500 pixels.
        "measurements": [[0, 1, metres(10.1)], [0, 1, metres(9.9)]],
        **more,
    }


def read(folder: Path, building: dict[str, Any], **options: Any) -> Imported:
    """Return what is imported of a building."""
    path = folder / "house.building.yaml"
    path.write_text(yaml.safe_dump({"name": "house", **building}))
    return OpenRmfImporter().read(path, **options)


def building_of_three(**lift: Any) -> dict[str, Any]:
    """Return a building of three rooms, 4 m above one another, with lift "a" from the first to the third."""
    levels = {f"L{i}": level(elevation=4.0 * i) for i in (1, 2, 3)}
    door = {"x": 0.0, "y": 0.56, "width": 0.8}
    place = {"reference_floor_name": "L1", "x": 100, "y": 50, "yaw": 0.5, "width": 2.0, "depth": 1.0}
    lifts = {"a": {**place, "doors": {"d": door}, "level_doors": {"L1": ["d"], "L3": ["d"]}, **lift}}
    return {"levels": levels, "lifts": lifts}


def wall_of(wall: Any) -> shapely.Polygon:
    """Return the outline of a wall."""
    return shapely.Polygon(wall_corners(wall))

"""How far an imported image is from the vector plan that it was drawn from, in dB of wall loss.

A plan is turned about its middle, drawn as an image for map_server, and the image is imported. Links between random
free points are then reckoned in both plans; doors are open, since an image knows none. The plans of the real buildings
are imports of their images themselves: here they serve as vector plans.
Usage: python bench/import_accuracy_bench.py [--plans garage] [--points 200] [--csv bench/results/import_accuracy.csv]
"""

from __future__ import annotations

import argparse
import csv
import math
import tempfile
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import cv2
import numpy as np
import shapely

from robotteamsim.propagation import RadioField
from robotteamsim.rng import stream
from robotteamsim.scenario import load_floor_plan, occupancy_grid
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.map_image import import_map
from robotteamsim.scenario.plan import FREE, OCCUPIED, obstacles
from robotteamsim.scenario.sections import Radio
from robotteamsim.scenario.yaml_text import write

MAPS = Path(__file__).resolve().parents[1] / "test" / "data" / "maps"
PLANS = ("garage", *(str(MAPS / f"{name}.yaml") for name in ("one_r5", "cumberland", "diag_labs")))
ANGLES_DEG = (0.0, 7.0, 15.0, 30.0, 45.0)
RESOLUTIONS_M = (0.05, 0.1)
CLEARANCE_M = 0.05
"""Links start and end this far from solids: no robot gets nearer."""


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Error of the wall loss over all links: how many have one, and one above 1 dB; mean and quantile of its size."""

    plan: str
    resolution_m: float
    angle_deg: float
    elements: int
    links: int
    differing_percent: float
    above_1_db_percent: float
    mean_db: float
    quantile_99_db: float
    max_db: float


def turned(plan: FloorPlan, angle_deg: float) -> FloorPlan:
    """Return a plan turned about its middle, with all doors open, in bounds that hold all of it."""
    turn_rad = math.radians(angle_deg)
    turn = np.array([[math.cos(turn_rad), -math.sin(turn_rad)], [math.sin(turn_rad), math.cos(turn_rad)]])
    (x0, y0), (x1, y1) = plan.bounds.min, plan.bounds.max
    frame = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]) @ turn.T
    low, high = frame.min(axis=0), frame.max(axis=0)

    def place(point: tuple[float, float]) -> tuple[float, float]:
        x, y = turn @ point - low
        return float(np.clip(x, 0.0, high[0] - low[0])), float(np.clip(y, 0.0, high[1] - low[1]))

    def ends(element) -> dict:
        return {"start": place(element.start), "end": place(element.end)}

    return FloorPlan(
        name=plan.name,
        bounds=Bounds(max=tuple((high - low).tolist())),
        walls=tuple(wall.model_copy(update=ends(wall)) for wall in plan.walls),
        blocks=tuple(block.model_copy(update={"polygon": tuple(map(place, block.polygon))}) for block in plan.blocks),
        doors=tuple(door.model_copy(update={"closed": False, **ends(door)}) for door in plan.doors),
    )


def export_map(plan: FloorPlan, folder: str | Path, resolution_m: float = 0.05) -> None:
    """Write `map.yaml` and `map.pgm` of map_server into a folder: free cells white, occupied black."""
    grid = occupancy_grid(plan, resolution_m)
    grey = np.where(grid.cells == FREE, 254, np.where(grid.cells == OCCUPIED, 0, 205)).astype(np.uint8)
    cv2.imwrite(str(Path(folder, "map.pgm")), np.flipud(grey))
    settings = {"image": "map.pgm", "resolution": resolution_m, "origin": [*grid.origin_m, 0.0], "negate": 0}
    thresholds = {"occupied_thresh": 0.65, "free_thresh": 0.196}
    Path(folder, "map.yaml").write_text(write(settings | thresholds), encoding="utf-8")


def accuracy(plan: FloorPlan, resolution_m: float, angle_deg: float, num_points: int) -> Accuracy:
    """Compare a plan with the import of its image."""
    vector = turned(plan, angle_deg)
    with tempfile.TemporaryDirectory() as folder:
        export_map(vector, folder, resolution_m)
        imported = import_map(Path(folder, "map.yaml"))
    points_m = _free_points(vector, imported, num_points)
    rssi_dbm = [RadioField(either, Radio()).rssi_matrix_dbm(points_m) for either in (vector, imported)]
    error_db = np.abs(rssi_dbm[0] - rssi_dbm[1])[np.triu_indices(num_points, 1)]
    return Accuracy(
        plan=plan.name,
        resolution_m=resolution_m,
        angle_deg=angle_deg,
        elements=len(imported.walls) + len(imported.blocks),
        links=len(error_db),
        differing_percent=round(100.0 * float(np.mean(error_db > 1e-6)), 1),
        above_1_db_percent=round(100.0 * float(np.mean(error_db > 1.0)), 1),
        mean_db=round(float(error_db.mean()), 2),
        quantile_99_db=round(float(np.quantile(error_db, 0.99)), 1),
        max_db=round(float(error_db.max()), 1),
    )


def _free_points(vector: FloorPlan, imported: FloorPlan, count: int) -> np.ndarray:
    """Return random points that are free in both plans and not outside the building."""
    solid = shapely.union_all([obstacles(vector), obstacles(imported)])
    inside = shapely.convex_hull(obstacles(vector))
    generator, points = stream(0, "links"), []
    while len(points) < count:
        point = generator.uniform(vector.bounds.min, vector.bounds.max)
        if inside.contains(shapely.Point(point)) and solid.distance(shapely.Point(point)) > CLEARANCE_M:
            points.append(point)
    return np.array(points)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plans", nargs="+", default=PLANS, metavar="PLAN", help="shipped maps, or files")
    parser.add_argument("--points", type=int, default=200, help="number of free points; links are between all pairs")
    parser.add_argument("--csv", type=Path, help="write the table into this file too")
    options = parser.parse_args()
    rows: list[Accuracy] = []
    names = [field.name for field in fields(Accuracy)]
    print("  ".join(names))
    for plan in map(load_floor_plan, options.plans):
        for resolution_m in RESOLUTIONS_M:
            for angle_deg in ANGLES_DEG:
                rows.append(accuracy(plan, resolution_m, angle_deg, options.points))
                print("  ".join(f"{getattr(rows[-1], name):>{len(name)}}" for name in names))
    if options.csv:
        with options.csv.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(names)
            writer.writerows(map(astuple, rows))


if __name__ == "__main__":
    main()

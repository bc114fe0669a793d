"""The bodies of Stage's models as walls and blocks of a floor plan."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from robotteamsim.map_import.cells import (
    FREE_THRESH,
    OCCUPIED_THRESH,
    darkness,
    lightness,
    read_image,
    solid_cells,
    without_corner_contacts,
)
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Block, Door, Wall
from robotteamsim.scenario.image_walls import walls_and_blocks
from robotteamsim.scenario.plan import Corners, wall_corners
from robotteamsim.scenario.shapes import MIN_AREA_M2
from robotteamsim.scenario.yaml_text import is_file, shown
from robotteamsim.stage.values import THIN_M, Pose2, Values, compose, tidy
from robotteamsim.stage.world_file import Entity
from robotteamsim.wording import counted, printable

DEFAULT_SIZE_M = (0.4, 0.4, 1.0)
"""Default of `size` (Stage 4)."""

MIN_PIXEL_M = 0.001
"""Least size of a bitmap's pixels."""

_FREE_ABOVE = 127
"""A lighter pixel of a bitmap is free in Stage."""

_SIZES_M = {"gripper": (0.2, 0.3, 0.2), "ranger": (0.15, 0.15, 0.2)}
"""Defaults of other kinds."""

_MAX_HEIGHT_M = 20.0
_MAX_WALL_M = 0.8
"""Of walls of a plan; the second is their thickness."""

BODIES = ("model", "actuator", "gripper")
"""Kinds that have a body by default, besides robots."""

_DOORS = {"door": "normal", "fireproof_door": "fireproof"}
"""Names of definitions that are doors, with the kind of the door."""

_MOST_CHARACTERS = 80
"""Of a model's name; those of its walls and blocks are longer."""

_TINY = np.finfo(float).eps
_NARROWEST_M = 1e-5
"""Narrower bodies are lines."""

Shapes = tuple[np.ndarray, ...]
"""Outlines [m], corners in order."""


@dataclass(frozen=True, slots=True)
class Body:
    """Outlines in the frame of a model's pose [m], corners in order, and their extent in height [m]."""

    outlines: Shapes
    bottom_m: float
    top_m: float


def body_of(entity: Entity, values: Values) -> Body:
    """Return the body of a model without a bitmap: its blocks, or else a box.

    As in Stage, all blocks together are stretched to the model's size around its origin (Stage 4.3, blockgroup.cc).

    Raises: ScenarioError: too few numbers, or texts.
    """
    size = values.size(entity, _SIZES_M.get(entity.kind, DEFAULT_SIZE_M))
    origin, z = values.pose(entity, "origin")
    found = entity.of_kind("block")
    blocks = [points for points in (_points(block, values) for block in found) if len(points)]
    spans = [values.numbers(block, "z", "ll", (0.0, 1.0)) for block in found] or [(0.0, 1.0)]
    if not blocks:
        if found or entity.kind not in (*BODIES, "position") or values.whole(entity, "noblocks", 0):
            return Body((), z, z)
        blocks = [np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])]
    low, high = (pick(np.concatenate(blocks), axis=0) for pick in (np.min, np.max))
    span = np.maximum(high - low, _TINY)
    scaled = [(points - (low + 0.5 * span)) * (np.array(size[:2]) / span) for points in blocks]
    stretch = size[2] / max(max(high for _, high in spans) - min(low for low, _ in spans), _TINY)
    bottom = z + min(low for low, _ in spans) * stretch
    return Body(tuple(moved(points, origin) for points in scaled), bottom, bottom + size[2])


def _points(block: Entity, values: Values) -> np.ndarray:
    """Return the corners of a block, shape (n, 2); as in Stage, those that are missing are at 0."""
    count = min(values.whole(block, "points", 0), 10_000)
    points = [values.numbers(block, f"point[{i}]", "ll", (0.0, 0.0)) for i in range(count)]
    missing = [i for i in range(count) if block.get(f"point[{i}]") is None]
    if missing or count < 1:
        text = f"point[{missing[0]}] is missing and counts as [0 0], as in Stage" if missing else "no points: omitted"
        values.notes.of(block, "points", text)
    return np.array(points).reshape(-1, 2)


def polygons(outline: np.ndarray) -> list[np.ndarray]:
    """Return the valid polygons of an outline, shape (n, 2): parts of one that crosses itself, a strip of a line."""
    shape = shapely.Polygon(outline) if len(outline) > 2 else shapely.Polygon()
    if shape.is_valid and _has_area(shape):
        return [outline]
    parts = list(filter(_has_area, shapely.get_parts(shapely.make_valid(shape))))
    path = shapely.LineString(outline if len(outline) > 1 else np.repeat(outline, 2, axis=0))
    line = path.buffer(0.5 * THIN_M, cap_style="square", join_style="mitre")
    return [np.array(part.exterior.coords[:-1]) for part in parts or [line]]


def _has_area(shape: shapely.Geometry) -> bool:
    """Whether a shape has an area, and keeps it where corners are rounded to whole micrometres."""
    return shape.area >= MIN_AREA_M2 and not shape.buffer(-0.5 * _NARROWEST_M).is_empty


class SolidReader:
    """Collects the walls, blocks and doors of top-level models and of the models on them."""

    def __init__(self, folder: Path, values: Values, starts: Sequence[Point], *, grey_as_stage: bool) -> None:
        """Args: folder: of the world file; paths of bitmaps are relative to it. starts: where robots start [m].
        grey_as_stage: whether a pixel of a bitmap is solid by Stage's rule instead of by that of every import.
        """
        self.walls: list[Wall] = []
        self.blocks: list[Block] = []
        self.doors: list[Door] = []
        self.floor: dict[str, list[Point]] = {}
        """Corners of models called `floor` that nothing hits or sees, by name: the bounds of the plan [m]."""
        self._folder, self._values, self.notes = folder, values, values.notes
        self._starts = shapely.points(np.array(starts).reshape(-1, 2))
        self._grey_as_stage = grey_as_stage
        self._names: dict[str, int] = {}
        """The number of the last model of each name."""

    def add(self, entity: Entity, parent: Pose2, base_z_m: float, tallest_m: float) -> None:
        """Add the body of a model and of its children.

        Args:   parent: the frame that the model's pose is given in, and its z.
                tallest_m: of the robots; bodies above it are omitted.
        Raises: ScenarioError: one line with file, line and key.
        """
        values = self._values
        local, z = values.pose(entity, "pose")
        pose, size = compose(parent, local), values.size(entity, DEFAULT_SIZE_M)
        centre = compose(pose, values.pose(entity, "origin")[0])
        name = self._unused_name(values.text(entity, "name", entity.called))
        is_box = (
            not entity.of_kind("block") and entity.get("bitmap") is None and not values.whole(entity, "noblocks", 0)
        )
        obstacle = values.whole(entity, "obstacle_return", 1) != 0
        if entity.called == "floor" and not obstacle:
            self.floor[name] = [_point(corner) for corner in moved(box(size), centre)]
        if is_box and entity.called in _DOORS and size[1] <= 0.2:
            self._add_door(entity, centre, size, name, obstacle)
        elif self._is_solid(entity, obstacle):
            own = len(self.walls), len(self.blocks)
            if entity.get("bitmap") is None or not self._add_bitmap(entity, centre, size, name):
                self._add_body(entity, pose, base_z_m + z, tallest_m, name)
            if values.whole(entity, "boundary", 0) and not is_box and not entity.of_kind("block"):
                self._add_boundary(centre, size, name, own)
        stacked = size[2] if values.whole(entity, "stack_children", 1) else 0.0
        for child in entity.of_kind(*BODIES):
            with self.notes.refusals():
                self.add(child, pose, base_z_m + z + stacked, tallest_m)

    def _is_solid(self, entity: Entity, obstacle: bool) -> bool:
        """Whether a model is an obstacle, or lasers detect it; with a note if it is only one of both."""
        if entity.of_kind("position"):
            self.notes.say(entity.place, f"'{entity.called}' omitted: a robot stands on it")
            return False
        seen = self._values.number(entity, "ranger_return", "f", 1.0) >= 0.0
        seen = seen and self._values.whole(entity, "laser_return", 1) != 0
        if seen and not obstacle:
            text = f"robots cannot drive through '{entity.called}' here; in Stage only lasers are stopped"
            self.notes.of(entity, "obstacle_return", text)
        if obstacle and not seen:
            key = "ranger_return" if entity.get("ranger_return") else "laser_return"
            self.notes.of(entity, key, f"lasers see '{entity.called}' here; in Stage it only stops robots")
        return obstacle or seen

    def _add_door(self, entity: Entity, centre: Pose2, size: tuple[float, ...], name: str, closed: bool) -> None:
        """Add a box that is called a door, as `plan export-stage` writes it: an open one is no obstacle."""
        self._values.number(entity, "ranger_return", "f", 1.0)
        if min(size[:2]) < _NARROWEST_M:
            raise entity.error("size", f"a door of {size[0]:g} x {size[1]:g} m; expected at least {_NARROWEST_M:g} m")
        start, end = (_point(end) for end in moved(np.array([[-0.5 * size[0], 0.0], [0.5 * size[0], 0.0]]), centre))
        keys = {"name": name, "start": start, "end": end, "kind": _DOORS[entity.called], "closed": closed}
        self.doors.append(Door.model_validate({**keys, "thickness_m": tidy(size[1]), **_height(size[2])}))

    def _add_bitmap(self, entity: Entity, centre: Pose2, size: tuple[float, ...], name: str) -> bool:
        """Add the solid pixels of a bitmap; False: they are so small that a box of its size takes their place."""
        if entity.of_kind("block"):
            self.notes.of(entity, "bitmap", "the blocks next to it are omitted")
        solid = self._read_bitmap(entity, size)
        if solid is None:
            return True
        rows, columns = solid.shape
        cell = (size[0] / columns, size[1] / rows)
        if min(cell) < MIN_PIXEL_M:
            self.notes.of(entity, "bitmap", f"pixels below {MIN_PIXEL_M * 1000.0:g} mm: becomes a box of its size")
            return False
        walls, blocks = walls_and_blocks(solid, (-0.5 * size[0], -0.5 * size[1]), cell)
        height = _height(size[2])
        for wall in walls:
            start, end = (_point(corner) for corner in moved(np.array([wall.start, wall.end]), centre))
            update = {"start": start, "end": end, "name": f"{name}_{wall.name}", **height}
            self.walls.append(wall.model_copy(update=update))
        for block in blocks:
            polygon = tuple(_point(corner) for corner in moved(np.array(block.polygon), centre))
            update = {"polygon": polygon, "name": f"{name}_{block.name}", **height}
            self.blocks.append(block.model_copy(update=update))
        return True

    def _read_bitmap(self, entity: Entity, size: tuple[float, ...]) -> np.ndarray | None:
        """Return which cells of a bitmap are solid, cropped to its dark pixels as Stage does; row 0 at the lowest y.

        None: there are none.
        """
        image = self._read_image(entity)
        # Stage uses the first channel, red (Stage 4.3, stage.cc: polys_from_image_file).
        stage = np.flipud((image if image.ndim == 2 else image[:, :, 0]) <= _FREE_ABOVE)
        if not stage.any():
            self.notes.of(entity, "bitmap", "no pixel is dark: nothing is solid, as in Stage")
            return None
        rows, columns = np.flatnonzero(stage.any(axis=1)), np.flatnonzero(stage.any(axis=0))
        crop = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        as_stage = without_corner_contacts(stage[crop])
        edge_m = math.sqrt(size[0] * size[1] / as_stage.size)
        if self._grey_as_stage or edge_m < MIN_PIXEL_M:
            return as_stage
        dark = darkness(lightness(image, negate=False, with_alpha=False))[crop]
        solid = solid_cells(dark, OCCUPIED_THRESH, FREE_THRESH, edge_m, closed=False)
        differing = int(np.count_nonzero(solid != as_stage))
        if differing:
            text = f"{counted(differing, 'pixel')} neither black nor white, or too small for a wall, are read "
            self.notes.of(entity, "bitmap", f"{text}differently from Stage; --grey as-stage reads them as Stage does")
        return solid

    def _read_image(self, entity: Entity) -> np.ndarray:
        file = self._values.text(entity, "bitmap", "")
        path = self._folder / file
        if not is_file(path):
            raise entity.error("bitmap", f"there is no file {shown(file)}")
        try:
            return read_image(path)
        except ValueError as error:
            raise entity.error("bitmap", f"{shown(file)} {error}") from None

    def _add_body(self, entity: Entity, pose: Pose2, z_m: float, tallest_m: float, name: str) -> None:
        body = body_of(entity, self._values)
        if body.outlines and z_m + body.bottom_m >= tallest_m:
            text = f"'{name}' omitted: it is at {z_m + body.bottom_m:g} m, above all robots"
            self.notes.say(entity.place_of("pose"), text)
            return
        height, thickness_m = _height(body.top_m - body.bottom_m), self._values.size(entity, DEFAULT_SIZE_M)[1]
        shapes = [moved(polygon, pose) for outline in body.outlines for polygon in polygons(outline)]
        if sum(map(len, shapes)) != sum(map(len, body.outlines)):
            text = f"block: a line becomes {THIN_M:g} m wide, an outline that crosses itself its parts"
            self.notes.say(entity.place, text)
        for i, shape in enumerate(shapes):
            part = name if len(shapes) == 1 else f"{name}_part_{i + 1}"
            corners = tuple(map(_point, shape))
            if shapely.contains(shapely.Polygon(corners), self._starts).any():
                self._add_hollow(entity, corners, part, height)
            elif entity.called == "wall" and not entity.of_kind("block") and thickness_m <= _MAX_WALL_M:
                start, end = _point(0.5 * (shape[0] + shape[3])), _point(0.5 * (shape[1] + shape[2]))
                keys = {"name": part, "start": start, "end": end, "thickness_m": thickness_m}
                self.walls.append(Wall.model_validate({**keys, **height}))
            else:
                kind = "pillar" if entity.called == "pillar" else "block"
                self.blocks.append(Block.model_validate({"name": part, "kind": kind, "polygon": corners, **height}))

    def _add_hollow(self, entity: Entity, corners: Corners, name: str, height: dict[str, float]) -> None:
        """Add a body in which a robot starts: walls along its outline, as bodies are hollow in Stage, or nothing."""
        if self._values.whole(entity, "obstacle_return", 1) == 0:
            self.notes.say(entity.place, f"'{name}' omitted: it is no obstacle, and a robot starts in it")
            return
        self.notes.say(entity.place, f"'{name}' is hollow, as in Stage: a robot starts in it")
        for i, ends in enumerate(zip(corners, (*corners[1:], corners[0]), strict=True)):
            keys = {"name": f"{name}_side_{i + 1}", "start": ends[0], "end": ends[1], "thickness_m": THIN_M}
            self.walls.append(Wall.model_validate({**keys, **height}))

    def _add_boundary(self, centre: Pose2, size: tuple[float, ...], name: str, own: tuple[int, int]) -> None:
        """Add thin walls along the size, where the model itself has none. Args: own: its first wall and block."""
        x, y, half = 0.5 * size[0], 0.5 * size[1], 0.5 * THIN_M
        sides = {
            "south": ((-x, half - y), (x, half - y)),
            "north": ((-x, y - half), (x, y - half)),
            "west": ((half - x, THIN_M - y), (half - x, y - THIN_M)),
            "east": ((x - half, THIN_M - y), (x - half, y - THIN_M)),
        }
        outlines = [*map(wall_corners, self.walls[own[0] :]), *(block.polygon for block in self.blocks[own[1] :])]
        solid = shapely.union_all([shapely.Polygon(outline) for outline in outlines]).buffer(1e-5)
        for side, ends in sides.items() if min(x, y) > THIN_M else ():
            start, end = (_point(corner) for corner in moved(np.array(ends), centre))
            wall = Wall(name=f"{name}_boundary_{side}", start=start, end=end, thickness_m=THIN_M)
            if not solid.covers(shapely.Polygon(wall_corners(wall))):
                self.walls.append(wall.model_copy(update=_height(size[2])))

    def _unused_name(self, wanted: str) -> str:
        """Return a name that no other model has; plans have printable names of a limited length."""
        wanted = printable(wanted)[:_MOST_CHARACTERS] or "model"
        name, number = wanted, self._names.get(wanted, 0) + 1
        while number > 1 and (name := f"{wanted}_{number}") in self._names:
            number += 1
        self._names |= {wanted: number, name: self._names.get(name, 1)}
        return name


def _height(height_m: float) -> dict[str, float]:
    """Return the key for a height; a flat body gets the default."""
    return {"height_m": min(height_m, _MAX_HEIGHT_M)} if height_m > 0.0 else {}


def box(size: tuple[float, ...]) -> np.ndarray:
    """Return the corners of a box around 0, shape (4, 2)."""
    return np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * size[:2]


def moved(points: np.ndarray, pose: Pose2) -> np.ndarray:
    """Return points, shape (n, 2), given in the frame of a pose, in the frame that the pose is given in."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    # Quarter turns are exact, so that upright walls stay upright.
    cos, sin = (0.0 if abs(value) < 1e-12 else value for value in (cos, sin))
    turned: np.ndarray = points @ np.array([[cos, sin], [-sin, cos]]) + np.array(pose[:2])
    return turned


def _point(corner: np.ndarray) -> Point:
    # In whole micrometres, without digits from rounding.
    x, y = np.round(corner, 6).tolist()
    return x + 0.0, y + 0.0

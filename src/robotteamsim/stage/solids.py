"""The bodies of Stage's models as walls and blocks of a floor plan."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from pydantic import ValidationError

from robotteamsim.map_import.cells import (
    FREE_THRESH,
    OCCUPIED_THRESH,
    darkness,
    lightness,
    read_image,
    solid_cells,
    without_corner_contacts,
)
from robotteamsim.scenario.body import MAX_CORNERS
from robotteamsim.scenario.floor_plan import Block, Wall
from robotteamsim.scenario.image_walls import walls_and_blocks
from robotteamsim.scenario.plan import Corners, counter_clockwise, wall_corners
from robotteamsim.scenario.problems import problems
from robotteamsim.scenario.yaml_text import is_file, shown
from robotteamsim.stage.values import Notes, Pose2, Values, compose, tidy
from robotteamsim.stage.world_file import Entity
from robotteamsim.wording import counted

DEFAULT_SIZE_M = (0.4, 0.4, 1.0)
"""Default of `size` (Stage 4)."""

BOUNDARY_M = 0.01
"""Thickness of the walls of `boundary 1`."""

MIN_PIXEL_M, MAX_PIXEL_M = 0.001, 10.0
"""Sizes of a bitmap's pixels."""

_FREE_ABOVE = 127
"""A lighter pixel of a bitmap is free in Stage."""

_MAX_HEIGHT_M = 20.0

MAX_GAP_SHARE = 0.01
"""A body counts as convex if at most this share of its convex hull is missing."""


MOST_CHARACTERS = 80
"""Of a model's name; those of its walls and blocks are longer."""


@dataclass(frozen=True, slots=True)
class Body:
    """Outlines in the frame of a model's pose [m], corners in order, and their extent in height [m]."""

    outlines: tuple[np.ndarray, ...]
    bottom_m: float
    top_m: float


def body_of(entity: Entity, values: Values) -> Body:
    """Return the body of a model without a bitmap: its blocks, or else a box.

    As in Stage, all blocks together are stretched to the model's size around its origin.

    Raises: ScenarioError: a block without area or points, a size of 0.
    """
    size = values.size(entity, DEFAULT_SIZE_M)
    origin, z = values.pose(entity, "origin")
    blocks = [_points(block, values) for block in entity.of_kind("block")]
    spans = [values.numbers(block, "z", "ll", (0.0, 1.0)) for block in entity.of_kind("block")]
    if not blocks:
        if values.whole(entity, "noblocks", 0):
            return Body((), z, z)
        blocks, spans = [np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])], [(0.0, 1.0)]
    corners = np.concatenate(blocks)
    low, high = corners.min(axis=0), corners.max(axis=0)
    if (high - low).min() <= 0.0:
        raise entity.of_kind("block")[0].place.error("block: its points enclose no area")
    scaled = [(points - 0.5 * (low + high)) * (np.array(size[:2]) / (high - low)) for points in blocks]
    stretch = size[2] / max(max(high for _, high in spans) - min(low for low, _ in spans), 1e-9)
    bottom = z + min(low for low, _ in spans) * stretch
    return Body(tuple(_moved(points, origin) for points in scaled), bottom, bottom + size[2])


def _points(block: Entity, values: Values) -> np.ndarray:
    count = values.whole(block, "points", 0)
    if not 3 <= count <= 10_000:
        raise block.error("points", f"{count} is not from 3 to 10000")
    for i in range(count):
        if block.get(f"point[{i}]") is None:
            raise block.error("points", f"there are {count}, but point[{i}] is missing")
    return np.array([values.numbers(block, f"point[{i}]", "ll", (0.0, 0.0)) for i in range(count)])


class SolidReader:
    """Collects the walls and blocks of top-level models and of the models on them."""

    def __init__(self, folder: Path, values: Values, notes: Notes) -> None:
        """Args: folder: of the world file; paths of bitmaps are relative to it."""
        self.walls: list[Wall] = []
        self.blocks: list[Block] = []
        self._folder, self._values, self._notes = folder, values, notes
        self._outlines: list[shapely.Polygon] = []
        self._num_outlined = 0, 0
        """Of walls and of blocks, how many are among the outlines."""
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
        name = self._unused_name(values.text(entity, "name", entity.called))
        if len(name) > MOST_CHARACTERS or not name.isprintable():
            raise entity.error("name", f"{shown(name)}; expected at most {MOST_CHARACTERS} characters, all printable")
        if self._blocks_anything(entity):
            if entity.get("bitmap") is not None:
                self._add_bitmap(entity, pose, size, name)
            else:
                self._add_body(entity, pose, base_z_m + z, tallest_m, name)
            if values.whole(entity, "boundary", 0):
                self._add_boundary(entity, pose, size, name)
        stacked = size[2] if values.whole(entity, "stack_children", 1) else 0.0
        for child in entity.of_kind("model"):
            self.add(child, pose, base_z_m + z + stacked, tallest_m)

    def _blocks_anything(self, entity: Entity) -> bool:
        """Whether this model is an obstacle that lasers detect. Raises: ScenarioError: only one of both."""
        obstacle = self._values.whole(entity, "obstacle_return", 1) != 0
        seen = self._values.number(entity, "ranger_return", "f", 1.0) >= 0.0
        seen = seen and self._values.whole(entity, "laser_return", 1) != 0
        if obstacle != seen:
            of_sensor = "ranger_return" if entity.get("ranger_return") else "laser_return"
            what = "seen by lasers but no obstacle" if seen else "an obstacle that lasers do not see"
            text = f"'{entity.called}' would be {what}; expected both or neither"
            raise entity.error("obstacle_return" if seen else of_sensor, text)
        return obstacle

    def _add_bitmap(self, entity: Entity, pose: Pose2, size: tuple[float, ...], name: str) -> None:
        if entity.of_kind("block"):
            raise entity.error("bitmap", "expected a model without blocks")
        solid = self._read_bitmap(entity, size)
        rows, columns = solid.shape
        cell = (size[0] / columns, size[1] / rows)
        if not (min(cell) >= MIN_PIXEL_M and max(cell) <= MAX_PIXEL_M):
            text = f"pixels would be {cell[0]:.3g} x {cell[1]:.3g} m; expected {MIN_PIXEL_M:g} to {MAX_PIXEL_M:g} m"
            raise entity.error("size", text)
        walls, blocks = walls_and_blocks(solid, (-0.5 * size[0], -0.5 * size[1]), cell)
        body = compose(pose, self._values.pose(entity, "origin")[0])
        height = _height(size[2])
        for wall in walls:
            ends = [_moved(np.array([end]), body)[0] for end in (wall.start, wall.end)]
            update = {"start": _point(ends[0]), "end": _point(ends[1]), "name": f"{name}_{wall.name}", **height}
            self.walls.append(wall.model_copy(update=update))
        for block in blocks:
            polygon = tuple(_point(corner) for corner in _moved(np.array(block.polygon), body))
            update = {"polygon": polygon, "name": f"{name}_{block.name}", **height}
            self.blocks.append(block.model_copy(update=update))

    def _read_bitmap(self, entity: Entity, size: tuple[float, ...]) -> np.ndarray:
        """Return which cells of a bitmap are solid, cropped to its dark pixels as Stage does; row 0 at the lowest y."""
        image = self._read_image(entity)
        # Stage uses the first channel, red.
        stage = np.flipud((image if image.ndim == 2 else image[:, :, 0]) <= _FREE_ABOVE)
        if not stage.any():
            raise entity.error("bitmap", f"no pixel of '{self._values.text(entity, 'bitmap', '')}' is dark")
        rows, columns = np.flatnonzero(stage.any(axis=1)), np.flatnonzero(stage.any(axis=0))
        crop = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        dark = darkness(lightness(image, negate=False, with_alpha=False))[crop]
        edge_m = math.sqrt(abs(size[0] * size[1]) / dark.size)
        if not edge_m >= MIN_PIXEL_M:
            return stage[crop]  # the size is rejected
        solid = solid_cells(dark, OCCUPIED_THRESH, FREE_THRESH, edge_m, closed=False)
        differing = int(np.count_nonzero(solid != without_corner_contacts(stage[crop])))
        if differing:
            text = f"bitmap: {counted(differing, 'pixel')} neither black nor white, or too small for a wall, "
            self._notes.say(entity.place_of("bitmap"), f"{text}are read differently from Stage")
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
            self._notes.say(entity.place_of("pose"), text)
            return
        height = _height(body.top_m - body.bottom_m)
        for i, outline in enumerate(body.outlines):
            polygon = tuple(_point(corner) for corner in _moved(outline, pose))
            part = name if len(body.outlines) == 1 else f"{name}_part_{i + 1}"
            try:
                self.blocks.append(Block.model_validate({"name": part, "polygon": polygon, **height}))
            except ValidationError as error:
                block = entity.of_kind("block")[i] if entity.of_kind("block") else entity
                raise block.place.error(f"{block.called}: {problems(error, Block)[0].text}") from None

    def _add_boundary(self, entity: Entity, pose: Pose2, size: tuple[float, ...], name: str) -> None:
        body = compose(pose, self._values.pose(entity, "origin")[0])
        x, y, half = 0.5 * size[0], 0.5 * size[1], 0.5 * BOUNDARY_M
        if min(size[0], size[1]) <= 2.0 * BOUNDARY_M:
            raise entity.error("boundary", f"does not fit into a model of {size[0]:g} x {size[1]:g} m")
        sides = {
            "south": ((-x, half - y), (x, half - y)),
            "north": ((-x, y - half), (x, y - half)),
            "west": ((half - x, BOUNDARY_M - y), (half - x, y - BOUNDARY_M)),
            "east": ((x - half, BOUNDARY_M - y), (x - half, y - BOUNDARY_M)),
        }
        self._add_outlines()
        outlines = np.array(self._outlines)
        for side, ends in sides.items():
            start, end = (_point(corner) for corner in _moved(np.array(ends), body))
            wall = Wall(name=f"{name}_boundary_{side}", start=start, end=end, thickness_m=BOUNDARY_M)
            strip = shapely.Polygon(wall_corners(wall))
            near = outlines[shapely.intersects(outlines, strip)] if len(outlines) else []
            if not shapely.union_all(near).buffer(1e-5).covers(strip):
                self.walls.append(wall.model_copy(update=_height(size[2])))

    def _add_outlines(self) -> None:
        """Add the outlines of the walls and blocks since the last call."""
        walls, blocks = self.walls[self._num_outlined[0] :], self.blocks[self._num_outlined[1] :]
        outlines = [*map(wall_corners, walls), *(block.polygon for block in blocks)]
        self._outlines += [shapely.Polygon(outline) for outline in outlines]
        self._num_outlined = len(self.walls), len(self.blocks)

    def _unused_name(self, wanted: str) -> str:
        name, number = wanted, self._names.get(wanted, 0) + 1
        while number > 1 and (name := f"{wanted}_{number}") in self._names:
            number += 1
        self._names |= {wanted: number, name: self._names.get(name, 1)}
        return name


def _height(height_m: float) -> dict[str, float]:
    """Return the key for a height; a flat body gets the default."""
    return {"height_m": min(height_m, _MAX_HEIGHT_M)} if height_m > 0.0 else {}


def disc_radius_m(body: Body) -> float | None:
    """Return the radius of a body that is a disc around the model's pose, as a polygon; None: it is not a disc."""
    if len(body.outlines) != 1 or len(body.outlines[0]) < 8:
        return None
    distances = np.hypot(*body.outlines[0].T)
    inner = shapely.LinearRing(body.outlines[0]).distance(shapely.Point(0.0, 0.0))
    round_enough = distances.max() - distances.min() < 0.02 * distances.max() and inner > 0.9 * distances.max()
    return float(distances.max()) if round_enough else None


def footprint_m(body: Body) -> Corners:
    """Return the corners of a body that is a valid footprint around the model's pose; empty: it is not."""
    shapes = [shapely.Polygon(outline) for outline in body.outlines]
    if not shapes or not all(shape.is_valid for shape in shapes):
        return ()
    # Without collinear corners; in whole nanometres, without digits from rounding.
    hull = shapely.convex_hull(shapely.union_all(shapes)).simplify(1e-9)
    corners = tuple((tidy(x), tidy(y)) for x, y in hull.exterior.coords[:-1])
    is_whole = hull.area - shapely.union_all(shapes).area <= MAX_GAP_SHARE * hull.area
    if not is_whole or len(corners) > MAX_CORNERS or not hull.contains(shapely.Point(0.0, 0.0)):
        return ()
    return counter_clockwise(corners)


def reach_m(body: Body) -> float:
    """Return the largest distance of a body from the model's pose [m]; 0 without a body."""
    return max((float(np.hypot(*outline.T).max()) for outline in body.outlines), default=0.0)


def _moved(points: np.ndarray, pose: Pose2) -> np.ndarray:
    """Return points, shape (n, 2), given in the frame of a pose, in the frame that the pose is given in."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    # Quarter turns are exact, so that upright walls stay upright.
    cos, sin = (0.0 if abs(value) < 1e-12 else value for value in (cos, sin))
    moved: np.ndarray = points @ np.array([[cos, sin], [-sin, cos]]) + np.array(pose[:2])
    return moved


def _point(corner: np.ndarray) -> tuple[float, float]:
    # In whole micrometres, without digits from rounding.
    x, y = np.round(corner, 6).tolist()
    return x + 0.0, y + 0.0

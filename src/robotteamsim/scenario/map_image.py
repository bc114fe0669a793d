"""Floor plans and occupancy grids as images of map_server: a yaml, and a pgm or png."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
import shapely
from pydantic import BeforeValidator, ConfigDict, Field

from robotteamsim.cache import cached
from robotteamsim.errors import ScenarioError
from robotteamsim.map_import.cells import (
    FREE_THRESH,
    OCCUPIED_THRESH,
    darkness,
    lightness,
    read_image,
    solid_cells,
)
from robotteamsim.map_import.paper import on_white_paper
from robotteamsim.map_import.strokes import Gap, GapSizes, exits, gaps, outer_gaps, small_groups, thin_strokes
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS, Model, PlanarPose, Point
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.image_walls import MAX_WALL_THICKNESS_M, MIN_PIECE_M2, in_metres, walls_and_blocks
from robotteamsim.scenario.plan import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Grid,
    OccupancyGrid,
    beside_levels,
    occupancy_grid,
    too_many_cells,
)
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.yaml_text import is_file, read_mapping, shown
from robotteamsim.wording import printable

DOOR_CELL_M = 0.02
"""Cells in which gaps of a plan without an image are searched, if they are not too many."""

DOOR_CELLS = 4_000_000
"""Most of them; each width of a gap is searched in all."""

LOOSE_M = 2.0
"""Objects that are smaller and touch no wall are no ends of gaps, unless they are strips."""

PANE_M = 0.08
"""Thinner lines across a gap in an outer wall are a window."""

LINED = 0.8
"""Of the width of the gap, the least share that such lines cover."""

OPEN_M = 2.5
"""Gaps up to this width do not join the inside of a building with its outside."""

OPEN_CELL_M = 0.05

ROBOT_M = 0.2
"""Radius of the robot that may leave through a gap."""

LEAST_M2 = 4.0
"""Smaller places that are hard to reach from outside are niches of the outer wall."""

CACHED_PIXELS = 200_000
"""Plans of larger images are kept in the cache."""

Line = TypeVar("Line", Wall, Door)
Window = tuple[tuple[slice, slice], Wall]
"""Its cells, and the glass in them."""


def _unquoted(value: Any) -> Any:
    """Return the number that a quoted scalar contains: yaml-cpp, which map_server uses, converts `'0.05'` as 0.05."""
    if isinstance(value, list):
        return [_unquoted(item) for item in value]
    if not isinstance(value, str):
        return value
    try:
        number = float(value)
    except ValueError:
        return value
    return int(number) if number.is_integer() else number


_Unquoted = BeforeValidator(_unquoted)
_Share = Annotated[float, Field(ge=0.0, le=1.0), _Unquoted]


class MapFile(Model):
    """The yaml of a map_server image; keys that map_server does not know are ignored, as it ignores them.

    The thresholds may be equal or swapped, 0 or 1: map_server 1.17 compares each pixel with both, first with
    `occupied_thresh`, and does not check their order [image_loader.cpp].
    """

    model_config = ConfigDict(extra="ignore")

    image: str = Field(min_length=1, description="image file, relative to this file")
    resolution: Annotated[float, _Unquoted] = Field(ge=0.001, le=10.0, description="edge of a pixel [m]")
    origin: Annotated[PlanarPose, _Unquoted] = Field(description="[x, y, yaw] of the lower left pixel's corner")
    negate: Annotated[Literal[0, 1, False, True], _Unquoted] = Field(default=0, description="1: white is occupied")
    occupied_thresh: _Share = Field(default=OCCUPIED_THRESH, description="darker than this share is occupied")
    free_thresh: _Share = Field(default=FREE_THRESH, description="lighter than this share is free, if not occupied")
    mode: Literal["trinary", "scale", "raw"] = Field(default="trinary", description="of the values on /map")

    @property
    def import_thresholds(self) -> tuple[float, float]:
        """`occupied_thresh` and `free_thresh` for a floor plan: the usual one for 1 and 0, which no pixel can pass.

        They are the usual pair of masks in mode `scale`, such as those of nav2's speed filter.
        """
        occupied = self.occupied_thresh if self.occupied_thresh < 1.0 else OCCUPIED_THRESH
        return occupied, self.free_thresh if self.free_thresh > 0.0 else FREE_THRESH


@dataclass(frozen=True, slots=True, eq=False)
class MapImage:
    """A map: its yaml and the pixels of its image, see `read_image`; of a drawing, what `Paper` has."""

    settings: MapFile
    pixels: np.ndarray
    grey_share: float = 0.0
    turn_deg: float = 0.0

    @property
    def dark(self) -> np.ndarray:
        """How dark each pixel is, see `map_import.cells.darkness`."""
        return darkness(self._light)

    @property
    def free(self) -> np.ndarray:
        """Which pixels are floor in a plan, bool, shape (rows, cols), row 0 at the lowest y."""
        occupied_thresh, free_thresh = self.settings.import_thresholds
        dark = self.dark
        return np.asarray((dark < free_thresh) & (dark <= occupied_thresh))

    def is_free_at(self, place: Point) -> bool:
        """Whether the pixel at a place in the map frame [m] is floor; outside the image, none is."""
        settings = self.settings
        x, y = _Turn((*settings.origin[:2], -settings.origin[2])).points((place,))[0]
        free = self.free
        row, column = Grid(settings.origin[:2], settings.resolution).cell_at(x, y)
        return 0 <= row < free.shape[0] and 0 <= column < free.shape[1] and bool(free[row, column])

    @property
    def _light(self) -> np.ndarray:
        settings = self.settings
        return lightness(self.pixels, negate=bool(settings.negate), with_alpha=settings.mode == "trinary")

    def occupancy_grid(self) -> OccupancyGrid:
        """Return the grid that map_server publishes [map_server 1.17, image_loader.cpp].

        It is equal cell by cell for grey and RGB images of 8 bits. SDL_image gives map_server the indexes of a palette,
        TIFF with a fourth byte and the blue of BMP first; here, all count by their colours.

        trinary: 100 where darker than `occupied_thresh`, 0 where lighter than `free_thresh`, else -1. scale: from 1 to
        99 between the thresholds, -1 where the last channel is 0. raw: the mean of the colours in 8 bits, signed.
        """
        settings, light = self.settings, self._light
        if settings.mode == "raw":
            cells = light.astype(np.uint8).view(np.int8)
        else:
            dark = darkness(light)
            low, high = settings.free_thresh, settings.occupied_thresh
            between = np.full(dark.shape, UNKNOWN, dtype=np.int8)
            if settings.mode == "scale":
                share = np.clip((dark - low) / (high - low), 0.0, 1.0) if high > low else np.zeros(dark.shape)
                between = np.where(self._last_channel == 0, UNKNOWN, 1.0 + 98.0 * share).astype(np.int8)
            cells = np.where(dark > high, OCCUPIED, np.where(dark < low, FREE, between)).astype(np.int8)
        return OccupancyGrid(settings.origin[:2], settings.resolution, cells)

    @property
    def _last_channel(self) -> np.ndarray:
        """What map_server takes for the alpha channel: without one, blue; of grey, 1."""
        if self.pixels.ndim == 2:
            return np.ones(self.pixels.shape, np.uint8)
        upright: np.ndarray = np.flipud(self.pixels[:, :, -1])
        return upright


def read_map(path: Path) -> MapImage:
    """Return the map of a yaml.

    Raises: ScenarioError: one line with file, key, value and what was expected.
    """
    data = read_mapping(path, str(path), "the yaml of a map")
    if "bounds" in data:
        raise ScenarioError(f"{path}: is a floor plan already; expected the yaml of an image")
    settings = checked(MapFile, data, place=f"{path}: ")
    image_path = path.parent / settings.image
    if not is_file(image_path):
        raise ScenarioError(f"{path}: image: there is no file {shown(settings.image)}")
    return MapImage(settings, _pixels(image_path, f"{path}: image: '{settings.image}'"))


def _pixels(path: Path, place: str, *, as_shown: bool = False) -> np.ndarray:
    """Return the pixels of an image. Raises: ScenarioError: it cannot be read, or is too small or too large."""
    try:
        pixels = read_image(path, as_shown=as_shown)
    except ValueError as error:
        raise ScenarioError(f"{place} {error}") from None
    if min(pixels.shape[:2]) < 3:
        raise ScenarioError(f"{place} has fewer than 3 rows or columns")
    return pixels


def read_drawing(path: Path, resolution_m: float) -> MapImage:
    """Return an image without a yaml, as viewers show it, as a map whose lower left corner is the origin.

    Args:   resolution_m: edge of a pixel [m]; pixels below `paper.FINE_M` become larger ones.
    Raises: ScenarioError: one line with file and what was expected.
    """
    if not is_file(path):
        raise ScenarioError(f"{path}: {'is a folder, expected an image' if path.is_dir() else 'there is no such file'}")
    values = {"image": path.name, "resolution": resolution_m, "origin": [0.0, 0.0, 0.0]}
    settings = checked(MapFile, values, place=f"{path}: ")
    paper = on_white_paper(_pixels(path, str(path), as_shown=True), resolution_m)
    settings = settings.model_copy(update={"resolution": paper.cell_m})
    return MapImage(settings, paper.pixels, paper.grey_share, paper.turn_deg)


@dataclass(frozen=True, slots=True)
class DrawingRules:
    """What of an image is a wall, and which gaps are doors. The defaults take all ink, and make no doors.

    thinnest_m: thinner strokes are no walls, such as text, dimension lines and arcs of doors.
    smallest_m: groups of ink that are smaller in width and height are no walls, such as letters.
    doors_m:    least and greatest width of a gap in a wall along an axis that is a door; None: none is.
    windows_m:  the same of a gap in an outer wall, empty or with thin lines, that becomes glass; with both, an empty
                gap as wide as a door is a door.
    """

    thinnest_m: float = 0.0
    smallest_m: float = 0.0
    doors_m: tuple[float, float] | None = None
    windows_m: tuple[float, float] | None = None


def import_map(map_yaml: str | os.PathLike[str]) -> FloorPlan:
    """Return the floor plan of a map_server image, see `import_image`. Raises: ScenarioError."""
    return import_image(read_map(Path(map_yaml)), Path(map_yaml), DrawingRules())


def left_out(image: MapImage, rules: DrawingRules) -> np.ndarray:
    """Return which cells of ink are no walls by the rules, bool, shape (rows, cols), row 0 at the lowest y."""
    ink = ~image.free
    cell_m = image.settings.resolution
    thin = thin_strokes(ink, rules.thinnest_m / cell_m)
    no_wall: np.ndarray = thin | small_groups(ink & ~thin, rules.smallest_m / cell_m)
    return no_wall


def import_image(image: MapImage, path: Path, rules: DrawingRules) -> FloorPlan:
    """Return the floor plan of an image.

    `left_out` decides what is no wall, `map_import.cells.solid_cells` which cells are solid, and
    `image_walls.walls_and_blocks` converts them to walls and blocks. Plans of large images are taken from the cache,
    see `robotteamsim.cache`. A yaw turns the plan about the map's origin.

    Args:   path: of the image or its yaml, for the plan's name and for errors.
    Raises: ScenarioError: one line with file, key, value and what was expected.
    """
    settings, pixels = image.settings, image.pixels
    cell_m = (settings.resolution, settings.resolution)
    columns, rows = pixels.shape[1::-1]
    corners = np.array([(0, 0), (columns, 0), (columns, rows), (0, rows)])
    turn = _Turn(settings.origin)
    frame = turn.points(in_metres(settings.origin[:2], cell_m, corners).tolist())
    low, high = np.min(frame, axis=0).tolist(), np.max(frame, axis=0).tolist()
    bounds = checked(Bounds, {"min": low, "max": high}, place=f"{path}: image: bounds.")
    if not image.free.any():
        if path.name == settings.image:
            raise ScenarioError(f"{path}: no pixel is light; expected dark walls on light paper")
        text = f"no cell of '{settings.image}' is free; is negate or free_thresh wrong?"
        raise ScenarioError(f"{path}: image: {text}")

    name = printable(path.stem)[:MAX_NAME_CHARACTERS]

    def plan() -> FloorPlan:
        dark = np.where(left_out(image, rules), 0.0, image.dark)
        grid = Grid(settings.origin[:2], settings.resolution)
        limits, windows = (*settings.import_thresholds, settings.resolution), []
        if rules.windows_m is not None:
            thin = thin_strokes(~image.free, max(rules.thinnest_m, PANE_M) / settings.resolution)
            windows = _windows(solid_cells(np.where(thin, 0.0, dark), *limits, closed=True), grid, rules, thin)
            for area, _ in windows:
                dark[area] = np.where(thin[area], 0.0, dark[area])
        solid = solid_cells(dark, *limits, closed=True)
        walls, blocks = walls_and_blocks(solid, settings.origin[:2], cell_m)
        walls, doors = [*walls, *(window for _, window in windows)], _doors(solid, grid, rules, windows)
        if settings.origin[2] != 0.0:
            walls, doors = turn.lines(walls), turn.lines(doors)
            blocks = [*turn.blocks(blocks), *_outside(frame, bounds)]
        return FloorPlan(name=name, bounds=bounds, walls=tuple(walls), blocks=tuple(blocks), doors=tuple(doors))

    if pixels.shape[0] * pixels.shape[1] < CACHED_PIXELS:
        return plan()
    keys = f"{name} {settings.model_dump_json()} {pixels.shape} {rules}"
    kept = cached((keys.encode(), pixels.tobytes()), lambda: plan().model_dump_json().encode())
    return FloorPlan.model_validate_json(kept)


class _Turn:
    """The turn of a map about its origin, by the origin's yaw; in whole micrometres, see `in_metres`."""

    def __init__(self, origin: PlanarPose) -> None:
        self._origin_m = np.array(origin[:2])
        cos, sin = math.cos(origin[2]), math.sin(origin[2])
        self._matrix = np.array([[cos, -sin], [sin, cos]])

    def points(self, points: Sequence[Point]) -> tuple[Point, ...]:
        turned_m = np.round(self._origin_m + (np.array(points) - self._origin_m) @ self._matrix.T, 6) + 0.0  # no -0
        return tuple((x, y) for x, y in turned_m.tolist())

    def lines(self, lines: Sequence[Line]) -> list[Line]:
        ends = [self.points((line.start, line.end)) for line in lines]
        return [
            line.model_copy(update={"start": start, "end": end}) for line, (start, end) in zip(lines, ends, strict=True)
        ]

    def blocks(self, blocks: Sequence[Block]) -> list[Block]:
        return [block.model_copy(update={"polygon": self.points(block.polygon)}) for block in blocks]


def _outside(frame: Sequence[Point], bounds: Bounds) -> Iterator[Block]:
    """Yield the corners of the bounds that a turned image does not reach, as blocks outside_1, outside_2, ..."""
    corners = shapely.difference(shapely.box(*bounds.min, *bounds.max), shapely.Polygon(frame))
    large = [corner for corner in shapely.get_parts(corners) if corner.area > MIN_PIECE_M2]
    for number, corner in enumerate(large, 1):
        polygon = tuple((float(x), float(y)) for x, y in shapely.get_coordinates(corner.exterior)[:-1].tolist())
        yield Block(name=f"outside_{number}", polygon=polygon)


def with_openings(plan: FloorPlan, rules: DrawingRules) -> FloorPlan:
    """Return a plan with the windows and doors of some rules in the gaps of walls along the axes, see `gaps`."""
    grid = _grid(plan, DOOR_CELL_M)
    solid = grid.cells == OCCUPIED
    windows = _windows(solid, grid, rules, np.zeros_like(solid))
    walls, doors = (*plan.walls, *(window for _, window in windows)), _doors(solid, grid, rules, windows)
    return plan.model_copy(update={"walls": walls, "doors": tuple(doors)})


def open_places(plan: FloorPlan) -> list[Point] | None:
    """Return where a robot may leave a building whose doors are closed: the middles of gaps in the outer wall.

    None: there is no inside, because each part of the floor has a gap wider than OPEN_M to the outside.
    """
    doors = tuple(door.model_copy(update={"closed": True, "motion": "instant"}) for door in plan.doors)
    grid = _grid(plan.model_copy(update={"doors": doors}), OPEN_CELL_M)
    cell_m = grid.resolution_m
    places = exits(grid.cells == OCCUPIED, OPEN_M / cell_m, ROBOT_M / cell_m, LEAST_M2 / cell_m**2)
    if places is None:
        return None
    return [(round(x, 2), round(y, 2)) for x, y in in_metres(grid.origin_m, (cell_m, cell_m), places + 0.5).tolist()]


def _grid(plan: FloorPlan, cell_m: float) -> OccupancyGrid:
    """Return a plan in cells of that size, or larger ones if there are too many."""
    (x0, y0), (x1, y1) = plan.bounds.min, plan.bounds.max
    return occupancy_grid(plan, max(cell_m, math.sqrt((x1 - x0) * (y1 - y0) / DOOR_CELLS)))


def _sizes(widths_m: tuple[float, float], cell_m: float) -> GapSizes:
    return GapSizes(*(size_m / cell_m for size_m in (*widths_m, MAX_WALL_THICKNESS_M, LOOSE_M)))


def _windows(solid: np.ndarray, grid: Grid, rules: DrawingRules, thin: np.ndarray) -> list[Window]:
    """Return the glass window_1, window_2, ... in gaps of outer walls, as thick as these.

    Args: solid: without thin lines.  thin: these lines; where they cross the gap, it is no door.
    """
    windows: list[Window] = []
    for gap in [] if rules.windows_m is None else outer_gaps(solid, _sizes(rules.windows_m, grid.resolution_m)):
        area = slice(gap.row, gap.row + gap.rows), slice(gap.column, gap.column + gap.columns)
        width, depth = (gap.columns, gap.rows) if gap.along_x else (gap.rows, gap.columns)
        low_m, high_m = rules.doors_m or (math.inf, 0.0)
        is_lined = thin[area].any(axis=0 if gap.along_x else 1).mean() > LINED
        if is_lined or not low_m <= width * grid.resolution_m <= high_m:
            start, end = _ends_m(gap, grid)
            keys = {"start": start, "end": end, "thickness_m": round(depth * grid.resolution_m, 6), "material": "glass"}
            windows.append((area, Wall.model_validate({"name": f"window_{len(windows) + 1}", **keys})))
    return windows


def _doors(solid: np.ndarray, grid: Grid, rules: DrawingRules, windows: Sequence[Window]) -> list[Door]:
    """Return an open door door_1, door_2, ... in each gap between walls and windows."""
    solid = solid.copy()
    for area, _ in windows:
        solid[area] = True
    found = [] if rules.doors_m is None else gaps(solid, _sizes(rules.doors_m, grid.resolution_m))
    ends = (_ends_m(gap, grid) for gap in found)
    return [Door(name=f"door_{number}", start=start, end=end) for number, (start, end) in enumerate(ends, 1)]


def _ends_m(gap: Gap, grid: Grid) -> tuple[Point, Point]:
    """Return the ends of the middle line of a gap [m]."""
    middle, along = ((0.0, 0.5), (1.0, 0.0)) if gap.along_x else ((0.5, 0.0), (0.0, 1.0))
    start = np.array([gap.column, gap.row]) + np.multiply(middle, (gap.columns, gap.rows))
    ends = np.array([start, start + np.multiply(along, (gap.columns, gap.rows))])
    (x0, y0), (x1, y1) = in_metres(grid.origin_m, (grid.resolution_m, grid.resolution_m), ends).tolist()
    return (x0, y0), (x1, y1)


def published_map(scenario: Scenario) -> OccupancyGrid:
    """Return the grid that map_server publishes if the plan is a map_server yaml, else the plan as a drawing.

    A plan with changed keys is not the image any more, so it is drawn, in cells of `run.map_resolution_m`. So is one
    whose origin has a yaw, because amcl and other subscribers of a map ignore the yaw. What is beside all levels is
    unknown.

    Raises: ScenarioError: the yaml or its image cannot be read any more.
    """
    image = _published_image(scenario)
    if image is not None:
        return image.occupancy_grid()
    grid = occupancy_grid(scenario.plan, scenario.run.map_resolution_m)
    if scenario.plan.levels:
        grid.cells[beside_levels(scenario.plan, grid.resolution_m, *grid.cells.shape)] = UNKNOWN
    return grid


def check_published_map(scenario: Scenario) -> None:
    """Raises: ScenarioError: `published_map` would have too many cells; the yaml or its image cannot be read."""
    problem = too_many_cells(scenario.plan, scenario.run.map_resolution_m)
    if problem and _published_image(scenario) is None:
        key = "run.map_resolution_m"
        raise ScenarioError(scenario.origin.line(f"{key}: {problem}", key))


def _published_image(scenario: Scenario) -> MapImage | None:
    """Return the image that is published as it is; None: the plan is drawn."""
    if scenario.plan_file is None:
        return None
    path = Path(scenario.plan_file)
    if "image" not in read_mapping(path, scenario.plan_file, "a floor plan"):
        return None
    image = read_map(path)
    return image if image.settings.origin[2] == 0.0 else None

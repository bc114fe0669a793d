"""Draws radio and voice maps on their floor plans, one or several side by side."""

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from scipy import ndimage

from robotteamsim import palette
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.plan_picture import draw_floor_plan
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario import FloorPlan
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.plan import OCCUPIED

_PAGE_INCHES = (12.0, 6.6)
"""The area for maps on a slide, without colour bar and titles."""

_AROUND_INCHES = (0.7, 0.8)
"""Space for labels around each map."""

_TITLE_LETTERS_PER_INCH = 12
"""Letters per inch of a panel's title, to wrap titles that are wider than their map."""

_TITLE_LINE_INCHES = 0.17

_SLIVER_CELLS, _SLIVER_INCHES = 3, 0.09
"""Size of the median filter: strips narrower than half of it, such as rays between furniture, get no contour."""

_SHORTEST_INCHES = 0.6
"""Length of the shortest contour that is drawn; on maps of drawings with uneven walls, shorter ones are mere specks."""

_LABEL_INCHES_PER_LETTER, _LABEL_POINTS = 0.1, 8

_HALO = (withStroke(linewidth=2.4, foreground=palette.PAPER),)


@dataclass(frozen=True, slots=True)
class Level:
    """A contour line at one value of the map, and the meaning of the value."""

    value: float
    meaning: str = ""

    def __str__(self) -> str:
        return f"{self.value:g}".replace("-", "\N{MINUS SIGN}")


@dataclass(frozen=True, slots=True)
class FieldStyle:
    """How a kind of map is drawn.

    low, high: ends of the colour bar.
    silence:   meaning of blank parts of a map.
    """

    quantity: str
    unit: str
    colours: str
    low: float
    high: float
    silence: str = ""
    levels: tuple[Level, ...] = ()


@dataclass(frozen=True, slots=True)
class Spot:
    """A marked position, in `map` [m]."""

    name: str
    position_m: tuple[float, float]
    kind: Literal["robot", "victim"]


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One map with its floor plan and sources; blank where its values are below `silent_below`."""

    title: str
    field: FieldMap
    plan: FloorPlan
    spots: tuple[Spot, ...] = ()
    silent_below: float = -math.inf


def draw_fields(panels: Sequence[Panel], style: FieldStyle, title: str) -> Figure:
    """Draw maps in one figure with one colour scale, with contours, walls, doors and sources.

    Args: title: title of the figure. Each panel has its own title; that of a single panel follows that of the figure.
    """
    rows, columns, scale = _layout(panels)
    width_m, height_m = _largest_size(panels)
    own, common = _split_titles([panel.title for panel in panels])
    titles = [textwrap.fill(text, round(width_m * scale * _TITLE_LETTERS_PER_INCH)) for text in own]
    above_inches = max(text.count("\n") for text in titles) * _TITLE_LINE_INCHES if len(panels) > 1 else 0.0
    around_inches = np.add(_AROUND_INCHES, (0.0, above_inches))
    size = columns * (width_m * scale + around_inches[0]) + 1.5, rows * (height_m * scale + around_inches[1]) + 0.4
    figure = PlainFigure(figsize=size, dpi=120, layout="compressed")
    all_axes = figure.subplots(rows, columns, squeeze=False)
    for axes in all_axes.flat[len(panels) :]:
        axes.remove()
    used = list(all_axes.flat[: len(panels)])
    images = [_draw_panel(axes, panel, style, scale) for axes, panel in zip(used, panels, strict=True)]
    for axes, text in zip(used, titles, strict=True):
        axes.set_title(text, loc="left", fontsize=10)
    bar = figure.colorbar(images[0], ax=used, shrink=0.92, pad=0.02, aspect=30)
    _mark_levels(bar, style)
    if len(panels) == 1:
        used[0].set_title(f"{title}, {panels[0].title}", loc="left", fontsize=11)
    else:
        figure.suptitle(", ".join((title, *common)), x=0.01, ha="left", fontsize=11)
    return figure


def _split_titles(titles: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the titles without the parts, separated by commas, that all have in common, and these parts."""
    parts = [title.split(", ") for title in titles]
    common = [part for part in parts[0] if all(part in other for other in parts)] if len(titles) > 1 else []
    own = [", ".join(part for part in each if part not in common) for each in parts]
    return (own, common) if all(own) else (list(titles), [])


def _layout(panels: Sequence[Panel]) -> tuple[int, int, float]:
    """Return rows, columns and inches per metre for the largest panels that fit on a page."""
    width_m, height_m = _largest_size(panels)
    layouts = []
    for columns in range(1, len(panels) + 1):
        rows = math.ceil(len(panels) / columns)
        room = np.divide(_PAGE_INCHES, (columns, rows)) - _AROUND_INCHES
        scale = float(np.min(room / (width_m, height_m)))
        holes = rows * columns - len(panels)
        layouts.append((scale * (0.8 if holes else 1.0), rows, columns, scale))
    _, rows, columns, scale = max(layouts)
    return rows, columns, scale


def _largest_size(panels: Sequence[Panel]) -> tuple[float, float]:
    sizes = np.array([np.subtract(panel.plan.bounds.max, panel.plan.bounds.min) for panel in panels])
    width_m, height_m = sizes.max(axis=0).tolist()
    return width_m, height_m


def extent_m(field: FieldMap) -> tuple[float, float, float, float]:
    """Return min x, max x, min y, max y of a map [m]."""
    rows, columns = field.values.shape
    x0, y0 = field.origin_m
    return x0, x0 + columns * field.resolution_m, y0, y0 + rows * field.resolution_m


def _draw_panel(axes: Axes, panel: Panel, style: FieldStyle, scale: float) -> AxesImage:
    """Draw a map. Args: scale: inches per metre."""
    field = panel.field
    values = np.ma.masked_less(field.values, panel.silent_below)
    extent = extent_m(field)
    colours = matplotlib.colormaps[style.colours].with_extremes(bad=palette.FLOOR)
    image = axes.imshow(
        values, origin="lower", extent=extent, cmap=colours, vmin=style.low, vmax=style.high, interpolation="nearest"
    )
    lines = _draw_levels(axes, panel, style.levels, scale)
    draw_floor_plan(axes, panel.plan, floor=False)
    for spot in panel.spots:
        _draw_spot(axes, spot)
    if lines is not None:
        _label_levels(lines, panel, style.levels, scale)
    axes.set(xlabel="x [m]", ylabel="y [m]")
    return image


def _draw_levels(axes: Axes, panel: Panel, levels: Sequence[Level], scale: float) -> ContourSet | None:
    """Draw the contours in free space, without levels that the map does not reach; return them, if there are any."""
    field = panel.field
    # Values inside walls differ from those next to them, so contours must end at walls.
    solid = _solid(panel)
    if solid.all():
        return None
    nearest_free = ndimage.distance_transform_edt(solid, return_distances=False, return_indices=True)
    filtered_cells = max(_SLIVER_CELLS, round(_SLIVER_INCHES / scale / field.resolution_m))
    values = np.ma.masked_array(ndimage.median_filter(field.values[tuple(nearest_free)], filtered_cells), solid)
    present = sorted(
        (level for level in levels if max(values.min(), panel.silent_below) <= level.value < values.max()),
        key=lambda level: level.value,
    )
    if not present:
        return None
    rows, columns = values.shape
    x = field.origin_m[0] + (np.arange(columns) + 0.5) * field.resolution_m
    y = field.origin_m[1] + (np.arange(rows) + 0.5) * field.resolution_m
    lines = axes.contour(
        x, y, values, levels=[level.value for level in present], colors=palette.INK, linewidths=0.9, linestyles="solid"
    )
    lines.set(path_effects=[withStroke(linewidth=1.9, foreground=palette.PAPER)])
    lines.set_paths([_long_parts(path, _SHORTEST_INCHES / scale) for path in lines.get_paths()])
    return lines


def _solid(panel: Panel) -> np.ndarray:
    """Return which cells of a map are walls, not doors."""
    solid: np.ndarray = building_of(panel.plan).grid_without_doors(panel.field.resolution_m).cells == OCCUPIED
    return solid


def _long_parts(path: Path, shortest_m: float) -> Path:
    """Return the lines of a contour that have at least a length."""
    parts = [part for part in _parts(path) if np.hypot(*np.diff(part, axis=0).T).sum() >= shortest_m]
    lines = [Path(part, closed=bool((part[0] == part[-1]).all())) for part in parts]
    return Path.make_compound_path(*lines) if lines else Path(np.empty((0, 2)))


def _parts(path: Path) -> list[np.ndarray]:
    """Return the points of each line of a contour [m]; simplified, they would be accurate only to a decimetre."""
    path.should_simplify = False
    return [np.asarray(part) for part in path.to_polygons(closed_only=False)]


def _label_levels(lines: ContourSet, panel: Panel, levels: Sequence[Level], scale: float) -> None:
    """Label each contour where it is farthest from walls, the border and sources, if there is enough space."""
    texts = {level.value: str(level) for level in levels}
    half_m = {value: len(text) * _LABEL_INCHES_PER_LETTER / 2.0 / scale for value, text in texts.items()}
    solid, (x0, _, y0, _) = np.pad(_solid(panel), 1, constant_values=True), extent_m(panel.field)
    free_m = ndimage.distance_transform_edt(~solid) * panel.field.resolution_m
    taken = [spot.position_m for spot in panel.spots]
    places: list[tuple[float, float]] = []
    for value, path in zip(lines.levels, lines.get_paths(), strict=True):
        for points in _parts(path):
            columns, rows = ((points - (x0, y0)) / panel.field.resolution_m + 1.0).astype(int).T
            others_m = [np.hypot(*(points - place).T) / 2.0 for place in taken]
            space_m = np.min([free_m[rows, columns], *others_m], axis=0)
            if space_m.max() > half_m[value]:
                x, y = points[space_m.argmax()].tolist()
                places.append((x, y))
                taken.append(places[-1])
    for label in lines.clabel(fmt=texts, fontsize=_LABEL_POINTS, manual=places):
        label.set(path_effects=_HALO, color=palette.INK)


def _mark_levels(bar: Colorbar, style: FieldStyle) -> None:
    """Mark the levels and their meanings on the colour bar."""
    bar.outline.set_visible(False)
    levels = [level for level in style.levels if style.low <= level.value <= style.high]
    marks = list(levels)
    tens = np.arange(math.ceil(style.low / 10.0), math.floor(style.high / 10.0) + 1) * 10.0
    for value in (style.low, style.high, *tens.tolist()):
        if all(abs(value - mark.value) > 0.06 * (style.high - style.low) for mark in marks):
            marks.append(Level(value))
    bar.set_ticks([mark.value for mark in marks], labels=[f"{mark} {mark.meaning}".rstrip() for mark in marks])
    for level in levels:
        bar.ax.axhline(level.value, color=palette.INK, linewidth=0.9)
    bar.ax.set_title(style.unit, fontsize=10)
    if style.silence:
        bar.ax.set_xlabel(f"blank:\n{style.silence}", fontsize=8)


def _draw_spot(axes: Axes, spot: Spot) -> None:
    marker = {"robot": "o", "victim": "X"}[spot.kind]
    axes.plot(*spot.position_m, marker, color=palette.PAPER, markersize=9, markeredgecolor=palette.INK, zorder=6)
    axes.annotate(
        spot.name.replace("_", " "),
        spot.position_m,
        xytext=(0, -7),
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=8,
        color=palette.INK,
        path_effects=_HALO,
        zorder=6,
    )

"""A picture of a radio or voice map over its floor plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from robotteamsim.propagation import FieldMap
from robotteamsim.scenario import FloorPlan, Solid, solids

_WALL = "#22262e"
_DOOR = "#8a6d3b"
_SILENT = "#f4f4f2"
_SOURCE = "#ffffff"


@dataclass(frozen=True, slots=True)
class FieldStyle:
    """How a kind of map is drawn.

    low, high:    ends of the colour bar.
    silent_below: values below this are left white.
    silence:      what white means.
    contours:     levels of the lines drawn into the map, each with its label.
    """

    quantity: str
    unit: str
    colours: str
    low: float
    high: float
    silent_below: float
    silence: str
    contours: tuple[tuple[float, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Spot:
    """A place to mark, in `map` [m]."""

    name: str
    position_m: tuple[float, float]


def draw_field(field: FieldMap, plan: FloorPlan, style: FieldStyle, title: str, sources: Sequence[Spot]) -> Figure:
    """Return the map as a figure: colours with a bar, contours, walls on top, the sources marked."""
    (min_x, min_y), (max_x, max_y) = plan.bounds.min, plan.bounds.max
    width, height = max_x - min_x, max_y - min_y
    figure = Figure(figsize=_size_inches(width, height), dpi=130, layout="constrained")
    axes = figure.subplots()
    values = np.ma.masked_less(field.values, style.silent_below)
    rows, columns = values.shape
    x0, y0 = field.origin_m
    extent = (x0, x0 + columns * field.resolution_m, y0, y0 + rows * field.resolution_m)
    colours = matplotlib.colormaps[style.colours].with_extremes(bad=_SILENT)
    image = axes.imshow(values, origin="lower", extent=extent, cmap=colours, vmin=style.low, vmax=style.high)
    _draw_contours(axes, values, extent, style)
    _draw_solids(axes, solids(plan))
    for spot in sources:
        _draw_source(axes, spot)
    axes.set(xlim=(min_x, max_x), ylim=(min_y, max_y), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.set_title(title, loc="left", fontsize=11)
    axes.set_title(f"white: {style.silence}", loc="right", fontsize=8)
    bar = figure.colorbar(image, ax=axes, shrink=0.9, pad=0.02)
    bar.set_label(f"{style.quantity} [{style.unit}]")
    return figure


def _size_inches(width_m: float, height_m: float) -> tuple[float, float]:
    """Return a size of the plan's shape, with room for bar and labels, that fits a page."""
    scale = min(8.5 / width_m, 7.0 / height_m)
    return scale * width_m + 1.8, scale * height_m + 0.9


def _draw_contours(axes: Axes, values: np.ma.MaskedArray, extent: tuple[float, ...], style: FieldStyle) -> None:
    levels = {level: text for level, text in style.contours if values.min() < level < values.max()}
    if not levels:
        return
    rows, columns = values.shape
    x = extent[0] + (np.arange(columns) + 0.5) * (extent[1] - extent[0]) / columns
    y = extent[2] + (np.arange(rows) + 0.5) * (extent[3] - extent[2]) / rows
    lines = axes.contour(x, y, values, levels=sorted(levels), colors="white", linewidths=0.9, linestyles="solid")
    axes.clabel(lines, fmt=levels, fontsize=7)


def _draw_solids(axes: Axes, all_solids: Sequence[Solid]) -> None:
    corners = [np.asarray(solid.corners) for solid in all_solids]
    tints = [_DOOR if solid.kind == "door" else _WALL for solid in all_solids]
    axes.add_collection(PolyCollection(corners, facecolors=tints, edgecolors="none"))


def _draw_source(axes: Axes, spot: Spot) -> None:
    axes.plot(*spot.position_m, "o", markersize=6, markerfacecolor=_SOURCE, markeredgecolor=_WALL)
    axes.annotate(
        spot.name,
        spot.position_m,
        xytext=(6, 5),
        textcoords="offset points",
        fontsize=8,
        bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.75},
    )

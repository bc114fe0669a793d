"""Draws what an import took for what: walls, doors, ink that is no wall, and parts of the floor without a door."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.transforms import Affine2D

from robotteamsim import palette
from robotteamsim.analysis.plan_picture import draw_plan
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import level_at
from robotteamsim.scenario.map_image import MapImage
from robotteamsim.scenario.plan import wall_corners
from robotteamsim.world.floor_parts import FloorPart

_INK_ALPHA = 0.9
_MOST_NAMES = 24
"""Of doors; more would hide the building."""


def draw_import(
    plan: FloorPlan, parts: Sequence[FloorPart], image: MapImage | None = None, left_out: np.ndarray | None = None
) -> Figure:
    """Return the floor plan with its walls of glass, over the image if it comes from one.

    Args: parts: of the floor, the largest first.  left_out: ink that is no wall, bool, row 0 at the lowest y.
    """
    figure = draw_plan(plan)
    axes = figure.axes[0]
    handles = [_square(palette.SOLIDS["wall"], "wall")]
    handles += [_square(palette.SOLIDS["block"], "block")] if plan.blocks else []
    if glass := [wall for wall in plan.walls if wall.material == "glass"]:
        panes = [Polygon(wall_corners(wall)) for wall in glass]
        axes.add_collection(PatchCollection(panes, facecolor=palette.GLASS, edgecolor=palette.GLASS, zorder=3.5))
        handles.append(_square(palette.GLASS, "wall of glass"))
    if image is not None and left_out is not None:
        ink = ~image.free
        _draw_cells(axes, image, left_out, palette.WAITING)
        _draw_cells(axes, image, ink & ~left_out, palette.SKY_BLUE)
        handles.append(_square(palette.SKY_BLUE, "ink of walls next to their straight sides"))
        handles.append(_square(palette.WAITING, "ink that is no wall"))
    if plan.doors:
        handles.append(Line2D([], [], color=palette.DOORS["normal"], linewidth=2.4, label="door"))
        if len(plan.doors) <= _MOST_NAMES:
            _draw_door_names(axes, plan)
    for part in parts[1:]:
        style = {"boxstyle": "round", "facecolor": palette.HEARD, "edgecolor": palette.INK}
        text = f"no door\n{part.area_m2:.1f} m\N{SUPERSCRIPT TWO}"
        axes.text(*part.place, text, ha="center", va="center", fontsize=8, bbox=style, zorder=8)
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False, fontsize=9)
    return figure


def _draw_door_names(axes: Axes, plan: FloorPlan) -> None:
    """Write the names of doors without those of their levels, and of both leaves of a double door once."""
    places: dict[str, list[Point]] = {}
    for door in plan.doors:
        places.setdefault(door.name.removesuffix("_left").removesuffix("_right"), []).extend((door.start, door.end))
    for name, ends in places.items():
        level = level_at(plan.levels, ends[0])
        text = name.removeprefix(f"{level.name}_" if level else "").removeprefix("door_")
        x, y = np.mean(ends, axis=0).tolist()
        axes.text(x, y, text, color=palette.DOORS["normal"], ha="center", va="center", weight="bold", zorder=7)


def _draw_cells(axes: Axes, image: MapImage, cells: np.ndarray, colour: str) -> None:
    """Draw cells of the image below the walls of the plan."""
    pixels = np.zeros((*cells.shape, 4))
    pixels[cells] = (*to_rgb(colour), _INK_ALPHA)
    (x, y, yaw), cell_m = image.settings.origin, image.settings.resolution
    rows, columns = cells.shape
    extent = (x, x + columns * cell_m, y, y + rows * cell_m)
    limits = axes.get_xlim(), axes.get_ylim()
    turned = Affine2D().rotate_around(x, y, yaw) + axes.transData
    axes.imshow(pixels, origin="lower", extent=extent, interpolation="nearest", zorder=2, transform=turned)
    axes.set(xlim=limits[0], ylim=limits[1])


def _square(colour: str, label: str) -> Line2D:
    return Line2D([], [], color=colour, marker="s", linestyle="", markersize=8, label=label)

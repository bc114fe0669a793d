"""Maps of where robots were in the missions of a report."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke

from robotteamsim import palette
from robotteamsim.analysis.fields.picture import extent_m
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.plan_picture import draw_floor_plan
from robotteamsim.analysis.report.figures import DPI, SCREEN, Sheet, styled
from robotteamsim.analysis.report.samples import Cell
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.victims import Victim
from robotteamsim.setup import resolve

MAX_MAPS = 9
"""Most maps in a figure."""

_HALO = (withStroke(linewidth=2.2, foreground=palette.PAPER),)
_HEAT_CELLS = 120
_MIN_HEAT_CELL_M = 0.25
_PAGE_INCHES = 10.5


def drawable(cells: Sequence[Cell]) -> list[Cell]:
    """Return the cells whose paths can be drawn on their floor plan: they have one, and robots."""
    return [cell for cell in cells if cell.scenario is not None and cell.scenario.team_size and cell.paths_m]


@styled
def draw_heat(cells: Sequence[Cell], *, sheet: Sheet = SCREEN) -> Figure:
    """Draw for each cell how long robots were at each place in a mission on average [s per m^2].

    The line is the path of one robot in the mission of median duration.
    """
    shown = cells[:MAX_MAPS]
    columns = min(1 if len(shown) == 1 else 2 if len(shown) in (2, 4) else 3, max(sheet.panels, 2))
    rows = math.ceil(len(shown) / columns)
    (min_x, min_y), (max_x, max_y) = _bounds(shown[0])
    bar_inches = 0.9 * sheet.scale
    maps_inches = _PAGE_INCHES if sheet is SCREEN else sheet.width_inches - bar_inches
    height = maps_inches / columns * (max_y - min_y) / (max_x - min_x) + 0.45
    size = (maps_inches + bar_inches, height * rows + 0.2)
    figure = PlainFigure(figsize=size, dpi=DPI, layout="compressed")
    all_axes = figure.subplots(rows, columns, squeeze=False)
    for axes in all_axes.flat[len(shown) :]:
        axes.remove()
    heats = [heat(cell) for cell in shown]
    visited = np.concatenate([each.values[each.values > 0.0] for each in heats])
    # A square-root scale, so that the paths of few missions are visible, too.
    most = float(np.percentile(visited, 98.0)) if visited.size else 1.0
    norm = PowerNorm(0.5, vmin=0.0, vmax=most)
    used = list(all_axes.flat[: len(shown)])
    images = [_draw_heat(axes, cell, each, norm, sheet) for axes, cell, each in zip(used, shown, heats, strict=True)]
    bar = figure.colorbar(images[0], ax=used, shrink=0.85, pad=0.015, aspect=28, extend="max")
    bar.outline.set_visible(False)
    bar.set_label("s/m\N{SUPERSCRIPT TWO}", fontsize=min(9.5, sheet.text_pt))
    return figure


def heat(cell: Cell) -> FieldMap:
    """Return robot time per area and mission [s/m^2]; each stored position counts for the time between positions.

    Raises: ValueError: the cell has no paths, or no floor plan.
    """
    if cell.scenario is None or not cell.paths_m:
        raise ValueError(f"{cell.name} has no paths on a floor plan")
    (min_x, min_y), (max_x, max_y) = _bounds(cell)
    resolution_m = max(_MIN_HEAT_CELL_M, max(max_x - min_x, max_y - min_y) / _HEAT_CELLS)
    columns, rows = (math.ceil(round(side / resolution_m, 6)) for side in (max_x - min_x, max_y - min_y))
    counts = np.zeros((rows, columns))
    ends = [[min_y, min_y + rows * resolution_m], [min_x, min_x + columns * resolution_m]]
    for paths_m in cell.paths_m:
        x, y = _filled(paths_m).reshape(-1, 2).T
        counts += np.histogram2d(y, x, bins=(rows, columns), range=ends)[0] / _FILL
    period_s = max(round(1.0 / cell.scenario.run.step_s), 1) * cell.scenario.run.step_s
    values = counts * period_s / (len(cell.paths_m) * resolution_m**2)
    return FieldMap((min_x, min_y), resolution_m, values.astype(np.float32))


_FILL = 4
"""Positions per stored position: at 1 m/s, paths then cross every cell of half a metre."""


def _filled(paths_m: np.ndarray) -> np.ndarray:
    """Return paths with interpolated positions between the stored ones."""
    if len(paths_m) < 2:
        return np.repeat(paths_m, _FILL, axis=0)
    shares = (np.arange(_FILL) / _FILL)[np.newaxis, :, np.newaxis, np.newaxis]
    between = paths_m[:-1, np.newaxis] * (1.0 - shares) + paths_m[1:, np.newaxis] * shares
    return np.concatenate((between.reshape(-1, *paths_m.shape[1:]), np.repeat(paths_m[-1:], _FILL, axis=0)))


def _draw_heat(axes: Axes, cell: Cell, field: FieldMap, norm: PowerNorm, sheet: Sheet) -> AxesImage:
    assert cell.scenario is not None
    extent = extent_m(field)
    colours = matplotlib.colormaps[palette.HEAT_MAP].with_extremes(bad=palette.FLOOR)
    values = np.ma.masked_equal(field.values, 0.0)
    image = axes.imshow(values, origin="lower", extent=extent, cmap=colours, norm=norm, interpolation="nearest")
    draw_floor_plan(axes, cell.scenario.plan, floor=False)
    middle = int(np.argsort(cell.missions.restricted_s, kind="stable")[(len(cell.missions) - 1) // 2])
    if middle < len(cell.paths_m):
        axes.plot(*cell.paths_m[middle][:, 0].T, color=palette.VERMILLION, linewidth=0.9, alpha=0.9, zorder=5)
    for number, area in enumerate(cell.scenario.mission.areas, 1):
        axes.add_patch(
            Circle(
                area.center, area.radius_m, facecolor="none", edgecolor=palette.EXPLORED_AREA, linewidth=1.2, zorder=5
            )
        )
        axes.text(
            *area.center,
            str(number),
            color=palette.EXPLORED_AREA,
            ha="center",
            va="center",
            weight="bold",
            fontsize=8,
            zorder=6,
            path_effects=_HALO,
        )
    for victim in _victims(cell, middle):
        axes.plot(*victim.position, "X", color=palette.INK, markersize=7, markeredgecolor=palette.PAPER, zorder=6)
    axes.set(xticks=[], yticks=[])
    axes.set_title(textwrap.fill(cell.name, sheet.label_letters), color=palette.INK)
    return image


def _victims(cell: Cell, mission: int) -> tuple[Victim, ...]:
    """Return the victims of one of a cell's missions, also those at random places and of groups."""
    assert cell.scenario is not None
    run = cell.scenario.run.model_copy(update={"seed": cell.seeds[mission]})
    seeded = cell.scenario.model_copy(update={"run": run})
    return resolve(seeded).scenario.mission.victims


def _bounds(cell: Cell) -> tuple[tuple[float, float], tuple[float, float]]:
    assert cell.scenario is not None
    return cell.scenario.plan.bounds.min, cell.scenario.plan.bounds.max

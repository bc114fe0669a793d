"""Maps of a report: the ranges of voices and radios, and the paths of the robots."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, PowerNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Circle, Patch
from matplotlib.patheffects import withStroke
from scipy.spatial import cKDTree

from robotteamsim import palette
from robotteamsim.analysis import labels
from robotteamsim.analysis.fields.maps import VoiceRange, radio_panel, radio_style, voice_panel
from robotteamsim.analysis.fields.picture import draw_fields
from robotteamsim.analysis.plan_picture import draw_floor_plan
from robotteamsim.analysis.report.figures import styled
from robotteamsim.analysis.report.samples import Campaign, Cell
from robotteamsim.propagation import FieldMap, VoiceField, VoiceSource
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.plan import OCCUPIED, obstacles

MAX_MAPS = 9
"""Most maps in a figure."""

_HALO = (withStroke(linewidth=2.2, foreground=palette.PAPER),)
_CELLS = 300
_HEAT_CELLS = 120
_MIN_HEAT_CELL_M = 0.25
_PAGE_INCHES = 10.5
_VOICE_INCHES = 5.4
"""Narrow, so that its texts are legible on the screen of a phone."""
_VOICE_CELLS = 800
_DPI = 160


def noises_db(campaign: Campaign) -> list[float]:
    """Return the background noise levels of all cells, ascending [dB]."""
    return sorted({cell.scenario.voice.noise_db for cell in campaign.cells if cell.scenario is not None})


@styled
def draw_voices(scenario: Scenario, levels_db: Sequence[float], voice_range: VoiceRange) -> Figure:
    """Draw where victims are heard at each noise level, with all voices quiet or all loud .

    A voice that is heard at one level is heard at all lower ones, so one map shows them all.
    """
    shown_db = list(levels_db[:MAX_MAPS])
    quietest = scenario.model_copy(update={"voice": scenario.voice.model_copy(update={"noise_db": shown_db[0]})})
    panel = voice_panel(quietest, (), _resolution_m(scenario, _VOICE_CELLS), voice_range)
    colours = matplotlib.colormaps[palette.VOICE_MAP](np.linspace(0.12, 0.62, len(shown_db)))
    (min_x, min_y), (max_x, max_y) = scenario.plan.bounds.min, scenario.plan.bounds.max
    height = _VOICE_INCHES * (max_y - min_y) / (max_x - min_x)
    figure = Figure(figsize=(_VOICE_INCHES, height + 0.9), dpi=_DPI, layout="constrained")
    axes = figure.subplots()
    values = np.ma.masked_less(panel.field.values, panel.silent_below)
    axes.imshow(
        values,
        origin="lower",
        extent=_extent(panel.field),
        cmap=ListedColormap(colours).with_extremes(bad=palette.FLOOR),
        norm=BoundaryNorm([*shown_db, max(float(values.max()), shown_db[-1]) + 1.0], len(shown_db)),
        interpolation="nearest",
    )
    draw_floor_plan(axes, scenario.plan, floor=False)
    _draw_victims(axes, scenario)
    axes.set(xlabel="x [m]", ylabel="y [m]")
    names = [f"{low:g} dB" for low in shown_db]
    patches = [Patch(facecolor=colour, edgecolor=palette.AXIS, linewidth=0.6) for colour in colours]
    where: dict[str, Any] = {
        "loc": "outside lower center",
        "ncols": min(len(names), 4),
        "frameon": False,
        "columnspacing": 1.5,
    }
    figure.legend(patches, names, title="heard with noise up to", fontsize=12, title_fontsize=12, **where)
    return figure


def _draw_victims(axes: Axes, scenario: Scenario) -> None:
    """Draw the victims and their names on light ground, off walls, victims and each other."""
    plan, victims = scenario.plan, scenario.mission.victims
    (min_x, min_y), (max_x, max_y) = plan.bounds.min, plan.bounds.max
    metre_inches = 0.85 * _VOICE_INCHES / (max_x - min_x)
    mark_m = 0.12 / metre_inches
    names = [victim.name.replace("_", " ") for victim in victims]
    texts = [
        labels.Text(victim.position, (0.05 * len(name) / metre_inches, 0.11 / metre_inches), mark_m)
        for victim, name in zip(victims, names, strict=True)
    ]
    taken = [obstacles(plan), *(shapely.Point(victim.position).buffer(mark_m) for victim in victims)]
    spots = labels.place(texts, taken, shapely.box(min_x, min_y, max_x, max_y))
    plate = {"boxstyle": "round,pad=0.15", "facecolor": palette.PAPER, "edgecolor": "none", "alpha": 0.8}
    for victim, name, spot in zip(victims, names, spots, strict=True):
        axes.plot(*victim.position, "X", color=palette.INK, markersize=10, markeredgecolor=palette.PAPER, zorder=6)
        axes.text(*spot.middle_m, name, ha="center", va="center", fontsize=12, bbox=plate, zorder=6)


def _extent(field: FieldMap) -> tuple[float, float, float, float]:
    """Return min x, max x, min y, max y of a map [m]."""
    rows, columns = field.values.shape
    x0, y0 = field.origin_m
    return (x0, x0 + columns * field.resolution_m, y0, y0 + rows * field.resolution_m)


def voice_text(scenario: Scenario, voice_range: VoiceRange) -> str:
    """Return the parameters of all voices at one end of their range."""
    end = 1 if voice_range == "lowest" else 0
    constant = f"{scenario.voice.constant_db[end]:g}".replace("-", "\N{MINUS SIGN}")
    return f"constant {constant} dB, exponent {scenario.voice.exponent[end]:g}"


def heard_shares(scenario: Scenario, levels_db: Sequence[float], voice_range: VoiceRange) -> list[float]:
    """Return the share of the free floor where a victim is heard, at each noise level."""
    end = 1 if voice_range == "lowest" else 0
    voice = scenario.voice.model_copy(update={"map_resolution_m": _resolution_m(scenario, _CELLS)})
    constant_db, exponent = voice.constant_db[end], voice.exponent[end]
    calling = [victim for victim in scenario.mission.victims if victim.calling]
    sources = [VoiceSource(victim.position, constant_db, exponent) for victim in calling]
    free = building_of(scenario.plan).grid_without_doors(voice.map_resolution_m).cells != OCCUPIED
    shares = []
    for noise_db in levels_db:
        field = VoiceField(scenario.plan, voice.model_copy(update={"noise_db": noise_db}))
        shares.append(float(np.mean(field.map_db(sources).values[free] > 0.0)))
    return shares


@styled
def draw_network(scenario: Scenario, positions_m: np.ndarray) -> Figure:
    """Draw the range of a team's radios, with connection thresholds as contour lines."""
    places = [(float(x), float(y)) for x, y in positions_m]
    panel = radio_panel(scenario, places, _resolution_m(scenario, _CELLS), False)
    figure = draw_fields([panel], radio_style([scenario], False), "Signal")
    figure.set_dpi(_DPI)
    return figure


def widest_moment_m(campaign: Campaign) -> np.ndarray | None:
    """Return the positions at the time when a robot was farthest from its nearest neighbour [m], shape (n, 2)."""
    found: tuple[float, np.ndarray] | None = None
    for cell in campaign.cells:
        for paths_m in cell.paths_m:
            if paths_m.shape[1] < 2:
                continue
            widest_m = nearest_other_m(paths_m).max(axis=1)
            at = int(np.argmax(widest_m))
            if found is None or widest_m[at] > found[0]:
                found = float(widest_m[at]), paths_m[at]
    return found[1] if found else None


def nearest_other_m(paths_m: np.ndarray) -> np.ndarray:
    """Return the distance of each of several robots to the nearest other one [m], shape (samples, robots)."""
    # The first neighbour in the tree is the robot itself.
    return np.array([cKDTree(positions_m).query(positions_m, k=2)[0][:, 1] for positions_m in paths_m])


def drawable(cells: Sequence[Cell]) -> list[Cell]:
    """Return the cells whose paths can be drawn on their floor plan."""
    return [cell for cell in cells if cell.scenario is not None and cell.paths_m]


@styled
def draw_heat(cells: Sequence[Cell]) -> Figure:
    """Draw for each cell how long robots were at each place in a mission on average [s per m^2].

    The line is the path of one robot in the mission of median duration.
    """
    shown = cells[:MAX_MAPS]
    columns = 1 if len(shown) == 1 else 2 if len(shown) in (2, 4) else 3
    rows = math.ceil(len(shown) / columns)
    (min_x, min_y), (max_x, max_y) = _bounds(shown[0])
    width = _PAGE_INCHES / columns
    size = (_PAGE_INCHES + 0.9, (width * (max_y - min_y) / (max_x - min_x) + 0.45) * rows + 0.2)
    figure = Figure(figsize=size, dpi=_DPI, layout="compressed")
    all_axes = figure.subplots(rows, columns, squeeze=False)
    for axes in all_axes.flat[len(shown) :]:
        axes.remove()
    heats = [heat(cell) for cell in shown]
    visited = np.concatenate([each.values[each.values > 0.0] for each in heats])
    # A square-root scale, so that the paths of few missions are visible, too.
    norm = PowerNorm(0.5, vmin=0.0, vmax=float(np.percentile(visited, 98.0)))
    used = list(all_axes.flat[: len(shown)])
    images = [_draw_heat(axes, cell, each, norm) for axes, cell, each in zip(used, shown, heats, strict=True)]
    bar = figure.colorbar(images[0], ax=used, shrink=0.85, pad=0.015, aspect=28, extend="max")
    bar.outline.set_visible(False)
    bar.ax.set_title("s/m\N{SUPERSCRIPT TWO}", fontsize=9.5)
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


def _draw_heat(axes: Axes, cell: Cell, field: FieldMap, norm: PowerNorm) -> AxesImage:
    assert cell.scenario is not None
    extent = _extent(field)
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
    for victim in cell.scenario.mission.victims:
        axes.plot(*victim.position, "X", color=palette.INK, markersize=7, markeredgecolor=palette.PAPER, zorder=6)
    axes.set(xticks=[], yticks=[])
    axes.set_title(cell.name, color=palette.INK)
    return image


def _bounds(cell: Cell) -> tuple[tuple[float, float], tuple[float, float]]:
    assert cell.scenario is not None
    return cell.scenario.plan.bounds.min, cell.scenario.plan.bounds.max


def _resolution_m(scenario: Scenario, cells: int) -> float:
    (min_x, min_y), (max_x, max_y) = scenario.plan.bounds.min, scenario.plan.bounds.max
    return min(max(round(max(max_x - min_x, max_y - min_y) / cells, 2), 0.05), 2.0)

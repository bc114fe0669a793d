"""Figures of the missions' results: times, counts, survival."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from scipy import stats

from robotteamsim import palette
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.report.samples import Panel, Sample
from robotteamsim.analysis.report.statistics import (
    bootstrap_mean,
    clopper_pearson,
    generator,
    mean_course,
    survival,
)
from robotteamsim.palette import GRID, INK, PAPER

MAX_PANELS = 24
"""Most settings in a figure; tables contain all."""

MAX_COURSES = 10
"""Most settings in a figure of curves on top of each other."""

_STYLE: dict[Any, Any] = {
    "axes.edgecolor": palette.AXIS,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "text.color": INK,
    "xtick.color": palette.SOFT_INK,
    "ytick.color": palette.SOFT_INK,
}
DPI = 160
"""Resolution of all figures."""
WIDTH_INCHES = 10.0
_ROW_INCHES = 0.62
_DOTS = 400
_LEVEL_LETTERS = 4
"""Labels of bars that are longer would overlap and are slanted."""
_TITLE_LETTERS = 40
"""A line of a panel's title."""

Counts = Callable[[Sample], np.ndarray]
"""What is counted in each mission of a sample."""


@dataclass(frozen=True, slots=True)
class Sheet:
    """What a figure is drawn for.

    width_inches:  of the figure.
    text_pt, title_pt, legend_pt: sizes of the text.
    panels:        most panels next to each other.
    label_letters: of a line of a label next to a row, or in a legend.
    """

    width_inches: float
    text_pt: float
    title_pt: float
    legend_pt: float
    panels: int
    label_letters: int

    @property
    def scale(self) -> float:
        """The size of the text over that of SCREEN."""
        return self.text_pt / SCREEN.text_pt


SCREEN = Sheet(WIDTH_INCHES, 10.5, 11.0, 9.0, panels=3, label_letters=32)
PAPERS = {
    "column": Sheet(3.5, 8.0, 8.0, 8.0, panels=1, label_letters=18),
    "page": Sheet(7.16, 8.0, 8.0, 8.0, panels=3, label_letters=32),
}
"""Figures of papers in two columns: widths of the IEEE's columns and pages, 88.9 and 182 mm."""


def styled(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """Apply the style of the report, and the sizes of text of the keyword `sheet`, to a drawing function."""

    def drawn(*arguments: object, **keywords: Any) -> Figure:
        sheet: Sheet = keywords.get("sheet", SCREEN)
        sizes = {"font.size": sheet.text_pt, "axes.titlesize": sheet.title_pt, "legend.fontsize": sheet.legend_pt}
        with matplotlib.rc_context(_STYLE | sizes):
            return draw(*arguments, **keywords)

    drawn.__name__, drawn.__doc__ = draw.__name__, draw.__doc__
    return drawn


def share_panels(count: int, label: str, shared: bool = False, *, sheet: Sheet = SCREEN) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels whose y axis is a share. Args: shared: whether all have the same limits."""
    columns = min(sheet.panels, count)
    rows = math.ceil(count / columns)
    width_inches = sheet.width_inches * max(columns, 1.6) / sheet.panels if sheet is SCREEN else sheet.width_inches
    size = (width_inches, (0.7 + 2.7 * rows) * sheet.scale)
    figure = PlainFigure(figsize=size, dpi=DPI, layout="constrained")
    panels: list[Axes] = []
    for index in range(count):
        first = panels[0] if shared and panels else None
        axes = figure.add_subplot(rows, columns, index + 1, sharex=first, sharey=first)
        axes.set(ylim=(-0.02, 1.04), ylabel="" if index % columns else label)
        axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "", "50 %", "", "100 %"])
        axes.grid(axis="y", color=GRID, linewidth=0.7)
        axes.set_axisbelow(True)
        panels.append(axes)
    return figure, panels


@styled
def draw_times(panels: Sequence[Panel], *, sheet: Sheet = SCREEN) -> Figure:
    """Draw the times of each series: density, box, dots, and the mean with its 95 % bootstrap interval."""
    rows = [(name, each.missions, each.colour) for panel in panels[:MAX_PANELS] for name, each in panel.named()]
    size = (sheet.width_inches, (1.5 + _ROW_INCHES * len(rows)) * sheet.scale)
    figure = PlainFigure(figsize=size, dpi=DPI, layout="constrained")
    axes = figure.subplots()
    for place, (label, sample, colour) in enumerate(rows):
        _raincloud(axes, sample, -float(place), colour, label)
    names = [textwrap.fill(label, sheet.label_letters) for label, _, _ in rows]
    axes.set_yticks([-float(place) for place in range(len(rows))], names)
    limits = sorted({missions.limit_s for _, missions, _ in rows})
    if any(not sample.finished.all() for _, sample, _ in rows):
        for limit_s in limits:
            axes.axvline(limit_s, color=INK, linewidth=0.9, linestyle=":")
    axes.set(xlabel="time to the end of the mission [s]", ylim=(-len(rows) + 0.35, 0.85))
    axes.grid(axis="x", color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    dot = Line2D([], [], color=INK, marker="o", linestyle="", alpha=0.5, markersize=4)
    cut = Line2D([], [], marker="o", linestyle="", markerfacecolor=PAPER, markeredgecolor=INK, markersize=4.5)
    mean = Line2D([], [], color=INK, marker="D", markersize=5)
    handles, labels = [dot, mean], ["one mission", "mean, 95 % interval"]
    if any(not sample.finished.all() for _, sample, _ in rows):
        handles, labels = [*handles, cut], [*labels, "cut short: counts as the limit"]
    figure.legend(handles, labels, loc="outside lower center", ncols=sheet.panels, frameon=False)
    return figure


@styled
def draw_counts(panels: Sequence[Panel], of: Counts, what: str, top: int | None, *, sheet: Sheet = SCREEN) -> Figure:
    """Draw the share of missions with each count, with Clopper-Pearson 95 % intervals.

    Args: of: returns the counts of a sample.  what: what is counted.  top: greatest possible count; None: unlimited.
    """
    shown = panels[:MAX_PANELS]
    samples = [each.missions for panel in shown for each in panel.series]
    highest = max(int(of(sample).max()) for sample in samples)
    counts = _bins(min(int(of(sample).min()) for sample in samples), highest if top is None else top)
    figure, all_axes = share_panels(len(shown), "share of missions", sheet=sheet)
    for axes, panel in zip(all_axes, shown, strict=True):
        for place, each in enumerate(panel.series):
            shift = 0.4 * (place - 0.5 * (len(panel.series) - 1))
            _shares(axes, of(each.missions), counts, each.colour, shift, each.missions)
        axes.set_title(textwrap.fill(panel.name, _TITLE_LETTERS))
        names = [_bin_name(counts, place) for place in range(len(counts))]
        slanted: dict[str, Any] = {"rotation": 35.0, "ha": "right", "rotation_mode": "anchor"}
        axes.set_xticks(range(len(counts)), names, **(slanted if max(map(len, names)) > _LEVEL_LETTERS else {}))
        axes.set(ylim=(0.0, 1.04), xlim=(-0.6, len(counts) - 0.4), xlabel=what)
    _add_legend(figure, shown, "\N{MULTIPLICATION SIGN}: mean; bars end in 95 % intervals", sheet)
    return figure


@styled
def draw_survival(panels: Sequence[Panel], *, sheet: Sheet = SCREEN) -> Figure:
    """Draw the share of missions still running, by time (Kaplan-Meier), with pointwise 95 % intervals."""
    shown = panels[:MAX_PANELS]
    figure, all_axes = share_panels(len(shown), "still exploring", shared=True, sheet=sheet)
    for axes, panel in zip(all_axes, shown, strict=True):
        for each in panel.series:
            _curve(axes, each.missions, each.colour)
        axes.set_title(textwrap.fill(panel.name, _TITLE_LETTERS))
        axes.set_xlabel("time [s]")
        axes.grid(axis="x", color=GRID, linewidth=0.7)
    samples = [each.missions for panel in shown for each in panel.series]
    earliest = min((float(sample.restricted_s.min()) for sample in samples if sample.finished.any()), default=0.0)
    latest = max(sample.limit_s for sample in samples)
    all_axes[0].set_xlim(max(0.0, earliest - 0.12 * latest), latest * 1.02)
    _add_legend(figure, shown, "|: cut short (censored at the limit)", sheet)
    return figure


@styled
def draw_saved(panels: Sequence[Panel], *, sheet: Sheet = SCREEN) -> Figure:
    """Draw the mean number of victims saved, or safe, so far, by time, with pointwise 95 % bootstrap intervals.

    Args: panels: at least one of their series has the times.
    """
    courses = [(name, each.missions) for panel in panels for name, each in panel.named() if each.missions.saved_s]
    figure = PlainFigure(figsize=(sheet.width_inches, 4.6 * sheet.scale), dpi=DPI, layout="constrained")
    axes = figure.subplots()
    until_s = max(float(missions.time_s.max()) for _, missions in courses)
    dashes = itertools.cycle(("-", "--", "-.", ":"))
    for place, (name, missions) in enumerate(courses[:MAX_COURSES]):
        course, colour = mean_course(missions.saved_s, until_s, generator("saved", name)), palette.robot_colour(place)
        line: dict[str, Any] = {"color": colour, "linewidth": 2.0, "linestyle": next(dashes)}
        axes.step(course.time_s, course.mean, where="post", label=textwrap.fill(name, sheet.label_letters), **line)
        axes.fill_between(course.time_s, course.low, course.high, step="post", color=colour, alpha=0.18, linewidth=0)
    most = max(missions.num_victims for _, missions in courses)
    axes.axhline(most, color=INK, linewidth=0.9, linestyle=":")
    axes.set(xlim=(0.0, until_s), ylim=(0.0, 1.04 * most), xlabel="time [s]", ylabel="victims saved")
    axes.yaxis.set_major_locator(MaxNLocator(8, integer=True))
    axes.grid(color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    figure.legend(loc="outside lower center", ncols=sheet.panels, frameon=False)
    return figure


def _raincloud(axes: Axes, sample: Sample, y: float, colour: str, name: str) -> None:
    """Draw the density above y, the box at y, the missions below y."""
    times = sample.restricted_s
    if len(times) > 2 and np.ptp(times) > 0:
        at = np.linspace(times.min(), times.max(), 200)
        density = stats.gaussian_kde(times)(at)
        axes.fill_between(
            at, y + 0.14, y + 0.14 + 0.42 * density / density.max(), color=colour, alpha=0.35, linewidth=0
        )
    low, middle, high = np.percentile(times, [25, 50, 75])
    axes.plot([times.min(), times.max()], [y, y], color=colour, linewidth=1.0, zorder=2)
    axes.fill_between([low, high], y - 0.07, y + 0.07, facecolor=PAPER, edgecolor=colour, linewidth=1.2, zorder=3)
    axes.plot([middle, middle], [y - 0.07, y + 0.07], color=colour, linewidth=2.4, zorder=4, solid_capstyle="butt")
    dots = slice(None, _DOTS)
    places = y - 0.15 - 0.2 * generator("dots", name).random(len(times))[dots]
    done = sample.finished[dots]
    axes.plot(times[dots][done], places[done], "o", color=colour, markersize=3.2, alpha=0.55, markeredgewidth=0)
    axes.plot(
        times[dots][~done],
        places[~done],
        "o",
        markerfacecolor=PAPER,
        markeredgecolor=colour,
        markersize=4.2,
        zorder=3,
    )
    mean = bootstrap_mean(times, generator("time", name))
    axes.plot([mean.low, mean.high], [y, y], color=INK, linewidth=2.2, zorder=5)
    axes.plot(mean.value, y, "D", color=INK, markersize=5.5, markeredgecolor=PAPER, zorder=6)


def _bins(lowest: int, highest: int) -> list[tuple[int, int]]:
    """Return ranges of counts; with few counts, each range is one count."""
    lowest = max(0, min(lowest, highest - 3))
    least = max(1, math.ceil((highest - lowest + 1) / 8))
    step = next(size for size in _round_numbers() if size >= least)
    lowest -= lowest % step
    return [(start, start + step - 1) for start in range(lowest, max(highest, 1) + 1, step)]


def _round_numbers() -> Iterator[int]:
    """Yield 1, 2, 5, 10, 20, 50 and so on."""
    return (digit * 10**power for power in itertools.count() for digit in (1, 2, 5))


def _bin_name(counts: Sequence[tuple[int, int]], place: int) -> str:
    low, high = counts[place]
    return f"{low}" if low == high else f"{low}\N{EN DASH}{high}"


def _shares(
    axes: Axes, values: np.ndarray, counts: Sequence[tuple[int, int]], colour: str, shift: float, sample: Sample
) -> None:
    for place, (low, high) in enumerate(counts):
        share = clopper_pearson(int(np.count_nonzero((values >= low) & (values <= high))), len(sample))
        axes.bar(place + shift, share.value, 0.36, color=colour, alpha=0.35, linewidth=0)
        seen = share.value > 0.0
        axes.plot(
            [place + shift] * 2,
            [share.low, share.high],
            color=colour,
            linewidth=1.6 if seen else 1.0,
            alpha=1.0 if seen else 0.45,
            solid_capstyle="butt",
        )
        if seen:
            axes.plot(place + shift, share.value, "o", color=colour, markersize=5.0)
    (first, step), mean = (counts[0][0], counts[0][1] - counts[0][0] + 1), float(np.mean(values))
    axes.plot(
        (mean - first - (step - 1) / 2.0) / step,
        0.03,
        "X",
        color=colour,
        markersize=7.5,
        markeredgecolor=PAPER,
        zorder=5,
    )


def _curve(axes: Axes, sample: Sample, colour: str) -> None:
    curve = survival(sample.restricted_s, sample.finished, sample.limit_s)
    axes.step(curve.time_s, curve.share, where="post", color=colour, linewidth=2.0)
    axes.fill_between(curve.time_s, curve.low, curve.high, step="post", color=colour, alpha=0.15, linewidth=0)
    if len(curve.censored_s):
        at = np.searchsorted(curve.time_s, np.unique(curve.censored_s), side="right") - 1
        axes.plot(np.unique(curve.censored_s), curve.share[at], "|", color=colour, markersize=10, markeredgewidth=1.8)


def _add_legend(figure: Figure, panels: Sequence[Panel], note: str, sheet: Sheet) -> None:
    colours = {each.label: each.colour for panel in panels for each in panel.series if each.label}
    handles = [Line2D([], [], color=colour, linewidth=6, alpha=0.6) for colour in colours.values()]
    labels = list(colours)
    handles.append(Line2D([], [], linestyle=""))
    figure.legend(handles, [*labels, note], loc="outside lower center", ncols=sheet.panels, frameon=False)

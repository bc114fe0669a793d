"""Figures of the missions' results: times, counts, survival, ratios."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy import stats

from robotteamsim import palette
from robotteamsim.analysis.report.comparison import MARGIN, Comparison, generator
from robotteamsim.analysis.report.samples import Cell, Sample
from robotteamsim.analysis.report.statistics import bootstrap_mean, clopper_pearson, survival
from robotteamsim.palette import GRID, INK, OURS, PAPER, THEIRS

MAX_CELLS = 24
"""Most cells in a figure; tables contain all cells."""

_STYLE: dict[Any, Any] = {
    "font.size": 10.5,
    "axes.edgecolor": palette.AXIS,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "text.color": INK,
    "xtick.color": palette.SOFT_INK,
    "ytick.color": palette.SOFT_INK,
}
_DPI = 160
_WIDTH_INCHES = 10.0
_PANEL_COLUMNS = 3
_ROW_INCHES = 0.62
_DOTS = 400


def styled(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """Apply the style of the report to a drawing function."""

    def drawn(*arguments: object, **keywords: object) -> Figure:
        with matplotlib.rc_context(_STYLE):
            return draw(*arguments, **keywords)

    drawn.__name__, drawn.__doc__ = draw.__name__, draw.__doc__
    return drawn


@styled
def draw_times(cells: Sequence[Cell]) -> Figure:
    """Draw the times of each cell: density, box, dots, and the mean with its 95 % bootstrap interval [Fig. 20]."""
    rows = _rows(cells)
    figure = Figure(figsize=(_WIDTH_INCHES, 1.5 + _ROW_INCHES * len(rows)), dpi=_DPI, layout="constrained")
    axes = figure.subplots()
    for place, (label, sample, colour) in enumerate(rows):
        _raincloud(axes, sample, -float(place), colour, label)
    axes.set_yticks([-float(place) for place in range(len(rows))], [label for label, _, _ in rows])
    limits = sorted({cell.ours.limit_s for cell in cells})
    if any(not sample.finished.all() for _, sample, _ in rows):
        for limit_s in limits:
            axes.axvline(limit_s, color=INK, linewidth=0.9, linestyle=":")
    axes.set(xlabel="time to explore all areas [s]", ylim=(-len(rows) + 0.35, 0.85))
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
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return figure


@styled
def draw_counts(cells: Sequence[Cell], of: Callable[[Sample], np.ndarray], what: str, top: int | None) -> Figure:
    """Draw the share of missions with each count, with Clopper-Pearson 95 % intervals [Fig. 19, 21, 22].

    Args: of: returns the counts of a sample.  what: what is counted.  top: greatest possible count; None: unlimited.
    """
    shown = cells[:MAX_CELLS]
    samples = [sample for cell in shown for sample in (cell.ours, cell.theirs) if sample is not None]
    highest = max(int(of(sample).max()) for sample in samples)
    counts = _bins(min(int(of(sample).min()) for sample in samples), highest if top is None else top)
    columns = min(_PANEL_COLUMNS, len(shown))
    rows = math.ceil(len(shown) / columns)
    size = (_WIDTH_INCHES * max(columns, 1.6) / _PANEL_COLUMNS, 0.7 + 2.7 * rows)
    figure = Figure(figsize=size, dpi=_DPI, layout="constrained")
    for index, cell in enumerate(shown):
        axes = figure.add_subplot(rows, columns, index + 1)
        both = cell.theirs is not None
        _shares(axes, of(cell.ours), counts, OURS, -0.2 if both else 0.0, cell.ours)
        if cell.theirs is not None:
            _shares(axes, of(cell.theirs), counts, THEIRS, 0.2, cell.theirs)
        axes.set_title(cell.name)
        axes.set_xticks(range(len(counts)), [_bin_name(counts, place) for place in range(len(counts))])
        axes.set(ylim=(0.0, 1.04), xlim=(-0.6, len(counts) - 0.4), xlabel=what)
        axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "", "50 %", "", "100 %"])
        axes.grid(axis="y", color=GRID, linewidth=0.7)
        axes.set_axisbelow(True)
        if index % columns == 0:
            axes.set_ylabel("share of missions")
    _add_legend(figure, shown, "\N{MULTIPLICATION SIGN}: mean; bars end in 95 % intervals")
    return figure


@styled
def draw_survival(cells: Sequence[Cell]) -> Figure:
    """Draw the share of missions still running, by time (Kaplan-Meier), with pointwise 95 % intervals."""
    shown = cells[:MAX_CELLS]
    columns = min(_PANEL_COLUMNS, len(shown))
    rows = math.ceil(len(shown) / columns)
    size = (_WIDTH_INCHES * max(columns, 1.6) / _PANEL_COLUMNS, 0.7 + 2.6 * rows)
    figure = Figure(figsize=size, dpi=_DPI, layout="constrained")
    first: Axes | None = None
    for index, cell in enumerate(shown):
        axes = figure.add_subplot(rows, columns, index + 1, sharex=first, sharey=first)
        first = first or axes
        for sample, colour in ((cell.ours, OURS), (cell.theirs, THEIRS)):
            if sample is not None:
                _curve(axes, sample, colour)
        axes.set_title(cell.name)
        axes.set(xlabel="time [s]", ylim=(-0.02, 1.04), ylabel="still exploring" if index % columns == 0 else "")
        axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "", "50 %", "", "100 %"])
        axes.grid(color=GRID, linewidth=0.7)
    assert first is not None
    earliest = min(float(s.restricted_s.min()) for cell in shown for s in (cell.ours, cell.theirs) if s is not None)
    latest = max(cell.ours.limit_s for cell in shown)
    first.set_xlim(max(0.0, earliest - 0.12 * latest), latest * 1.02)
    _add_legend(figure, shown, "|: cut short (censored at the limit)")
    return figure


@styled
def draw_ratios(comparisons: Sequence[Comparison]) -> Figure:
    """Draw the ratios of mean times, ours over the dissertation's, with their 90 % intervals and the margin.

    Ratios without an interval, of single missions, are omitted.
    """
    comparisons = [comparison for comparison in comparisons if math.isfinite(comparison.mean.interval.high)]
    figure = Figure(figsize=(_WIDTH_INCHES, 1.3 + 0.55 * len(comparisons)), dpi=_DPI, layout="constrained")
    axes = figure.subplots()
    axes.axvspan(1.0 - MARGIN, 1.0 + MARGIN, color=palette.REPRODUCED, alpha=0.13, linewidth=0)
    axes.axvline(1.0, color=palette.REPRODUCED, linewidth=1.0)
    for place, comparison in enumerate(comparisons):
        interval = comparison.mean.interval
        axes.plot([interval.low, interval.high], [-place, -place], color=OURS, linewidth=3.0, solid_capstyle="butt")
        axes.plot(interval.value, -place, "D", color=OURS, markersize=8, markeredgecolor=PAPER)
        axes.annotate(
            f"{interval.value:.3f}", (interval.value, -place), xytext=(0, 8), textcoords="offset points", ha="center"
        )
    ends = [end for c in comparisons for end in (c.mean.interval.low, c.mean.interval.high)]
    axes.set_xlim(min(0.85, *ends) - 0.02, max(1.15, *ends) + 0.02)
    axes.set_yticks([-place for place in range(len(comparisons))], [c.name for c in comparisons])
    axes.set(ylim=(-len(comparisons) + 0.4, 0.7), xlabel="mean time, ours over the dissertation's")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    return figure


def _rows(cells: Sequence[Cell]) -> list[tuple[str, Sample, str]]:
    rows = []
    for cell in cells[:MAX_CELLS]:
        rows.append((f"{cell.name}, ours" if cell.theirs else cell.name, cell.ours, OURS))
        if cell.theirs is not None:
            rows.append((f"{cell.name}, dissertation", cell.theirs, THEIRS))
    return rows


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
    step = max(1, math.ceil((highest - lowest + 1) / 8))
    return [(start, start + step - 1) for start in range(lowest, max(highest, 1) + 1, step)]


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


def _add_legend(figure: Figure, cells: Sequence[Cell], note: str) -> None:
    handles, labels = [], []
    if any(cell.theirs is not None for cell in cells):
        handles = [Line2D([], [], color=colour, linewidth=6, alpha=0.6) for colour in (OURS, THEIRS)]
        labels = ["ours", "dissertation"]
    handles.append(Line2D([], [], linestyle=""))
    figure.legend(handles, [*labels, note], loc="outside lower center", ncols=3, frameon=False, fontsize=9)

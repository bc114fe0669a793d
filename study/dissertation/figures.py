"""The figure of durations compared with the dissertation."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.report.figures import DPI, WIDTH_INCHES, styled
from robotteamsim.palette import OURS, PAPER
from study.dissertation.comparison import MARGIN, Comparison

REPRODUCED, CONTRADICTED, UNDECIDED = "#00795a", "#b34a00", "#8a6100"
"""Verdicts: green, vermillion and orange, dark enough for text."""


@styled
def draw_ratios(comparisons: Sequence[Comparison]) -> Figure:
    """Draw the ratios of mean times, ours over the dissertation's, with their 90 % intervals and the margin.

    Ratios without an interval, of single missions, are omitted.
    """
    comparisons = [comparison for comparison in comparisons if math.isfinite(comparison.mean.interval.high)]
    figure = PlainFigure(figsize=(WIDTH_INCHES, 1.3 + 0.55 * len(comparisons)), dpi=DPI, layout="constrained")
    axes = figure.subplots()
    axes.axvspan(1.0 - MARGIN, 1.0 + MARGIN, color=REPRODUCED, alpha=0.13, linewidth=0)
    axes.axvline(1.0, color=REPRODUCED, linewidth=1.0)
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

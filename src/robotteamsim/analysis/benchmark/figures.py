"""Figures of benchmarks: performance profiles and idleness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from robotteamsim import palette
from robotteamsim.analysis.benchmark.measures import PatrolSample
from robotteamsim.analysis.benchmark.profile import Profile
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.report.figures import DPI, WIDTH_INCHES, share_panels, styled
from robotteamsim.analysis.report.statistics import bootstrap_mean, generator

CLAIRVOYANT = "clairvoyant"
"""The name of the lower bound among the solvers."""

_WIDEST = 64.0
"""Largest factor shown."""


@styled
def draw_profiles(by_building: Mapping[str, Mapping[str, Profile]]) -> Figure:
    """Draw the performance profiles of all controllers, a panel for each building."""
    figure, all_axes = share_panels(len(by_building), "missions that save all")
    colours = _colours([name for profiles in by_building.values() for name in profiles])
    for axes, (building, profiles) in zip(all_axes, by_building.items(), strict=True):
        for name, profile in profiles.items():
            _draw_profile(axes, profile, colours[name], name)
        axes.set_title(building)
        axes.set_xscale("log", base=2)
        axes.set(xlim=(1.0, _WIDEST), xlabel="time over the best time")
        axes.set_xticks([1, 2, 4, 8, 16, 32, 64], ["1", "2", "4", "8", "16", "32", "64"])
        axes.grid(axis="x", color=palette.GRID, linewidth=0.7)
    _add_legend(figure)
    return figure


@styled
def draw_idleness(samples: Sequence[PatrolSample]) -> Figure:
    """Draw mean and greatest idleness by the number of robots, with 95 % bootstrap intervals."""
    figure = PlainFigure(figsize=(WIDTH_INCHES, 3.8), dpi=DPI, layout="constrained")
    names = list(dict.fromkeys(sample.controller for sample in samples))
    colours = _colours(names)
    for place, (key, title) in enumerate((("mean_s", "mean idleness"), ("max_s", "greatest idleness"))):
        axes = figure.add_subplot(1, 2, place + 1)
        for name in names:
            own = [sample for sample in samples if sample.controller == name]
            means = [bootstrap_mean(getattr(s, key), generator(key, name, s.robots)) for s in own]
            robots = [sample.robots for sample in own]
            axes.plot(robots, [mean.value for mean in means], "o-", color=colours[name], label=name)
            axes.fill_between(
                robots, [m.low for m in means], [m.high for m in means], color=colours[name], alpha=0.2, linewidth=0
            )
        axes.set_title(title)
        axes.set(xlabel="robots", ylabel="[s]" if place == 0 else "")
        axes.xaxis.set_major_locator(MaxNLocator(8, integer=True))
        axes.set_ylim(bottom=0.0)
        axes.grid(color=palette.GRID, linewidth=0.7)
    _add_legend(figure)
    return figure


def _draw_profile(axes: Axes, profile: Profile, colour: str, name: str) -> None:
    ratios = np.append(profile.ratios, max(_WIDEST, float(profile.ratios[-1])))
    shares = np.append(profile.shares, profile.shares[-1])
    dashes = "--" if name == CLAIRVOYANT else "-"
    axes.step(ratios, shares, where="post", color=colour, linewidth=1.8, linestyle=dashes, label=name)


def _add_legend(figure: Figure) -> None:
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=9)


def _colours(names: Sequence[str]) -> dict[str, str]:
    solvers = [name for name in dict.fromkeys(names) if name != CLAIRVOYANT]
    return {name: palette.robot_colour(index) for index, name in enumerate(solvers)} | {CLAIRVOYANT: palette.INK}

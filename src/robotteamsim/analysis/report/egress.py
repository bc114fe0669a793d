"""How people left the missions of a campaign: tables of egress times, doses and exits, and people out over time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from robotteamsim.analysis.report.figures import MAX_PANELS, share_panels, styled
from robotteamsim.analysis.report.samples import Panel, Sample
from robotteamsim.analysis.report.statistics import bootstrap_mean, clopper_pearson, generator
from robotteamsim.analysis.report.tables import Table
from robotteamsim.analysis.report.wording import interval_text, share_text
from robotteamsim.mission.egress import Egress
from robotteamsim.palette import GRID

_BAND = (2.5, 97.5)
"""Percentiles of the missions between which the band of a figure lies."""

_TIMES = 400


def has_ways_out(panels: Sequence[Panel]) -> bool:
    """Whether people can leave in the missions of some panel."""
    return any(_can_leave(sample) for _, sample in _samples(panels))


def egress_table(panels: Sequence[Panel]) -> Table:
    """Return required and available safe egress times and doses of each setting in which people can leave."""
    head = ("", "missions", "people out", "all out", "RSET [s]", "untenable", "ASET [s]", "largest FED")
    rows = tuple(_egress_row(name, sample.egress) for name, sample in _samples(panels) if _can_leave(sample))
    title = (
        "Egress: means with 95 % bootstrap intervals, RSET of missions in which all who flee were safe, ASET of those"
    )
    return Table("egress", f"{title} in which conditions became untenable for somebody", head, rows)


def exit_table(panels: Sequence[Panel]) -> Table:
    """Return how many people left by each exit in each setting, and when it became untenable."""
    rows = []
    for name, sample in _samples(panels):
        for way_out in sorted({way_out for egress in sample.egress for way_out in egress.num_out}):
            counts = np.array([float(egress.num_out.get(way_out, 0)) for egress in sample.egress])
            times_s = [time_s for egress in sample.egress if (time_s := _untenable_s(egress, way_out)) is not None]
            mean = interval_text(bootstrap_mean(counts, generator("exit", name, way_out)), 1)
            closed = _mean(times_s, 1, "untenable exit", name, way_out)
            rows.append((name, way_out, str(len(counts)), mean, str(len(times_s)), closed))
    title = "Exits: people out, and when the exit became untenable, after ignition; means with 95 % bootstrap intervals"
    return Table("exits", title, ("", "exit", "missions", "people out", "untenable in", "after [s]"), tuple(rows), 2)


@styled
def draw_people_out(panels: Sequence[Panel]) -> Figure:
    """Draw the mean number of people who are safe by time, with the band that contains 95 % of the missions."""
    shown = [panel for panel in panels if has_ways_out([panel])][:MAX_PANELS]
    figure, all_axes = share_panels(len(shown), "people out")
    most = max(len(egress.people) for _, sample in _samples(shown) for egress in sample.egress)
    for axes, panel in zip(all_axes, shown, strict=True):
        for each in panel.series:
            times_s = np.linspace(0.0, float(each.missions.time_s.max()), _TIMES)
            counts = np.array([_num_out(egress, times_s) for egress in each.missions.egress])
            low, high = np.percentile(counts, _BAND, axis=0)
            axes.fill_between(times_s, low, high, step="post", color=each.colour, alpha=0.2, linewidth=0)
            axes.step(times_s, counts.mean(axis=0), where="post", color=each.colour, linewidth=2.0, label=each.label)
        axes.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=5))
        axes.yaxis.set_major_formatter("{x:g}")
        axes.set(ylim=(0.0, 1.04 * most), xlim=(0.0, None), xlabel="time [s]")
        axes.set_title(panel.name)
        axes.grid(axis="x", color=GRID, linewidth=0.7)
    return figure


def _can_leave(sample: Sample) -> bool:
    return any(egress.has_ways_out for egress in sample.egress)


def _samples(panels: Sequence[Panel]) -> list[tuple[str, Sample]]:
    return [(name, each.missions) for panel in panels for name, each in panel.named()]


def _egress_row(name: str, missions: Sequence[Egress]) -> tuple[str, ...]:
    def known(of: Callable[[Egress], float | None]) -> list[float]:
        return [value for egress in missions if (value := of(egress)) is not None]

    rset_s, aset_s = known(lambda egress: egress.rset_s), known(lambda egress: egress.aset_s)
    return (
        name,
        str(len(missions)),
        _mean([float(sum(egress.num_out.values())) for egress in missions], 1, "people out", name),
        share_text(clopper_pearson(len(rset_s), len(missions))),
        _mean(rset_s, 1, "RSET", name),
        share_text(clopper_pearson(len(aset_s), len(missions))),
        _mean(aset_s, 1, "ASET", name),
        _mean([max((person.dose for person in egress.people), default=0.0) for egress in missions], 2, "FED", name),
    )


def _mean(values: Sequence[float], digits: int, *names: str) -> str:
    return interval_text(bootstrap_mean(np.array(values), generator(*names)), digits) if values else "-"


def _untenable_s(egress: Egress, way_out: str) -> float | None:
    """Return when an exit became untenable, after ignition [s]; None: it did not."""
    found = next((each.untenable_s for each in egress.exits if each.name == way_out), None)
    return None if found is None else found - egress.begin_s


def _num_out(egress: Egress, times_s: np.ndarray) -> np.ndarray:
    """Return how many people are safe at each time, int, shape (n,)."""
    out_s = np.sort([person.out_s for person in egress.people if person.out_s is not None])
    return np.asarray(np.searchsorted(out_s, times_s, side="right"))

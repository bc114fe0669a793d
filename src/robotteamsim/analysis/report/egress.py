"""How people left the missions of a campaign: tables of egress times, doses and exits."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robotteamsim.analysis.report.samples import Panel, Sample
from robotteamsim.analysis.report.statistics import bootstrap_mean, clopper_pearson, generator
from robotteamsim.analysis.report.tables import UNKNOWN, Entry, Table, interval_entry, share_entry
from robotteamsim.mission.egress import Egress


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
            mean = interval_entry(bootstrap_mean(counts, generator("exit", name, way_out)), 1)
            closed = _mean(times_s, 1, "untenable exit", name, way_out)
            rows.append((name, way_out, str(len(counts)), mean, str(len(times_s)), closed))
    title = "Exits: people out, and when the exit became untenable, after ignition; means with 95 % bootstrap intervals"
    return Table("exits", title, ("", "exit", "missions", "people out", "untenable in", "after [s]"), tuple(rows), 2)


def _can_leave(sample: Sample) -> bool:
    return any(egress.has_ways_out for egress in sample.egress)


def _samples(panels: Sequence[Panel]) -> list[tuple[str, Sample]]:
    return [(name, each.missions) for panel in panels for name, each in panel.named()]


def _egress_row(name: str, missions: Sequence[Egress]) -> tuple[str | Entry, ...]:
    def known(of: Callable[[Egress], float | None]) -> list[float]:
        return [value for egress in missions if (value := of(egress)) is not None]

    rset_s, aset_s = known(lambda egress: egress.rset_s), known(lambda egress: egress.aset_s)
    return (
        name,
        str(len(missions)),
        _mean([float(sum(egress.num_out.values())) for egress in missions], 1, "people out", name),
        share_entry(clopper_pearson(len(rset_s), len(missions))),
        _mean(rset_s, 1, "RSET", name),
        share_entry(clopper_pearson(len(aset_s), len(missions))),
        _mean(aset_s, 1, "ASET", name),
        _mean([max((person.dose for person in egress.people), default=0.0) for egress in missions], 2, "FED", name),
    )


def _mean(values: Sequence[float], digits: int, *names: str) -> Entry:
    return interval_entry(bootstrap_mean(np.array(values), generator(*names)), digits) if values else UNKNOWN


def _untenable_s(egress: Egress, way_out: str) -> float | None:
    """Return when an exit became untenable, after ignition [s]; None: it did not."""
    found = next((each.untenable_s for each in egress.exits if each.name == way_out), None)
    return None if found is None else found - egress.begin_s

"""Tables of benchmarks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotteamsim.analysis.benchmark.figures import CLAIRVOYANT
from robotteamsim.analysis.benchmark.measures import ExplorationSample, PatrolSample, SearchSample
from robotteamsim.analysis.benchmark.profile import Profile
from robotteamsim.analysis.report.statistics import bootstrap_mean, clopper_pearson, generator
from robotteamsim.analysis.report.tables import UNKNOWN, Entry, Table, interval_entry, share_entry
from robotteamsim.analysis.report.wording import percents

FACTORS = (1.5, 2.0, 4.0, 8.0, 16.0)
"""Factors of the best time in the table of profiles."""


def mission_table(samples: Sequence[SearchSample]) -> Table:
    """Return the results of each controller in each place, after the bound of that place."""
    rows = []
    for index, sample in enumerate(samples):
        if index == 0 or sample.place != samples[index - 1].place:
            rows.append(_bound_row(sample))
        name = sample.place.name, sample.controller
        saved_all = int(np.isfinite(sample.last_s).sum())
        rows.append(
            (
                *name,
                str(len(sample.numbers)),
                interval_entry(bootstrap_mean(sample.saved.astype(float), generator("saved", *name)), 2),
                share_entry(clopper_pearson(saved_all, len(sample.numbers))),
                interval_entry(bootstrap_mean(sample.restricted_s, generator("last", *name)), 1),
                _median_ratio(sample),
                interval_entry(bootstrap_mean(sample.areas.astype(float), generator("areas", *name)), 2),
                _coverage(sample),
                f"{np.mean(sample.end_s):.1f}",
            )
        )
    head = ("place", "controller", "missions", "victims saved", "all saved", "time to save all [s]", "over the bound")
    title = "Search: means with 95 % bootstrap intervals; shares with exact intervals"
    return Table("search", title, (*head, "areas", "floor covered [%]", "end [s]"), tuple(rows), 2)


def profile_table(by_building: Mapping[str, Mapping[str, Profile]]) -> Table:
    """Return the performance profiles at some factors."""
    rows = tuple(
        (building, name, *percents(*(profile.at(factor) for factor in FACTORS)))
        for building, profiles in by_building.items()
        for name, profile in profiles.items()
    )
    head = ("building", "controller", *(f"within {factor:g}" for factor in FACTORS))
    return Table(
        "profiles", "Missions that save all victims within a factor of the best time of all controllers", head, rows, 2
    )


def idleness_table(samples: Sequence[PatrolSample]) -> Table:
    """Return mean and greatest idleness of each controller and number of robots."""
    rows = []
    for sample in samples:
        name = sample.controller, sample.robots
        worst = int(np.argmax(sample.vertices_s.mean(axis=0)))
        rows.append(
            (
                sample.controller,
                str(sample.robots),
                str(len(sample.numbers)),
                interval_entry(bootstrap_mean(sample.mean_s, generator("mean_s", *name)), 1),
                interval_entry(bootstrap_mean(sample.max_s, generator("max_s", *name)), 1),
                f"{sample.vertices_s.mean(axis=0).std():.1f}",
                f"{worst}",
                f"{sample.vertices_s[:, worst].mean():.1f}",
            )
        )
    head = ("controller", "robots", "missions", "mean idleness [s]", "greatest idleness [s]", "SD of vertices [s]")
    title = "Idleness: means with 95 % bootstrap intervals; the vertex with the highest mean"
    return Table("idleness", title, (*head, "worst vertex", "its mean [s]"), tuple(rows), 2)


def exploration_table(samples: Sequence[ExplorationSample]) -> Table:
    """Return how fast each controller explored under each set of conditions, and how right the maps are."""
    rows = []
    for sample in samples:
        name = sample.where, sample.controller
        rows.append(
            (
                *name,
                str(len(sample.numbers)),
                *_time_entries(sample.t90_s),
                *_time_entries(sample.t99_s),
                *(
                    interval_entry(bootstrap_mean(100.0 * getattr(sample, key), generator(key, *name)), 1)
                    for key in ("known", "right", "aligned")
                ),
                f"{np.mean(sample.bytes_per_s):.0f}",
            )
        )
    times = ("T_90 median [s]", "without T_90", "T_99 median [s]", "without T_99")
    shares = ("floor known [%]", "walls within 10 cm [%]", "aligned [%]", "bytes per robot and s")
    title = "Exploration: medians of times; means with 95 % bootstrap intervals"
    return Table("exploration", title, ("conditions", "controller", "missions", *times, *shares), tuple(rows), 2)


def _time_entries(times_s: np.ndarray) -> tuple[str | Entry, str]:
    """Return the median, in which infinity is the largest value, and how often the time is infinite."""
    median_s = float(np.median(times_s))
    return f"{median_s:.0f}" if np.isfinite(median_s) else UNKNOWN, str(int(np.isinf(times_s).sum()))


def vertex_table(samples: Sequence[PatrolSample]) -> Table:
    """Return the idleness of every vertex."""
    rows = tuple(
        (
            sample.controller,
            str(sample.robots),
            str(vertex),
            f"{sample.vertices_s[:, vertex].mean():.1f}",
            f"{sample.vertex_max_s[:, vertex].max():.1f}",
            f"{sample.visits[:, vertex].mean():.1f}",
        )
        for sample in samples
        for vertex in range(sample.vertices_s.shape[1])
    )
    head = ("controller", "robots", "vertex", "mean idleness [s]", "greatest idleness [s]", "visits per mission")
    return Table("vertices", "Idleness of each vertex over all missions", head, rows, 2)


def _bound_row(sample: SearchSample) -> tuple[str | Entry, ...]:
    mean = interval_entry(bootstrap_mean(sample.bound_s, generator("bound", sample.place.name)), 1)
    rest = (f"{sample.num_victims:d}", UNKNOWN, mean, "1.00", UNKNOWN, UNKNOWN, UNKNOWN)
    return (sample.place.name, f"{CLAIRVOYANT} (lower bound)", str(len(sample.numbers)), *rest)


def _coverage(sample: SearchSample) -> Entry:
    if not sample.coverage.size:
        return UNKNOWN
    rng = generator("coverage", sample.place.name, sample.controller)
    return interval_entry(bootstrap_mean(100.0 * sample.coverage, rng), 1)


def _median_ratio(sample: SearchSample) -> str | Entry:
    """Return the median of the time over the bound, of the missions that save all victims."""
    solved = np.isfinite(sample.last_s)
    if not solved.any():
        return UNKNOWN
    least = np.maximum(sample.bound_s[solved], sample.step_s)
    return f"{np.median(np.maximum(sample.last_s[solved], sample.step_s) / least):.2f}"

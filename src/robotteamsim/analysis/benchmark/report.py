"""The report of a benchmark: one page with everything, and its figures and tables as files."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources

import jinja2
import numpy as np

import robotteamsim
from robotteamsim import palette
from robotteamsim.analysis.benchmark.comparisons import Pair, differences
from robotteamsim.analysis.benchmark.figures import CLAIRVOYANT, draw_idleness, draw_profiles
from robotteamsim.analysis.benchmark.measures import Bounds, PatrolSample, SearchSample, patrol_samples, search_samples
from robotteamsim.analysis.benchmark.profile import Profile, profiles
from robotteamsim.analysis.benchmark.tables import (
    difference_table,
    idleness_table,
    mission_table,
    profile_table,
    vertex_table,
)
from robotteamsim.analysis.report.page import PAGE_NAME, Report
from robotteamsim.analysis.report.pictures import Picture, picture
from robotteamsim.analysis.report.tables import Table
from robotteamsim.analysis.report.wording import unbroken
from robotteamsim.campaign import Design, Outcome
from robotteamsim.errors import CampaignError
from robotteamsim.wording import counted

SAVED, LAST, MEAN, GREATEST = "victims saved", "time to save all [s]", "mean idleness [s]", "greatest idleness [s]"

_READING_SEARCH = (
    ("time to save all", "When the last victim was saved; a mission that does not save all counts as the time limit."),
    (
        CLAIRVOYANT,
        "A team that knows all victims. Its time is a lower bound with a proof (docs/benchmark.md); it does not drive.",
    ),
    ("over the bound", "Median over the missions that save all victims; 1 cannot be beaten."),
    (
        "profile",
        "Share of missions in which a controller saves all victims within a factor of the best time [dolan2002]. The "
        "clairvoyant team is among the solvers, so the best time is the bound.",
    ),
    ("differences", "Pairs have the same victims, voices and sensor noise. Look at the interval before p."),
)
_READING_PATROL = (
    ("idleness", "Time for which no robot has been at a vertex; 0 at the start of the mission [machado2002]."),
    ("mean", "Over time, then over vertices. The greatest idleness is the largest value of any vertex at any time."),
    ("differences", "Pairs have the same seed. Look at the interval before p."),
)


@dataclass(frozen=True, slots=True)
class BenchmarkReport:
    """The report of a benchmark and its tables, the most important first."""

    report: Report
    tables: tuple[Table, ...]


def make_search_report(design: Design, outcomes: Sequence[Outcome], command: str, bounds: Bounds) -> BenchmarkReport:
    """Return the report of a search benchmark. Raises: CampaignError: no mission has ended."""
    samples = search_samples(design, outcomes, bounds)
    if not samples:
        raise CampaignError("no mission of this benchmark has ended; nothing to report")
    by_building = _profiles(samples)
    pairs = _search_pairs(samples)
    found = (
        *differences(pairs, SAVED, lambda sample: sample.saved),
        *differences(pairs, LAST, lambda sample: sample.restricted_s),
    )
    drawn = picture(
        "profiles",
        "Performance profiles",
        "Share of missions that save all victims within a factor of the best time, over all noises and teams.",
        draw_profiles(by_building),
    )
    tables = (
        mission_table(samples),
        difference_table(found, {SAVED: 2, LAST: 1}),
        profile_table(by_building),
    )
    notes = (*_notes(design, outcomes), *_search_notes(samples))
    title = f"Search benchmark: {counted(len(outcomes), 'mission')}"
    return _report(title, notes, [drawn], tables, _READING_SEARCH, command)


def make_patrol_report(design: Design, outcomes: Sequence[Outcome], command: str) -> BenchmarkReport:
    """Return the report of a patrol benchmark. Raises: CampaignError: no mission has ended."""
    samples = patrol_samples(design, outcomes)
    if not samples:
        raise CampaignError("no mission of this benchmark has ended; nothing to report")
    pairs = _patrol_pairs(samples)
    found = (
        *differences(pairs, MEAN, lambda sample: sample.mean_s),
        *differences(pairs, GREATEST, lambda sample: sample.max_s),
    )
    drawn = picture(
        "idleness",
        "Idleness by the number of robots",
        "Means over all missions with 95 % bootstrap intervals.",
        draw_idleness(samples),
    )
    tables = (idleness_table(samples), difference_table(found, {MEAN: 1, GREATEST: 1}), vertex_table(samples))
    title = f"Patrol benchmark in {design.scenario.name}: {counted(len(outcomes), 'mission')}"
    return _report(title, _notes(design, outcomes), [drawn], tables, _READING_PATROL, command)


def _profiles(samples: Sequence[SearchSample]) -> dict[str, dict[str, Profile]]:
    """Return the profiles of each building over the missions that all its controllers have finished."""
    places: dict[str, dict[object, dict[str, SearchSample]]] = defaultdict(lambda: defaultdict(dict))
    controllers = list(dict.fromkeys(sample.controller for sample in samples))
    for sample in samples:
        places[sample.place.building][sample.place][sample.controller] = sample
    found = {}
    for building, by_place in places.items():
        times: dict[str, list[float]] = {name: [] for name in (CLAIRVOYANT, *controllers)}
        for of in by_place.values():
            if len(of) < len(controllers):
                continue
            shared = set.intersection(*(set(sample.numbers.tolist()) for sample in of.values()))
            for name, sample in of.items():
                at = np.isin(sample.numbers, sorted(shared))
                times[name] += np.maximum(sample.last_s[at], sample.step_s).tolist()
            times[CLAIRVOYANT] += np.maximum(sample.bound_s[at], sample.step_s).tolist()
        if times[CLAIRVOYANT]:
            found[building] = profiles({name: np.array(values) for name, values in times.items()})
    return found


def _search_pairs(samples: Sequence[SearchSample]) -> list[Pair[SearchSample]]:
    reference = {s.place: s for s in samples if s.controller == samples[0].controller}
    return [
        Pair(s.place.name, first, s, (first.controller, s.controller), (first.numbers, s.numbers))
        for s in samples
        if (first := reference.get(s.place)) is not None and s is not first
    ]


def _patrol_pairs(samples: Sequence[PatrolSample]) -> list[Pair[PatrolSample]]:
    reference = {s.robots: s for s in samples if s.controller == samples[0].controller}
    return [
        Pair(counted(s.robots, "robot"), first, s, (first.controller, s.controller), (first.numbers, s.numbers))
        for s in samples
        if (first := reference.get(s.robots)) is not None and s is not first
    ]


def _notes(design: Design, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    notes = []
    total, failed = len(design.cells) * design.trials, sum(outcome.failed for outcome in outcomes)
    if len(outcomes) < total:
        notes.append(f"This benchmark is unfinished: {len(outcomes)} of {total} missions are done.")
    if failed:
        notes.append(f"Omitted: {counted(failed, 'failed mission')}; the store contains the tracebacks.")
    return tuple(notes)


def _search_notes(samples: Sequence[SearchSample]) -> tuple[str, ...]:
    hopeless = sum(int((sample.bound_s > sample.limit_s).sum()) for sample in samples)
    if not hopeless:
        return ()
    return (f"In {counted(hopeless, 'mission')} the bound is above the time limit: no team can save all in time.",)


def _report(
    title: str,
    notes: Sequence[str],
    pictures: Sequence[Picture],
    tables: Sequence[Table],
    reading: Sequence[tuple[str, str]],
    command: str,
) -> BenchmarkReport:
    text = (resources.files("robotteamsim.analysis.benchmark") / "page.html").read_text(encoding="utf-8")
    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    environment.filters["unbroken"] = unbroken
    shown = [table for table in tables if table.rows]
    page = environment.from_string(text).render(
        title=title,
        colours=palette.css(),
        notes=notes,
        pictures=pictures,
        tables=shown,
        reading=reading,
        command=command,
        version=robotteamsim.__version__,
    )
    files = {f"figures/{drawn.name}.png": drawn.png for drawn in pictures}
    for table in shown:
        files[f"tables/{table.name}.csv"] = table.csv().encode()
        files[f"tables/{table.name}.tex"] = table.latex().encode()
    return BenchmarkReport(Report((), (title,), tuple(notes), files | {PAGE_NAME: page.encode()}), tuple(shown))

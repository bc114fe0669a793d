"""The report of a benchmark: one page with everything, and its figures and tables as files."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np

import robotteamsim
from robotteamsim.analysis.benchmark.figures import CLAIRVOYANT, draw_idleness, draw_profiles
from robotteamsim.analysis.benchmark.measures import (
    ExplorationSample,
    Mission,
    PatrolSample,
    SearchSample,
    exploration_samples,
    patrol_samples,
    search_samples,
)
from robotteamsim.analysis.benchmark.profile import Profile, profiles
from robotteamsim.analysis.benchmark.tables import (
    exploration_table,
    idleness_table,
    mission_table,
    profile_table,
    vertex_table,
)
from robotteamsim.analysis.report.contrasts import Pair, compare
from robotteamsim.analysis.report.page import FOLDER, Report, render
from robotteamsim.analysis.report.pictures import Picture, picture
from robotteamsim.analysis.report.tables import Table, difference_table, network_table
from robotteamsim.campaign import Design, Outcome
from robotteamsim.campaign.summary import controllers_note, copies_note, summarise
from robotteamsim.errors import CampaignError
from robotteamsim.wording import counted

AnySample = TypeVar("AnySample", SearchSample, PatrolSample, ExplorationSample)

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
    ("differences", "Pairs have the same starts. Look at the interval before p."),
)

_READING_EXPLORATION = (
    ("T_90, T_99", "When some robot of the team knew 90 % and 99 % of the floor that robots can reach."),
    (
        "without T_90, T_99",
        "Missions in which that never happened. Medians rank them last; means of differences count the time limit.",
    ),
    ("walls within 10 cm", "Share of the found wall cells next to a true wall. Read it with the floor known."),
    ("aligned", "The same after each map was turned and shifted to fit best: the shape of the map, not its place."),
    (
        "differences",
        "Pairs have the same starts and sensor noise. Of tests, pairs in which one team did not get there rank first.",
    ),
)


def make_search_report(
    design: Design, outcomes: Sequence[Outcome], command: str, bounds: Mapping[Mission, float]
) -> Report:
    """Return the report of a search benchmark. Raises: CampaignError: no mission has ended."""
    samples = search_samples(design, outcomes, bounds)
    if not samples:
        raise CampaignError("no mission of this benchmark has ended; nothing to report")
    by_building = _profiles(samples)
    pairs = _with_reference(samples)
    found = [
        *compare(pairs, "victims saved", 2, lambda sample: sample.saved, paired=True),
        *compare(pairs, "time to save all [s]", 1, lambda sample: sample.restricted_s, paired=True),
    ]
    drawn = []
    if by_building:
        text = "Share of missions that save all victims within a factor of the best time, over all noises and teams."
        drawn = [picture("profiles", "Performance profiles", text, draw_profiles(by_building))]
    tables = (
        mission_table(samples),
        network_table(("place", "controller"), [((s.place.name, s.controller), s.networks) for s in samples]),
        difference_table([each for each in found if each]),
        profile_table(by_building),
    )
    notes = (*_notes(design, outcomes), *_search_notes(samples))
    title = f"Search benchmark: {counted(len(outcomes), 'mission')}"
    return _report(title, notes, drawn, tables, _READING_SEARCH, command)


def make_patrol_report(design: Design, outcomes: Sequence[Outcome], command: str) -> Report:
    """Return the report of a patrol benchmark. Raises: CampaignError: no mission has ended."""
    samples = patrol_samples(design, outcomes)
    if not samples:
        raise CampaignError("no mission of this benchmark has ended; nothing to report")
    pairs = _with_reference(samples)
    found = [
        *compare(pairs, "mean idleness [s]", 1, lambda sample: sample.mean_s, paired=True),
        *compare(pairs, "greatest idleness [s]", 1, lambda sample: sample.max_s, paired=True),
    ]
    drawn = picture(
        "idleness",
        "Idleness by the number of robots",
        "Means over all missions with 95 % bootstrap intervals.",
        draw_idleness(samples),
    )
    tables = (
        idleness_table(samples),
        network_table(("controller", "robots"), [((s.controller, str(s.robots)), s.networks) for s in samples]),
        difference_table([each for each in found if each]),
        vertex_table(samples),
    )
    title = f"Patrol benchmark in {design.scenario.name}: {counted(len(outcomes), 'mission')}"
    return _report(title, _notes(design, outcomes), [drawn], tables, _READING_PATROL, command)


def make_exploration_report(design: Design, outcomes: Sequence[Outcome], command: str) -> Report:
    """Return the report of an exploration benchmark. Raises: CampaignError: no mission has ended."""
    samples = exploration_samples(design, outcomes)
    if not samples:
        raise CampaignError("no mission of this benchmark has ended; nothing to report")
    pairs, found = _with_reference(samples), []
    for key in ("t90_s", "t99_s"):
        name = f"T_{key[1:3]} [s]"
        found += compare(pairs, name, 0, partial(_restricted_s, key), paired=True, ranked=partial(_ranked_s, key))
    tables = (exploration_table(samples), difference_table([each for each in found if each]))
    title = f"Exploration benchmark: {counted(len(outcomes), 'mission')}"
    return _report(title, _notes(design, outcomes), [], tables, _READING_EXPLORATION, command)


def _restricted_s(key: str, sample: ExplorationSample) -> np.ndarray:
    """Return times; one that was not reached counts as the limit."""
    return np.asarray(np.minimum(getattr(sample, key), sample.limit_s))


def _ranked_s(key: str, sample: ExplorationSample) -> np.ndarray:
    """Return times; one that was not reached is later than any other by more than two others differ."""
    times_s = getattr(sample, key)
    return np.where(np.isinf(times_s), 3.0 * sample.limit_s, times_s)


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


def _with_reference(samples: Sequence[AnySample]) -> list[Pair[AnySample]]:
    """Return the pairs of each sample and that of the reference, the first controller, in the same place."""
    reference = {s.where: s for s in samples if s.controller == samples[0].controller}
    return [
        Pair(s.where, (first.controller, s.controller), first, s)
        for s in samples
        if (first := reference.get(s.where)) is not None and s is not first
    ]


def _notes(design: Design, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    notes = []
    total, failed = len(design.cells) * design.trials, sum(outcome.failed for outcome in outcomes)
    if len(outcomes) < total:
        notes.append(f"This benchmark is unfinished: {len(outcomes)} of {total} missions are done.")
    if failed:
        notes.append(f"Omitted: {counted(failed, 'failed mission')}; the store contains the tracebacks.")
    if controllers := controllers_note(outcomes):
        notes.append(controllers)
    if copies := copies_note((cell.name, cell.trials, cell.different) for cell in summarise(design, outcomes)):
        notes.append(copies)
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
) -> Report:
    shown = [table for table in tables if table.rows]
    page = render(
        "benchmark.html",
        (Path(__file__).parent, FOLDER),
        heading=title,
        first=notes,
        pictures=pictures,
        tables=shown,
        reading=reading,
        command=command,
        version=robotteamsim.__version__,
    )
    return Report((title,), tuple(notes), page, tuple(pictures), tuple(shown))

"""The page of a report, which contains everything, and its figures and tables as files."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import get_args

import jinja2
import numpy as np
from markupsafe import Markup

from robotteamsim import palette
from robotteamsim.analysis.fields.maps import VoiceRange
from robotteamsim.analysis.report import figures, maps
from robotteamsim.analysis.report.claims import MIN_TRIALS, Claim, judge
from robotteamsim.analysis.report.comparison import MARGIN, SD_FACTOR, VICTIMS_MARGIN, Comparison, compare
from robotteamsim.analysis.report.contrasts import contrasts, overall
from robotteamsim.analysis.report.criteria import Verdict
from robotteamsim.analysis.report.opening import DISSERTATION, calibration, compared_settings
from robotteamsim.analysis.report.pictures import Picture, picture
from robotteamsim.analysis.report.rank_tests import PERMUTATIONS
from robotteamsim.analysis.report.samples import Campaign, Cell, pooled, read_campaign
from robotteamsim.analysis.report.statistics import RESAMPLES, TABLES
from robotteamsim.analysis.report.tables import Table, all_tables, passed_text
from robotteamsim.analysis.report.wording import listed, percents, unbroken
from robotteamsim.campaign import StoredCampaign
from robotteamsim.recording.files import atomically, prepare_folder
from robotteamsim.wording import counted
from robotteamsim.world.placement import placed_robots

PAGE_NAME = "report.html"
_FIGURES, _TABLES = "figures", "tables"


@dataclass(frozen=True, slots=True)
class Report:
    """A report in memory.

    claims: claims with their verdicts; empty if the dissertation has no such missions.
    opening: first paragraphs: how to read the verdicts, or how the settings compare.
    notes:  what is missing or omitted.
    files:  contents by path below the report's folder; the page is last.
    """

    claims: tuple[Claim, ...]
    opening: tuple[str, ...]
    notes: tuple[str, ...]
    files: dict[str, bytes]

    def write(self, folder: Path) -> Path:
        """Write all files and return the page's path. Raises: RecordingError."""
        prepare_folder(folder)
        for parent in sorted({(folder / name).parent for name in self.files}):
            prepare_folder(parent)
        for name, data in self.files.items():
            with atomically(folder / name) as part:
                part.write_bytes(data)
        return folder / PAGE_NAME


@dataclass(frozen=True, slots=True)
class ShownMissions:
    """Missions that the page plays.

    rule:  by which they are chosen.
    frame: HTML of the player, which needs no other file; "" if no mission can be played.
    note:  the reason then.
    """

    rule: str
    frame: str
    note: str


def make_report(
    stored: Sequence[StoredCampaign], places: Sequence[str], missions: ShownMissions | None = None
) -> Report:
    """Return the report of one stored campaign, or of several of one design; the same stores give the same bytes.

    Args:   places: the stores' folders, for messages. missions: to play in the page; None: none.
    Raises: CampaignError: no mission has ended, this version cannot read the scenario, or the campaigns differ.
    """
    campaign = pooled(stored, places)
    parts = [read_campaign(one, place) for one, place in zip(stored, places, strict=True)]
    comparisons, between = compare(campaign), contrasts(campaign)
    claims = judge(campaign, parts)
    tables = all_tables(campaign, comparisons, between, overall(campaign), claims)
    pictures = list(_pictures(campaign, comparisons))
    notes = (*_notes(campaign), *([missions.note] if missions and missions.note else []))
    first = calibration(claims) if claims else compared_settings(between)
    page = _page(campaign, claims, [*first, *notes], pictures, tables, missions)
    files = {f"{_FIGURES}/{drawn.name}.png": drawn.png for drawn in pictures}
    for table in tables:
        files[f"{_TABLES}/{table.name}.csv"] = table.csv().encode()
        files[f"{_TABLES}/{table.name}.tex"] = table.latex().encode()
    return Report(claims, first, notes, files | {PAGE_NAME: page.encode()})


def _notes(campaign: Campaign) -> tuple[str, ...]:
    """Return what is missing or omitted."""
    notes = []
    if campaign.done < campaign.total:
        notes.append(
            f"This campaign is unfinished: {campaign.done} of {campaign.total} trials are done. All results are from "
            "those. The same campaign command runs the rest."
        )
    if campaign.failed:
        notes.append(f"Omitted: {counted(campaign.failed, 'failed trial')}; the store contains the tracebacks.")
    if campaign.empty:
        notes.append(f"Omitted, because no mission has ended: {listed(list(campaign.empty))}.")
    if not campaign.compared:
        notes.append(
            f"The dissertation ({DISSERTATION}) has no missions of these settings: it has garage_sar with 10, 20 and "
            "30 dB of noise. Therefore nothing is compared with it, and none of its claims is judged."
        )
    elif missing := [cell.name for cell in campaign.cells if cell.theirs is None]:
        notes.append(f"The dissertation has no missions with {listed(missing)}; these are not compared.")
    if len(campaign.cells) > figures.MAX_CELLS:
        notes.append(
            f"Figures show the first {figures.MAX_CELLS} of {len(campaign.cells)} settings; tables contain all."
        )
    return tuple(notes)


def _pictures(campaign: Campaign, comparisons: Sequence[Comparison]) -> Iterator[Picture]:
    cells = campaign.cells
    diss = "" if not campaign.compared else "; orange: the dissertation's 30 missions"
    yield from _map_pictures(campaign)
    num_victims = {cell.ours.num_victims for cell in cells}
    if max(num_victims) > 0:
        drawn = figures.draw_counts(
            cells, lambda sample: sample.victims_saved, "victims saved", max(num_victims | {4} if diss else num_victims)
        )
        caption = f"Share of missions by number of victims saved{diss}. Bars end in exact (Clopper-Pearson) intervals."
        yield picture("fig19_victims", f"Victims saved{_number(campaign, 19)}", caption, drawn)
    caption = (
        f"Every mission, the density, the quartiles, and the mean with its bootstrap interval{diss}. A mission that "
        "was cut short counts as the time limit."
    )
    yield picture("fig20_times", f"Mission durations{_number(campaign, 20)}", caption, figures.draw_times(cells))
    yield from _ratio_pictures(comparisons)
    caption = (
        f"Share of missions still exploring at each time (Kaplan-Meier){diss}. Missions that were cut short are "
        "censored at the limit."
    )
    yield picture("survival", "Missions still running", caption, figures.draw_survival(cells))
    num_areas = {cell.ours.num_areas for cell in cells}
    if max(num_areas) > 0:
        drawn = figures.draw_counts(
            cells, lambda sample: sample.areas_explored, "areas explored", max(num_areas | {5} if diss else num_areas)
        )
        caption = f"Share of missions by number of areas explored{diss}."
        yield picture("fig21_areas", f"Areas explored{_number(campaign, 21)}", caption, drawn)
    drawn = figures.draw_counts(cells, lambda sample: sample.endangered, "times a link was endangered", None)
    threshold = f"{campaign.scenario.network.endangered_below_dbm:g} dBm".replace("-", "\N{MINUS SIGN}")
    caption = f"Share of missions by how often a link fell below {threshold}{diss}, in which none did."
    if not diss:
        caption = f"Share of missions by how often a link fell below {threshold}."
    yield picture("fig22_endangered", f"Endangered links{_number(campaign, 22)}", caption, drawn)
    yield from _path_pictures(cells)


def _ratio_pictures(comparisons: Sequence[Comparison]) -> Iterator[Picture]:
    if any(math.isfinite(comparison.mean.interval.high) for comparison in comparisons):
        caption = (
            "Mean duration, ours over the dissertation's, with its 90 % bootstrap interval. If the whole interval is "
            f"within the green band of {100.0 * MARGIN:g} %, the means are equivalent (two one-sided tests)."
        )
        yield picture(
            "equivalence", "Durations compared with the dissertation", caption, figures.draw_ratios(comparisons)
        )


def _path_pictures(cells: Sequence[Cell]) -> Iterator[Picture]:
    if heated := maps.drawable(cells):
        caption = (
            "Mean time that robots spent at each place in a mission. Red: the path of one robot in the mission of "
            "median duration. Circles are the areas in their order, crosses the victims."
        )
        yield picture("paths", "Paths of the robots", caption, maps.draw_heat(heated))


def _map_pictures(campaign: Campaign) -> Iterator[Picture]:
    """Yield the voice and radio maps of this scenario, which need no mission."""
    scenario, noises_db = campaign.scenario, maps.noises_db(campaign)
    if scenario.mission.victims and noises_db:
        ranges: tuple[tuple[int, VoiceRange], ...] = ((16, "lowest"), (17, "highest"))
        for number, voice_range in ranges:
            shares = maps.heard_shares(scenario, noises_db, voice_range)
            heard = listed(
                [f"{share} of the floor at {db:g} dB" for share, db in zip(percents(*shares), noises_db, strict=True)]
            )
            caption = (
                f"A victim is heard in {heard} if all voices have the {voice_range} range of the voice model "
                f"({maps.voice_text(scenario, voice_range)})."
            )
            if campaign.compared:
                caption += " The dissertation prints this figure without numbers, on a floor plan that is lost."
            drawn = maps.draw_voices(scenario, noises_db, voice_range)
            title = f"{voice_range.capitalize()} voice detection range{_number(campaign, number)}"
            yield picture(f"fig{number}_voice_{voice_range}", title, caption, drawn)
    widest_m = maps.widest_moment_m(campaign)
    if widest_m is None:
        places_m = np.array([robot.start_pose[:2] for robot in placed_robots(scenario)])
        when = "with the robots at their start"
    else:
        places_m, when = widest_m, "at the time in all missions when a robot was farthest from its nearest neighbour"
    caption = f"Strongest signal at each place, {when}. Lines are thresholds of the signal for a link."
    drawn = maps.draw_network(scenario, places_m[: maps.MAX_TEAM])
    yield picture("fig18_network", f"Range of the team's network{_number(campaign, 18)}", caption, drawn)


def _number(campaign: Campaign, number: int) -> str:
    """Return the number of the dissertation's figure, if the campaign has its settings."""
    return f" (Figure {number})" if campaign.compared else ""


def _page(
    campaign: Campaign,
    claims: Sequence[Claim],
    first: Sequence[str],
    pictures: Sequence[Picture],
    tables: Sequence[Table],
    missions: ShownMissions | None,
) -> str:
    text = (resources.files("robotteamsim.analysis.report") / "page.html").read_text(encoding="utf-8")
    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    environment.filters |= {"unbroken": unbroken, "passed": passed_text}
    not_fitted = [claim for claim in claims if not claim.fitted]
    opening = () if claims else ("differences",)
    return environment.from_string(text).render(
        campaign=campaign,
        colours=palette.css(),
        groups=(
            ("not-fitted", "Claims that were not fitted: the test", not_fitted),
            ("fitted", "Claims that were fitted: calibration", [claim for claim in claims if claim.fitted]),
        ),
        counts=Counter(claim.verdict for claim in not_fitted),
        verdicts=[name for name in get_args(Verdict) if any(claim.verdict == name for claim in claims)],
        first=first,
        pictures=pictures,
        player=Markup(missions.frame) if missions else "",
        rule=missions.rule if missions else "",
        comparison=[table for table in tables if table.name in opening],
        tables=[table for table in tables if table.name not in ("claims", *opening)],
        missions=f"{sum(cell.trials for cell in campaign.cells):,}",
        dissertation=DISSERTATION,
        min_trials=MIN_TRIALS,
        sd_factor=f"{SD_FACTOR:g}",
        victims_margin=f"{VICTIMS_MARGIN:g}",
        resamples=f"{RESAMPLES:,}",
        random_tables=f"{TABLES:,}",
        permutations=f"{PERMUTATIONS:,}",
        settings=json.dumps({key: campaign.settings[key] for key in ("keys", "cells", "paired", "trials")}),
        fingerprint=campaign.settings["fingerprint"],
        dates=listed(sorted(set(campaign.started))),
        version=campaign.versions["robotteamsim"],
        versions=", ".join(f"{name} {version}" for name, version in campaign.versions.items()),
    )

"""The page of a report, which contains everything, and its figures and tables as files."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import jinja2
from markupsafe import Markup

from robotteamsim import palette
from robotteamsim.analysis.report import figures, maps
from robotteamsim.analysis.report.contrasts import MAX_PAIRS, Contrast, compared_pairs, contrasts, overall
from robotteamsim.analysis.report.egress import egress_table, exit_table
from robotteamsim.analysis.report.figures import SCREEN, Counts, Sheet
from robotteamsim.analysis.report.pictures import Picture, picture
from robotteamsim.analysis.report.rank_tests import PERMUTATIONS
from robotteamsim.analysis.report.samples import Campaign, Cell, Panel, panels_of, pooled
from robotteamsim.analysis.report.statistics import TABLES
from robotteamsim.analysis.report.tables import Table, campaign_tables
from robotteamsim.analysis.report.wording import difference_text, listed, p_text
from robotteamsim.campaign import StoredCampaign
from robotteamsim.campaign.summary import controllers_note, copies_note
from robotteamsim.recording.files import atomically, prepare_folder
from robotteamsim.wording import counted

PAGE_NAME = "report.html"
FOLDER = Path(__file__).parent
"""The folder of the templates base.html and campaign.html."""

_MAX_COMPARED = 6
_MAX_SUMMARISED = 3

READING = (
    (
        "durations",
        "Time until all areas are explored, all victims are safe or dead, or the search is over. A mission that was "
        "cut short counts as the time limit. Means are therefore restricted means: the areas under the survival "
        "curves.",
    ),
    (
        "differences between settings",
        "Means of the second setting minus those of the first, with 95 % t intervals (Welch; of pairs in a paired "
        "campaign), and the probability that a mission of the second has the larger value. Tests come last: "
        f"Mann-Whitney, or Wilcoxon’s signed-rank test of pairs. With at most {PERMUTATIONS:,} permutations, they try "
        "them all and are exact, also with ties. Kruskal-Wallis permutes samples of up to 50 missions in all.",
    ),
    (
        "counts",
        f"Fisher-Freeman-Halton tests with {TABLES:,} random tables; bars of figures end in Clopper-Pearson 95 % "
        "intervals.",
    ),
    (
        "several tests",
        "The p values of one question at several levels have Holm’s correction; the significance level is 0.05.",
    ),
    ("survival", "Kaplan-Meier, with pointwise 95 % intervals on the log-log scale."),
)
"""How to read the figures and tables of a campaign: terms and explanations."""


@dataclass(frozen=True)
class Report:
    """A report in memory.

    opening: first paragraphs: how the settings compare.
    notes:   what is missing or omitted.
    page:    HTML.
    tables:  the most important one first.
    in_columns: whether its files are for a paper in two columns.
    formats: of the files of figures besides PNG: pdf, svg.
    """

    opening: tuple[str, ...]
    notes: tuple[str, ...]
    page: str
    pictures: tuple[Picture, ...]
    tables: tuple[Table, ...]
    in_columns: bool = False
    formats: tuple[str, ...] = ()

    @cached_property
    def files(self) -> dict[str, bytes]:
        """Its files by path below the folder: figures, tables as CSV and LaTeX, the page last."""
        files = {f"figures/{name}": data for one in self.pictures for name, data in one.files(self.formats).items()}
        for table in self.tables:
            files[f"tables/{table.name}.csv"] = table.csv().encode()
            files[f"tables/{table.name}.tex"] = table.latex(in_columns=self.in_columns).encode()
        return files | {PAGE_NAME: self.page.encode()}

    def write(self, folder: Path) -> Path:
        """Write all files, delete figures of further formats of an earlier report; return the page's path.

        Raises: RecordingError.
        """
        prepare_folder(folder)
        for parent in sorted({(folder / name).parent for name in self.files}):
            prepare_folder(parent)
        for name, data in self.files.items():
            with atomically(folder / name) as part:
                part.write_bytes(data)
        for one in self.pictures:
            for kind in {"pdf", "svg"} - set(self.formats):  # of an earlier report, with other data
                (folder / "figures" / f"{one.name}.{kind}").unlink(missing_ok=True)
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
    stored: Sequence[StoredCampaign],
    places: Sequence[str],
    missions: ShownMissions | None = None,
    *,
    each_pair: bool = False,
    paper: Sheet | None = None,
    formats: Sequence[str] = (),
) -> Report:
    """Return the report of one stored campaign, or of several of one design; the same stores give the same bytes.

    Args:   places: the stores' folders, for messages. missions: to play in the page; None: none.
            each_pair: whether to compare each pair of algorithms, not only each with the first, and any number of
            pairs. paper: whose width the files of the figures have; wide tables span its columns.
            formats: of the files of figures besides PNG: pdf, svg.
    Raises: CampaignError: no mission has ended, this version cannot read the scenario, or the campaigns differ.
    """
    campaign = pooled(stored, places)
    panels, between = panels_of(campaign), contrasts(campaign, each_pair=each_pair)
    tables = campaign_tables(panels, between, overall(campaign))
    tables += tuple(table for table in (egress_table(panels), exit_table(panels)) if table.rows)
    pictures = tuple(campaign_pictures(campaign, panels))
    opening, notes = compared_settings(between), campaign_notes(campaign, missions)
    if controllers := controllers_note([outcome for one in stored for outcome in one.outcomes]):
        notes = (controllers, *notes)
    if not each_pair and (count := len(compared_pairs(campaign))) > MAX_PAIRS:
        notes += (f"Settings are not compared: they are {count} pairs; `report --each-pair` compares them.",)
    comparison = tables[:1] if between else ()
    page = campaign_page(
        campaign, [*opening, *notes], pictures, tables[len(comparison) :], missions, comparison=comparison
    )
    files = tuple(campaign_pictures(campaign, panels, paper)) if paper else pictures
    return Report(opening, notes, page, files, tables, in_columns=paper is not None, formats=tuple(formats))


def compared_settings(contrasts: Sequence[Contrast]) -> tuple[str, ...]:
    """Return one paragraph per compared pair of settings; none if there are too many."""
    grouped = [
        list(group) for _, group in itertools.groupby(contrasts, key=lambda each: (each.where, each.first, each.second))
    ]
    return tuple(map(_paragraph, grouped)) if len(grouped) <= _MAX_COMPARED else ()


def _paragraph(contrasts: Sequence[Contrast]) -> str:
    """Return means, difference with interval, and effect size of the first quantities."""
    one = contrasts[0]
    parts = []
    for c in contrasts[:_MAX_SUMMARISED]:
        a, b = (f"{value:.{c.decimals}f}" for value in c.values)
        if c.difference.value == 0.0 and math.isnan(c.difference.low):
            parts.append(f"{c.quantity} equal ({a})")
            continue
        shift = difference_text(c.difference, c.decimals)
        parts.append(
            f"{c.quantity} {b} instead of {a} (difference {shift}, larger in {100.0 * c.superiority:.0f} % of "
            f"comparisons, {p_text(c.p)})"
        )
    where = f" at {one.where}" if one.where else ""
    how = "" if one.pairs is None else f", in {one.pairs} pairs of missions with the same seed"
    return f"{one.second} compared with {one.first}{where}{how}: {'; '.join(parts)}."


def campaign_notes(campaign: Campaign, missions: ShownMissions | None) -> tuple[str, ...]:
    """Return what is missing or omitted in the report of a campaign."""
    notes = []
    if campaign.done < campaign.total:
        notes.append(
            f"This campaign is unfinished: {campaign.done} of {campaign.total} trials are done. All results are from "
            "those. The same campaign command runs the rest."
        )
    if campaign.failed:
        notes.append(f"Omitted: {counted(campaign.failed, 'failed trial')}; the store contains the tracebacks.")
    if copies := copies_note((cell.name, cell.trials, cell.different) for cell in campaign.cells):
        notes.append(copies)
    if campaign.empty:
        notes.append(f"Omitted, because no mission has ended: {listed(list(campaign.empty))}.")
    if campaign.unreadable:
        notes.append(f"Without a map, because the scenario cannot be read again: {listed(list(campaign.unreadable))}.")
    if len(campaign.cells) > figures.MAX_PANELS:
        notes.append(
            f"Figures show the first {figures.MAX_PANELS} of {len(campaign.cells)} settings; tables contain all."
        )
    if missions and missions.note:
        notes.append(missions.note)
    return tuple(notes)


def campaign_pictures(campaign: Campaign, panels: Sequence[Panel], sheet: Sheet = SCREEN) -> Iterator[Picture]:
    """Yield the figures of a campaign. Args: panels: the missions to show."""
    samples = [each.missions for panel in panels for each in panel.series]
    num_victims = max(sample.num_victims for sample in samples)
    if num_victims > 0:
        yield _counts_picture(panels, "victims", "Victims saved", lambda one: one.victims_saved, num_victims, sheet)
    yield picture(
        "times",
        "Mission durations",
        "Every mission, the density, the quartiles, and the mean with its bootstrap interval. A mission that was cut "
        "short counts as the time limit.",
        figures.draw_times(panels, sheet=sheet),
        sheet,
    )
    yield picture(
        "survival",
        "Missions still running",
        "Share of missions still exploring at each time (Kaplan-Meier). Missions that were cut short are censored at "
        "the limit.",
        figures.draw_survival(panels, sheet=sheet),
        sheet,
    )
    if num_victims > 0 and any(sample.saved_s for sample in samples):
        yield picture(
            "saved",
            "Victims saved over time",
            "Mean number of victims saved, or safe, so far, with pointwise 95 % bootstrap intervals. The dotted line "
            f"is the number of victims.{_shown(panels, figures.MAX_COURSES)}",
            figures.draw_saved(panels, sheet=sheet),
            sheet,
        )
    num_areas = max(sample.num_areas for sample in samples)
    if num_areas > 0:
        yield _counts_picture(panels, "areas", "Areas explored", lambda one: one.areas_explored, num_areas, sheet)
    threshold = f"{campaign.scenario.network.endangered_below_dbm:g} dBm".replace("-", "\N{MINUS SIGN}")
    yield picture(
        "endangered",
        "Endangered links",
        f"Share of missions by how often a link fell below {threshold}.",
        figures.draw_counts(panels, lambda one: one.endangered, "times a link was endangered", None, sheet=sheet),
        sheet,
    )
    yield from _path_pictures(campaign.cells, sheet)


def _counts_picture(panels: Sequence[Panel], name: str, title: str, of: Counts, top: int, sheet: Sheet) -> Picture:
    what = title[0].lower() + title[1:]
    caption = f"Share of missions by number of {what}. Bars end in exact (Clopper-Pearson) intervals."
    return picture(name, title, caption, figures.draw_counts(panels, of, what, top, sheet=sheet), sheet)


def _path_pictures(cells: Sequence[Cell], sheet: Sheet) -> Iterator[Picture]:
    if heated := maps.drawable(cells):
        caption = (
            "Mean time that robots spent at each place in a mission. Red: the path of one robot in the mission of "
            "median duration. Circles are the areas in their order, crosses the victims; if they are at random places, "
            f"those of that mission.{_shown(heated, maps.MAX_MAPS)}"
        )
        yield picture("paths", "Paths of the robots", caption, maps.draw_heat(heated, sheet=sheet), sheet)


def _shown(settings: Sequence[object], most: int) -> str:
    return f" Shown are the first {most} of {len(settings)} settings." if len(settings) > most else ""


def campaign_page(
    campaign: Campaign,
    first: Sequence[str],
    pictures: Sequence[Picture],
    tables: Sequence[Table],
    missions: ShownMissions | None,
    template: str = "campaign.html",
    folders: Sequence[Path] = (),
    comparison: Sequence[Table] = (),
    reading: Sequence[tuple[str, str]] = READING,
    **more: object,
) -> str:
    """Return the page of a campaign.

    Args: first: paragraphs at the top. template, folders: of a page that extends campaign.html, with the values `more`.
          comparison: tables above the figures. reading: how to read it, as terms and explanations.
    """
    return render(
        template,
        (*folders, FOLDER),
        heading=f"{campaign.scenario.name}: {sum(cell.trials for cell in campaign.cells):,} missions",
        campaign=campaign,
        first=first,
        pictures=pictures,
        player=Markup(missions.frame) if missions else "",
        rule=missions.rule if missions else "",
        tables=tables,
        comparison=comparison,
        reading=reading,
        settings=json.dumps({key: campaign.settings[key] for key in ("keys", "cells", "paired", "trials")}),
        dates=listed(sorted(set(campaign.started))),
        versions=", ".join(f"{name} {version}" for name, version in campaign.versions.items()),
        **more,
    )


def render(template: str, folders: Sequence[Path], **values: object) -> str:
    """Return a page made from a template that extends base.html. Args: folders: of all templates."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    return environment.get_template(template).render(colours=palette.css(), **values)

"""The report of the study: the page of a campaign, with the dissertation's missions and a verdict on each claim."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

from robotteamsim.analysis.report import Report, ShownMissions
from robotteamsim.analysis.report.contrasts import contrasts, overall
from robotteamsim.analysis.report.page import (
    READING,
    campaign_notes,
    campaign_page,
    campaign_pictures,
)
from robotteamsim.analysis.report.pictures import Picture, picture
from robotteamsim.analysis.report.samples import Campaign, pooled, read_campaign
from robotteamsim.analysis.report.statistics import RESAMPLES
from robotteamsim.analysis.report.tables import campaign_tables
from robotteamsim.analysis.report.wording import listed
from robotteamsim.campaign import StoredCampaign
from robotteamsim.errors import CampaignError
from study.dissertation import figures
from study.dissertation.claims import MIN_TRIALS, Claim, judge
from study.dissertation.comparison import MARGIN, SD_FACTOR, VICTIMS_MARGIN, Comparison, compare
from study.dissertation.criteria import Verdict
from study.dissertation.maps import map_pictures
from study.dissertation.missions import compared, panels
from study.dissertation.wording import DISSERTATION, calibration, claims_table, tests_table

_NUMBERS = {
    "voice_lowest": 16,
    "voice_highest": 17,
    "network": 18,
    "victims": 19,
    "times": 20,
    "areas": 21,
    "endangered": 22,
}
"""The dissertation's figures by our names."""

_WITH_THEIRS = ("victims", "times", "survival", "areas", "endangered")

_READING = (
    (
        "fitted",
        "The places of areas and victims, and constants of the controller, were chosen by this value. Agreement is "
        "calibration.",
    ),
    (
        "reproduced",
        "All missions together show it by the criteria below, and so does each campaign alone, with at least "
        f"{MIN_TRIALS} missions per level.",
    ),
    ("depends on the seed", "Some campaigns show it and some do not."),
    ("not shown", "Our missions do not contradict it, but are not enough to show it."),
    ("not reproduced", "All missions together contradict it."),
    (
        "values",
        "Two one-sided tests for a ratio of means or medians of durations between 0.9 and 1.1, a ratio of standard "
        f"deviations within a factor of {SD_FACTOR:g}, and a difference of mean numbers of victims within "
        f"{VICTIMS_MARGIN:g}; {RESAMPLES:,} bootstrap samples of both, 90 % percentile intervals. The whole interval "
        "outside the limits contradicts the claim.",
    ),
    (
        "shares",
        "One-sided: a team that does better does not fail. Each bound of an interval is an exact (Clopper-Pearson) "
        "one-sided 95 % bound. To reproduce “at least”, our lower bound must reach the dissertation’s lower bound; “at "
        "most” is the reverse.",
    ),
    ("order", "One-sided Mann-Whitney tests of neighbouring levels, all of which must be significant."),
)


@dataclass(frozen=True, slots=True)
class StudyReport:
    """The report of the study, and the claims with their verdicts."""

    report: Report
    claims: tuple[Claim, ...]


def make_study(
    stored: Sequence[StoredCampaign], places: Sequence[str], missions: ShownMissions | None = None
) -> StudyReport:
    """Return the report of one or several campaigns of one design; the same stores give the same bytes.

    Args:   places: the stores' folders, for messages. missions: to play in the page; None: none.
    Raises: CampaignError: as `robotteamsim.analysis.report.make_report`; or no setting is one of the dissertation's.
    """
    campaign = pooled(stored, places)
    pairs = compared(campaign)
    if not pairs:
        raise CampaignError(
            f"{places[0]}: has no setting of the dissertation; expected garage_sar with 10, 20 or 30 dB of noise, in "
            "which only the noise varies"
        )
    comparisons = compare(pairs)
    claims = judge(campaign, [read_campaign(one, place) for one, place in zip(stored, places, strict=True)])
    shown = panels(campaign)
    pictures = tuple(_pictures(campaign, comparisons))
    tables = (*campaign_tables(shown, contrasts(campaign), overall(campaign)), tests_table(comparisons))
    notes = campaign_notes(campaign, missions)
    if missing := [panel.name for panel in shown if len(panel.series) == 1]:
        notes += (f"The dissertation has no missions with {listed(missing)}; these are not compared.",)
    opening = (calibration(claims),)
    not_fitted = [claim for claim in claims if not claim.fitted]
    page = campaign_page(
        campaign,
        [*opening, *notes],
        pictures,
        tables,
        missions,
        template="study.html",
        folders=(Path(__file__).parent,),
        reading=(*_READING, *READING),
        groups=(
            ("not-fitted", "Claims that were not fitted: the test", not_fitted),
            ("fitted", "Claims that were fitted: calibration", [claim for claim in claims if claim.fitted]),
        ),
        counts=Counter(claim.verdict for claim in not_fitted),
        verdicts=[name for name in get_args(Verdict) if any(claim.verdict == name for claim in claims)],
        verdict_colours={
            "reproduced": figures.REPRODUCED,
            "contradicted": figures.CONTRADICTED,
            "undecided": figures.UNDECIDED,
        },
        dissertation=DISSERTATION,
    )
    return StudyReport(Report(opening, notes, page, pictures, (*tables, claims_table(claims))), claims)


def _pictures(campaign: Campaign, comparisons: Sequence[Comparison]) -> Iterator[Picture]:
    """Yield the figures of the campaign with the numbers of the dissertation's, and the durations compared."""
    for drawn in (*map_pictures(campaign), *campaign_pictures(campaign, panels(campaign))):
        caption = drawn.caption
        if drawn.name in _WITH_THEIRS:
            caption += " Orange: the dissertation's 30 missions."
        if drawn.name.startswith("voice"):
            caption += " The dissertation prints this figure without numbers, on a floor plan that is lost."
        number = _NUMBERS.get(drawn.name)
        name, title = drawn.name, drawn.title
        if number is not None:
            name, title = f"fig{number}_{name}", f"{title} (Figure {number})"
        yield dataclasses.replace(drawn, name=name, title=title, caption=caption)
        if drawn.name == "times" and any(math.isfinite(each.mean.interval.high) for each in comparisons):
            yield picture(
                "equivalence",
                "Durations compared with the dissertation",
                "Mean duration, ours over the dissertation's, with its 90 % bootstrap interval. If the whole interval "
                f"is within the green band of {100.0 * MARGIN:g} %, the means are equivalent (two one-sided tests).",
                figures.draw_ratios(comparisons),
            )

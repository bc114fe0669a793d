"""The first paragraphs of a report."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from robotteamsim.analysis.report.claims import TRENDS, Claim
from robotteamsim.analysis.report.contrasts import Contrast
from robotteamsim.analysis.report.wording import interval_text, p_text

DISSERTATION = (
    "G. N. S. Augusto, RobotTeamSim \N{EN DASH} 3D Visualization of Cooperative Mobile Robot Missions in Gazebo "
    "Virtual Environment, University of Coimbra, 2013"
)

_MAX_COMPARED = 6
_MAX_SUMMARISED = 3


def calibration(claims: Sequence[Claim]) -> tuple[str, ...]:
    """Return what a reader of the verdicts must know first: which of them are calibration."""
    fitted, tested = ([claim for claim in claims if claim.fitted is kind] for kind in (True, False))
    reproduced = sum(claim.verdict == "reproduced" for claim in tested)
    denied = sum(claim.verdict == "not reproduced" for claim in tested)
    unsure = len(tested) - reproduced - denied
    trends = sum(claim.text in TRENDS for claim in tested)
    agree = sum(claim.verdict == "reproduced" for claim in fitted)
    return (
        "The floor plan is ours, because that of the dissertation is lost. Its areas and victims, and the constants of "
        "the controller that the dissertation does not print, were chosen so that mean durations and mean numbers of "
        "saved victims come near Table 8 of the dissertation. "
        f"Agreement of these means ({agree} of {len(fitted)} agree) is therefore calibration and confirms nothing. "
        "The test is what was not fitted: trend, spread, medians, the cost of a rescue, and the other claims below. "
        f"Of these {len(tested)} claims, {reproduced} are reproduced, {denied} are not, and {unsure} "
        "are undecided." + (f" The {trends} trends among them follow from the fitted means." if trends else ""),
    )


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
        shift = interval_text(c.difference, c.decimals).replace(" [-, -]", ", no interval")
        shift = shift.replace("-", "\N{MINUS SIGN}")
        parts.append(
            f"{c.quantity} {b} instead of {a} (difference {shift}, larger in {100.0 * c.superiority:.0f} % of "
            f"comparisons, {p_text(c.p)})"
        )
    where = f" at {one.where}" if one.where else ""
    how = "" if one.pairs is None else f", in {one.pairs} pairs of missions with the same seed"
    return f"{one.second} compared with {one.first}{where}{how}: {'; '.join(parts)}."

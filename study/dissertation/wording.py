"""The first paragraph of the study's report, and its tables of claims and tests."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.analysis.report.tables import UNKNOWN, Entry, Table, interval_entry, p_entry, share_entry
from study.dissertation.claims import FOLLOWING, Claim
from study.dissertation.comparison import Comparison

DISSERTATION = (
    "G. N. S. Augusto, RobotTeamSim \N{EN DASH} 3D Visualization of Cooperative Mobile Robot Missions in Gazebo "
    "Virtual Environment, University of Coimbra, 2013"
)


def calibration(claims: Sequence[Claim]) -> str:
    """Return what a reader of the verdicts must know first: which of them are calibration."""
    fitted, tested = ([claim for claim in claims if claim.fitted is kind] for kind in (True, False))
    reproduced = sum(claim.verdict == "reproduced" for claim in tested)
    denied = sum(claim.verdict == "not reproduced" for claim in tested)
    unsure = len(tested) - reproduced - denied
    following = sum(claim.text in FOLLOWING for claim in tested)
    agree = sum(claim.verdict == "reproduced" for claim in fitted)
    return (
        "The floor plan is ours, because that of the dissertation is lost. Its areas and victims, and the constants of "
        "the controller that the dissertation does not print, were chosen so that mean durations and mean numbers of "
        "saved victims come near Table 8 of the dissertation. "
        f"Agreement of these means ({agree} of {len(fitted)} agree) is therefore calibration and confirms nothing. "
        "The test is what was not fitted: trend, spread, medians, the cost of a rescue, and the other claims below. "
        f"Of these {len(tested)} claims, {reproduced} are reproduced, {denied} are not, and {unsure} "
        "are undecided."
        + (
            f" But {following} of them, trends and the median at 30 dB, follow from the fitted means."
            if following
            else ""
        )
        + " Campaigns differ in our seeds only; the published missions are the same, so they are not replications."
    )


def tests_table(comparisons: Sequence[Comparison]) -> Table:
    """Tests against the dissertation's missions."""
    rows: list[tuple[str | Entry, ...]] = []
    for comparison in comparisons:
        for what, found in (
            ("mean time, ours over theirs [90 %]", comparison.mean),
            ("median time, ours over theirs [90 %]", comparison.median),
            ("SD of times, ours over theirs [90 %]", comparison.sd),
            ("mean number of victims saved, ours minus theirs [90 %]", comparison.victims),
        ):
            low, high = (f"{limit:.2f}".rstrip("0").rstrip(".") for limit in found.limits)
            rows.append(
                (comparison.name, what, interval_entry(found.interval, 3), f"{low} to {high}", p_entry(found.p))
            )
        what = "numbers of victims saved, Fisher-Freeman-Halton"
        rows.append((comparison.name, what, UNKNOWN, UNKNOWN, p_entry(comparison.victims_p)))
        for saved, shares in comparison.rates.items():
            what = f"missions with at least {saved} victims saved [90 %]"
            rows.append((comparison.name, what, share_entry(shares.ours), share_entry(shares.theirs), UNKNOWN))
    head = ("", "what", "ours", "limits, or theirs", "p after Holm")
    return Table("tests", "Tests against the dissertation", head, tuple(rows), 2)


def claims_table(claims: Sequence[Claim]) -> Table:
    """Each claim with its verdict and the reason."""
    rows = tuple(
        (
            claim.text,
            claim.source,
            "fitted" if claim.fitted else "not fitted",
            claim.verdict,
            claim.passed_text,
            claim.why,
        )
        for claim in claims
    )
    head = ("claim", "source", "basis", "verdict", "campaigns that reproduce it", "reason")
    return Table("claims", "The dissertation's claims", head, rows, 6)

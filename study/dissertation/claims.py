"""The dissertation's claims about its missions, and a verdict on each from our missions."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from robotteamsim.analysis.report.rank_tests import mann_whitney
from robotteamsim.analysis.report.samples import Campaign, Cell, Sample
from robotteamsim.analysis.report.statistics import generator
from robotteamsim.analysis.report.wording import p_text
from robotteamsim.scenario import Scenario
from study.dissertation.comparison import MARGIN, Comparison, compare, shares
from study.dissertation.criteria import (
    LEVEL,
    Finding,
    Verdict,
    at_least,
    at_most,
    equivalent,
    falls,
    over_campaigns,
    together,
)
from study.dissertation.equivalence import equivalence, mean_difference, mean_ratio
from study.dissertation.maps import nearest_other_m
from study.dissertation.missions import Pair, compared

MIN_TRIALS = 100
"""Missions needed at each noise level before a claim counts as reproduced."""

TRENDS = ("The more noise, the shorter the mission.", "The more noise, the fewer victims are saved.")
"""Claims whose values were not fitted, but whose order follows from fitted means."""

MEDIAN_AT_30_DB = "With 30 dB the median mission takes 339.5 s."
"""A claim that follows from a fitted mean, because durations at 30 dB hardly spread: median and mean are the same."""

FOLLOWING = (*TRENDS, MEDIAN_AT_30_DB)
"""Claims that were not fitted, but follow from fitted means."""

_MINUS = "\N{MINUS SIGN}"
_RANGES_M = {-60.0: 4.5, -70.0: 10.0, -80.0: 25.0}
"""Radio range that Section 5.3 reads from Figure 18, by connection threshold [dBm]."""

_MEDIAN = "Ratio of medians"
_TIMES = "Tables 6, 8; Fig. 20"
_VICTIMS = "Tables 6, 8; Fig. 19"
_MEANS_S = {10.0: 459.6, 20.0: 382.0, 30.0: 343.5}
_MEDIANS_S = {10.0: 445.5, 20.0: 374.5, 30.0: 339.5}
_SDS_S = {10.0: 55.4, 20.0: 41.5, 30.0: 22.8}
_COST_S = (418.2, 351.0)
"""Mean durations of the missions at 20 dB that save four and three victims."""


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim of the dissertation.

    source:    where it is made.    why: the reason for the verdict, from all missions together.
    fitted:    the floor plan was fitted to this value, so agreement is calibration.
    campaigns: verdict of each campaign alone; () if the claim needs no mission.
    """

    text: str
    source: str
    fitted: bool
    verdict: Verdict
    why: str
    campaigns: tuple[Verdict, ...] = ()

    @property
    def passed(self) -> int:
        """Number of campaigns that reproduce the claim."""
        return sum(verdict == "reproduced" for verdict in self.campaigns)

    @property
    def passed_text(self) -> str:
        """In how many campaigns the claim is reproduced, or that it needs none."""
        return f"{self.passed} of {len(self.campaigns)}" if self.campaigns else "needs none"


def judge(campaign: Campaign, parts: Sequence[Campaign]) -> tuple[Claim, ...]:
    """Return the claims that these missions can test; none if the dissertation has no missions of these settings.

    Args: campaign: all missions.    parts: the campaigns that it consists of, each of which is judged alone, too.
    """
    claims = _judge(campaign)
    alone = [claims] if len(parts) < 2 else [_judge(part) for part in parts]
    verdicts = [{claim.text: claim.verdict for claim in of_part} for of_part in alone]
    judged = []
    for claim in claims:
        each = tuple(of_part[claim.text] for of_part in verdicts if claim.text in of_part)
        if claim.text == _RANGES:
            judged.append(claim)
        else:
            verdict = over_campaigns(claim.verdict, each)
            judged.append(dataclasses.replace(claim, verdict=verdict, campaigns=each))
    return tuple(judged)


def _judge(campaign: Campaign) -> tuple[Claim, ...]:
    pairs = compared(campaign)
    if not pairs:
        return ()
    comparisons = compare(pairs)
    trials = min(comparison.trials for comparison in comparisons)
    not_fitted = [
        *_trends(pairs),
        *_rescues(pairs),
        *_medians(comparisons),
        *_spreads(comparisons),
        *_rare_rescues(comparisons),
        *_areas(comparisons),
        *_cut_short(pairs),
        *_endangered(campaign, comparisons),
    ]
    fitted = [*_victims(comparisons), *_mean_times(comparisons)]
    claims = [_claim(*parts, fitted=False, trials=trials) for parts in not_fitted]
    claims.append(_claim(*_ranges(campaign.scenario), fitted=False, trials=MIN_TRIALS))
    return (*claims, *(_claim(*parts, fitted=True, trials=trials) for parts in fitted))


Value = TypeVar("Value")
_Judged = tuple[str, str, Finding]
"""The text of a claim, its source, and what our missions say about it."""


def _claim(text: str, source: str, finding: Finding, *, fitted: bool, trials: int) -> Claim:
    """Return a claim; a few missions cannot reproduce it."""
    if finding.verdict == "reproduced" and trials < MIN_TRIALS:
        few = f" Our missions agree so far, but {trials} per level are too few; {MIN_TRIALS} are needed."
        finding = Finding("not shown", finding.why + few)
    return Claim(text, source, fitted, finding.verdict, finding.why)


def _trends(pairs: Sequence[Pair]) -> list[_Judged]:
    cells = sorted((cell for cell, _ in pairs), key=_noise_db)
    if len(cells) < 2:
        return []
    names = [cell.name for cell in cells]
    times = falls([cell.missions.restricted_s for cell in cells], names, 0, " s")
    fitted = " The means of the levels were fitted, so their order is not independent evidence."
    return [
        (TRENDS[0], "Sec. 5.4.2; Fig. 20", Finding(times.verdict, times.why + fitted)),
        (
            TRENDS[1],
            "Sec. 5.4.1; Fig. 19",
            _with(falls([cell.missions.victims_saved for cell in cells], names, 2), fitted),
        ),
    ]


def _rescues(pairs: Sequence[Pair]) -> list[_Judged]:
    """Claims about the cost of rescues and about noise, which need the levels 10 and 20 dB."""
    by_noise: dict[float, tuple[Sample, Sample]] = {_noise_db(cell): (cell.missions, theirs) for cell, theirs in pairs}
    judged = []
    if 20.0 in by_noise:
        ours, theirs = by_noise[20.0]
        source = "Sec. 5.4.2"
        more = falls([ours.time_given_s(4), ours.time_given_s(3)], ["four saved", "three saved"], 1, " s")
        judged.append(
            ("At 20 dB, missions that save four victims take longer than those that save three.", source, more)
        )
        judged.append(_cost(ours, theirs))
    if 10.0 in by_noise and 20.0 in by_noise:
        judged.append(_direct_influence(by_noise[10.0], by_noise[20.0]))
    return judged


def _cost(ours: Sample, theirs: Sample) -> _Judged:
    """The difference in duration between saving four and three victims, ours minus theirs."""
    four, three = _COST_S
    text = f"At 20 dB, the fourth victim costs {four - three:.0f} s: three saved take {three:.0f} s, four {four:.0f} s."
    samples = [sample.time_given_s(saved) for sample in (ours, theirs) for saved in (4, 3)]
    if not all(map(len, samples)):
        return text, "Table 6", Finding("not shown", "We have no missions of one of the two kinds.")

    def difference(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, axis: int) -> np.ndarray:
        return np.asarray(mean_difference(a, b, axis) - mean_difference(c, d, axis))

    margin_s = MARGIN * _MEANS_S[20.0]
    found = equivalence(samples, difference, (-margin_s, margin_s), generator("cost"))
    own = float(np.mean(samples[0]) - np.mean(samples[1]))
    why = f"In ours it costs {own:.0f} s".replace("-", _MINUS)
    return text, "Table 6", equivalent(found, f"{why}. Difference", 1, " s")


def _direct_influence(at_10: tuple[Sample, Sample], at_20: tuple[Sample, Sample]) -> _Judged:
    """Compare the times of missions that saved all victims, at the two lowest noise levels."""
    ours, theirs = (
        [sample.time_given_s(sample.num_victims) for sample in pair] for pair in zip(at_10, at_20, strict=True)
    )
    text = "Noise does not itself influence the duration, only by the number of victims saved."
    why = (
        f"The dissertation's own data contradict this: with all four saved, 10 dB takes {np.mean(theirs[0]):.1f} s and "
        f"20 dB {np.mean(theirs[1]):.1f} s on average (Mann-Whitney, {p_text(mann_whitney(theirs[0], theirs[1]))})."
    )
    p = mann_whitney(ours[0], ours[1])
    if p is None:
        return text, "Sec. 5.4.2; Fig. 20", Finding("not shown", f"{why} We have too few such missions to decide.")
    found = equivalence(ours, mean_ratio, (1.0 - MARGIN, 1.0 + MARGIN), generator("direct influence"))
    finding = equivalent(found, "Ratio of mean times in our missions that save all")
    if finding.verdict != "reproduced" and p < LEVEL:
        differ = f"Ours differ, too: {np.mean(ours[0]):.1f} s and {np.mean(ours[1]):.1f} s ({p_text(p)})."
        finding = Finding("not reproduced", differ)
    return text, "Sec. 5.4.2; Fig. 20", Finding(finding.verdict, f"{why} {finding.why}")


def _medians(comparisons: Sequence[Comparison]) -> list[_Judged]:
    judged = []
    for c, median_s in _with_values(comparisons, _MEDIANS_S):
        text, found = f"With {c.noise_db:g} dB the median mission takes {median_s:g} s.", equivalent(c.median, _MEDIAN)
        why = " Durations hardly spread, so it follows from the fitted mean."
        judged.append((text, "Table 8", _with(found, why) if text == MEDIAN_AT_30_DB else found))
    return judged


def _spreads(comparisons: Sequence[Comparison]) -> list[_Judged]:
    what = "Ratio of standard deviations"
    return [
        (
            f"With {c.noise_db:g} dB durations have a standard deviation of {sd_s:g} s.",
            "from Table 6",
            equivalent(c.sd, what),
        )
        for c, sd_s in _with_values(comparisons, _SDS_S)
    ]


def _rare_rescues(comparisons: Sequence[Comparison]) -> list[_Judged]:
    text = "With 30 dB, 2 of 30 missions save more than two victims."
    return [
        (text, "Table 6", at_least(c.rates[3], "Missions that save more than two"))
        for c in comparisons
        if 3 in c.rates and c.noise_db == 30.0
    ]


def _areas(comparisons: Sequence[Comparison]) -> list[_Judged]:
    parts = [(c.name, at_least(c.areas, "missions with all areas explored")) for c in comparisons]
    return [("All areas are explored unless the time runs out.", "Tables 7, 9; Fig. 21", together(parts))]


def _cut_short(pairs: Sequence[Pair]) -> list[_Judged]:
    if len(pairs) < 3:
        return []
    cells = [cell.missions for cell, _ in pairs]
    ours, theirs = (
        np.concatenate([~sample.finished for sample in samples]) for samples in (cells, [theirs for _, theirs in pairs])
    )
    saved = np.concatenate([sample.victims_saved == sample.num_victims for sample in cells])[ours]
    at_limit = sum(int(np.count_nonzero(~sample.finished & (sample.time_s >= sample.limit_s))) for sample in cells)
    finding = at_most(
        shares(ours, theirs), "Missions that are cut short, by the limit or because all robots are excluded"
    )
    why = f"{finding.why} {at_limit} of our {len(ours):,} missions reach the limit."
    if len(saved):
        why += f" All victims are saved in {int(saved.sum())} of the {len(saved)} that are cut short."
    verdict: Verdict = finding.verdict if saved.all() else "not reproduced"
    text = "The limit of 600 s is reached in only 2 of 90 missions, in which all victims are saved."
    return [(text, "Sec. 5.4.1; Table 6", Finding(verdict, why))]


def _endangered(campaign: Campaign, comparisons: Sequence[Comparison]) -> list[_Judged]:
    finding = together([(c.name, at_most(c.endangered, "missions with an endangered link")) for c in comparisons])
    apart = _distances_apart_m(campaign)
    if len(apart):
        finding = _with(
            finding,
            f" This is a weak test: the median distance to the nearest robot is {np.median(apart):.1f} m, "
            f"the maximum {np.max(apart):.1f} m.",
        )
    return [
        (f"With a threshold of {_MINUS}80 dBm the connection is never endangered.", "Tables 7, 9; Fig. 22", finding)
    ]


_RANGES = "A robot reaches about 4.5 m, 10 m and 25 m for thresholds of -60, -70 and -80 dBm.".replace("-", _MINUS)


def _ranges(scenario: Scenario) -> _Judged:
    radio = scenario.radio
    parts, agrees = [], True
    for threshold_dbm, claimed_m in _RANGES_M.items():
        range_m = 10.0 ** ((radio.tx_power_dbm - radio.constant_loss_db - threshold_dbm) / radio.slope_db)
        near = abs(range_m / claimed_m - 1.0) <= MARGIN
        agrees &= near
        parts.append(f"{range_m:.1f} m at {threshold_dbm:g} dBm{'' if near else f', not {claimed_m:g} m'}")
    why = f"From its equations 2 and 3 and Table 3, without walls: {'; '.join(parts)}. This needs no mission."
    finding = Finding("reproduced" if agrees else "not reproduced", why.replace("-", _MINUS))
    return _RANGES, "Sec. 5.3; Fig. 18", finding


def _victims(comparisons: Sequence[Comparison]) -> list[_Judged]:
    what = "Difference of mean numbers saved"
    judge_by: Mapping[float, tuple[str, Callable[[Comparison], Finding]]] = {
        10.0: (
            "With 10 dB of noise all four victims are saved in each mission.",
            lambda c: at_least(c.rates[4], "Missions that save all four"),
        ),
        20.0: (
            "With 20 dB the number of victims saved is a little lower: 3.3 on average.",
            lambda c: equivalent(c.victims, what),
        ),
        30.0: (
            "With 30 dB only half of the victims are saved: 2.1 on average.",
            lambda c: equivalent(c.victims, what),
        ),
    }
    return [(text, _VICTIMS, judged_by(c)) for c, (text, judged_by) in _with_values(comparisons, judge_by)]


def _mean_times(comparisons: Sequence[Comparison]) -> list[_Judged]:
    return [
        (
            f"With {c.noise_db:g} dB a mission takes {mean_s:g} s on average.",
            _TIMES,
            equivalent(c.mean, "Ratio of mean times"),
        )
        for c, mean_s in _with_values(comparisons, _MEANS_S)
    ]


def _with_values(comparisons: Sequence[Comparison], values: Mapping[float, Value]) -> list[tuple[Comparison, Value]]:
    return [(comparison, values[comparison.noise_db]) for comparison in comparisons]


def _with(finding: Finding, more: str) -> Finding:
    return Finding(finding.verdict, finding.why + more)


def _distances_apart_m(campaign: Campaign) -> np.ndarray:
    """Return the distance of each robot to the nearest other one, at all stored times of all missions [m]."""
    found = [
        nearest_other_m(paths_m).ravel() for cell in campaign.cells for paths_m in cell.paths_m if paths_m.shape[1] > 1
    ]
    return np.concatenate(found) if found else np.empty(0)


def _noise_db(cell: Cell) -> float:
    assert cell.scenario is not None
    return cell.scenario.voice.noise_db

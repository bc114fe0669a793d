"""The dissertation's claims about its missions, and a verdict on each from our missions."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robotteamsim.analysis.report.comparison import MARGIN, Comparison
from robotteamsim.analysis.report.maps import nearest_other_m
from robotteamsim.analysis.report.samples import Campaign, Cell, Sample
from robotteamsim.analysis.report.statistics import clopper_pearson, holm, kruskal_wallis, mann_whitney
from robotteamsim.analysis.report.wording import interval_text, listed, p_text, percents, share_text
from robotteamsim.scenario import Scenario

Verdict = Literal["reproduced", "not reproduced", "not shown"]

MIN_TRIALS = 100
"""Missions needed at each noise level before a claim counts as reproduced."""

_LEVEL = 0.05
_MINUS = "\N{MINUS SIGN}"
_RANGES_M = {-60.0: 4.5, -70.0: 10.0, -80.0: 25.0}
"""Radio range that Section 5.3 reads from Figure 18, by connection threshold [dBm]."""


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim of the dissertation. source: where it is made. why: the reason for the verdict."""

    text: str
    source: str
    verdict: Verdict
    why: str


def judge(campaign: Campaign, comparisons: Sequence[Comparison]) -> tuple[Claim, ...]:
    """Return the claims that these missions can test; none if the dissertation has no missions of these settings."""
    if not comparisons:
        return ()
    claims = [_victims(comparison) for comparison in comparisons]
    claims += [_time(comparison) for comparison in comparisons]
    if len(comparisons) > 1:
        claims.append(_trend(campaign))
    claims += _direct_influence(campaign)
    claims.append(_areas(comparisons))
    claims += _time_limit(campaign)
    claims += [_endangered(campaign, comparisons), _ranges(campaign.scenario)]
    return tuple(claims)


def _verdict(agrees: bool, trials: int) -> tuple[Verdict, str]:
    """Return the verdict and an addition to its reason: a few missions cannot reproduce a claim."""
    if not agrees:
        return "not reproduced", ""
    if trials < MIN_TRIALS:
        return (
            "not shown",
            f" Our missions agree so far, but {trials} per level are too few; {MIN_TRIALS} are needed.",
        )
    return "reproduced", ""


def _victims(comparison: Comparison) -> Claim:
    texts = {
        10.0: "With 10 dB of noise all four victims are saved in each mission.",
        20.0: "With 20 dB the number of victims saved is a little lower: 3.3 on average.",
        30.0: "With 30 dB only half of the victims are saved: 2.1 on average.",
    }
    agrees, reasons = True, []
    for rate in comparison.rates:
        inside = rate.ours.value in rate.theirs
        low, high = percents(rate.theirs.low, rate.theirs.high)
        agrees &= inside
        reasons.append(
            f"At least {rate.saved} were saved in {share_text(rate.ours)} of our missions, "
            f"{'inside' if inside else 'outside'} the dissertation's {low} to {high}."
        )
    if comparison.victims_p is not None:
        same = comparison.victims_p >= _LEVEL
        agrees &= same
        found = "no difference found" if same else "the distributions differ"
        reasons.append(
            f"Counts of victims: {found} (Fisher-Freeman-Halton, {p_text(comparison.victims_p)} after Holm)."
        )
    else:
        reasons.append("All missions of both saved the same number of victims.")
    verdict, more = _verdict(agrees, comparison.trials)
    return Claim(texts[comparison.noise_db], "Tables 6, 8; Fig. 19", verdict, " ".join(reasons) + more)


def _time(comparison: Comparison) -> Claim:
    means = {10.0: 459.6, 20.0: 382.0, 30.0: 343.5}
    text = f"With {comparison.noise_db:g} dB a mission takes {means[comparison.noise_db]:g} s on average."
    interval, low, high = comparison.time.interval, 1.0 - MARGIN, 1.0 + MARGIN
    ratio = interval_text(interval, 3)
    why = f"Our missions take {ratio} times as long (90 % interval); the margin is {low:g} to {high:g}"
    if comparison.time_p < _LEVEL:
        verdict, more = _verdict(True, comparison.trials)
        return Claim(
            text,
            "Tables 6, 8; Fig. 20",
            verdict,
            f"{why}. They are equivalent ({p_text(comparison.time_p)} after Holm).{more}",
        )
    if interval.high < low or interval.low > high:
        return Claim(text, "Tables 6, 8; Fig. 20", "not reproduced", f"{why}. The whole interval is outside.")
    why += f". The interval is too wide or too near a limit to decide ({p_text(comparison.time_p)} after Holm)."
    return Claim(text, "Tables 6, 8; Fig. 20", "not shown", why)


def _trend(campaign: Campaign) -> Claim:
    cells = _by_noise([cell for cell, _ in campaign.compared])
    times = [cell.ours.restricted_s for cell in cells]
    p_all = kruskal_wallis(times)
    steps = holm([mann_whitney(a, b, "greater") for a, b in itertools.pairwise(times)])
    falls = all(np.mean(a) > np.mean(b) for a, b in itertools.pairwise(times))
    agrees = falls and p_all is not None and p_all < _LEVEL and all(p is not None and p < _LEVEL for p in steps)
    order = " > ".join(f"{np.mean(time):.0f} s" for time in times)
    if not falls:
        order = listed([f"{np.mean(time):.0f} s" for time in times])
    each = listed(
        [f"{a.name} > {b.name}: {p_text(p)}" for (a, b), p in zip(itertools.pairwise(cells), steps, strict=True)]
    )
    why = f"Mean times {order}. Kruskal-Wallis {p_text(p_all)}; {each} (Mann-Whitney, one-sided, after Holm)."
    verdict, more = _verdict(agrees, min(len(cell.ours) for cell in cells))
    return Claim("The more noise, the shorter the mission.", "Sec. 5.4.2; Fig. 20", verdict, why + more)


def _direct_influence(campaign: Campaign) -> list[Claim]:
    """Compare the times of missions that saved all victims, at the two lowest noise levels."""
    pairs = sorted(campaign.compared, key=lambda pair: _noise_db(pair[0]))[:2]
    if [_noise_db(cell) for cell, _ in pairs] != [10.0, 20.0]:
        return []
    theirs, ours = [_times_of_all_saved(sample) for _, sample in pairs], [_times_of_all_saved(c.ours) for c, _ in pairs]
    p_theirs, p_ours = mann_whitney(theirs[0], theirs[1]), mann_whitney(ours[0], ours[1])
    why = (
        f"The dissertation's own data contradict this: with all four saved, 10 dB takes {np.mean(theirs[0]):.1f} s and "
        f"20 dB {np.mean(theirs[1]):.1f} s on average (Mann-Whitney, {p_text(p_theirs)})."
    )
    if p_ours is None:
        why += " We have too few such missions to decide."
    else:
        verb = "also contradict it" if p_ours < _LEVEL else "show no such difference"
        why += f" Our missions {verb}: {np.mean(ours[0]):.1f} s and {np.mean(ours[1]):.1f} s ({p_text(p_ours)})."
    agrees = p_ours is not None and p_ours >= _LEVEL
    verdict: Verdict = "not shown" if agrees or p_ours is None else "not reproduced"
    text = "Noise does not itself influence the duration, only by the number of victims saved."
    return [Claim(text, "Sec. 5.4.2; Fig. 20", verdict, why)]


def _areas(comparisons: Sequence[Comparison]) -> Claim:
    outside = [c.name for c in comparisons if c.areas[0].value not in c.areas[1]]
    parts = [f"{share_text(c.areas[0])} at {c.name}, dissertation {share_text(c.areas[1])}" for c in comparisons]
    why = f"Missions with all areas explored: {'; '.join(parts)}."
    if outside:
        why += f" Ours are outside its interval at {listed(outside)}."
    verdict, more = _verdict(not outside, min(c.trials for c in comparisons))
    return Claim("All areas are explored unless the time runs out.", "Tables 7, 9; Fig. 21", verdict, why + more)


def _time_limit(campaign: Campaign) -> list[Claim]:
    if len(campaign.compared) < 3:
        return []
    ours = np.concatenate([_at_limit(cell.ours) for cell, _ in campaign.compared])
    theirs = np.concatenate([_at_limit(sample) for _, sample in campaign.compared])
    saved = np.concatenate(
        [c.ours.victims_saved[_at_limit(c.ours)] == c.ours.num_victims for c, _ in campaign.compared]
    )
    excluded = sum(int((~cell.ours.finished).sum()) for cell, _ in campaign.compared) - int(ours.sum())
    here, there = (clopper_pearson(int(reached.sum()), len(reached)) for reached in (ours, theirs))
    why = (
        f"{int(ours.sum())} of our {len(ours)} missions reach it: {share_text(here)}, dissertation {share_text(there)}."
    )
    if len(saved):
        why += f" All victims were saved in {int(saved.sum())} of them."
    if excluded:
        why += f" {excluded} of ours ended earlier because all robots were excluded."
    agrees = here.value in there and bool(saved.all())
    verdict, more = _verdict(agrees, min(len(cell.ours) for cell, _ in campaign.compared))
    text = "The limit of 600 s is reached in 2 of 90 missions, in which all victims are saved."
    return [Claim(text, "Sec. 5.4.1; Table 6", verdict, why + more)]


def _endangered(campaign: Campaign, comparisons: Sequence[Comparison]) -> Claim:
    outside = [c.name for c in comparisons if c.endangered[0].value not in c.endangered[1]]
    parts = [f"{share_text(c.endangered[0])} at {c.name}" for c in comparisons]
    (bound,) = percents(max(c.endangered[1].high for c in comparisons))
    why = (
        f"Missions with an endangered link: {'; '.join(parts)}; none of the dissertation's 30, which is compatible "
        f"with up to {bound}."
    )
    apart = _distances_apart_m(campaign)
    if len(apart):
        why += (
            f" This is a weak test: the median distance to the nearest robot is {np.median(apart):.1f} m, "
            f"the maximum {np.max(apart):.1f} m."
        )
    verdict, more = _verdict(not outside, min(c.trials for c in comparisons))
    text = f"With a threshold of {_MINUS}80 dBm the connection is never endangered."
    return Claim(text, "Tables 7, 9; Fig. 22", verdict, why + more)


def _ranges(scenario: Scenario) -> Claim:
    radio = scenario.radio
    parts, agrees = [], True
    for threshold_dbm, claimed_m in _RANGES_M.items():
        range_m = 10.0 ** ((radio.tx_power_dbm - radio.constant_loss_db - threshold_dbm) / radio.slope_db)
        near = abs(range_m / claimed_m - 1.0) <= MARGIN
        agrees &= near
        parts.append(f"{range_m:.1f} m at {threshold_dbm:g} dBm{'' if near else f', not {claimed_m:g} m'}")
    why = f"From its equations 2 and 3 and Table 3, without walls: {'; '.join(parts)}. This needs no mission."
    text = "A robot reaches about 4.5 m, 10 m and 25 m for thresholds of -60, -70 and -80 dBm.".replace("-", _MINUS)
    return Claim(text, "Sec. 5.3; Fig. 18", "reproduced" if agrees else "not reproduced", why.replace("-", _MINUS))


def _distances_apart_m(campaign: Campaign) -> np.ndarray:
    """Return the distance of each robot to the nearest other one, at all stored times of all missions [m]."""
    found = [
        nearest_other_m(paths_m).ravel() for cell in campaign.cells for paths_m in cell.paths_m if paths_m.shape[1] > 1
    ]
    return np.concatenate(found) if found else np.empty(0)


def _noise_db(cell: Cell) -> float:
    assert cell.scenario is not None
    return cell.scenario.voice.noise_db


def _by_noise(cells: Sequence[Cell]) -> list[Cell]:
    return sorted(cells, key=_noise_db)


def _times_of_all_saved(sample: Sample) -> np.ndarray:
    times_s: np.ndarray = sample.restricted_s[sample.victims_saved == sample.num_victims]
    return times_s


def _at_limit(sample: Sample) -> np.ndarray:
    return ~sample.finished & (sample.time_s >= sample.limit_s)

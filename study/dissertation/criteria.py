"""The criteria by which missions decide on a claim, each with its reason in words."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robotteamsim.analysis.report.rank_tests import mann_whitney, mean_shift
from robotteamsim.analysis.report.wording import interval_text, p_text, percents, share_text
from study.dissertation.comparison import Shares
from study.dissertation.equivalence import Equivalence

Verdict = Literal["reproduced", "depends on the seed", "not shown", "not reproduced"]

LEVEL = 0.05


@dataclass(frozen=True, slots=True)
class Finding:
    """What missions say about a claim, and the reason."""

    verdict: Verdict
    why: str


def equivalent(found: Equivalence, what: str, digits: int = 2, unit: str = "") -> Finding:
    """Judge a claim of a value: reproduced if ours is shown to be within the limits of theirs."""
    low, high = (f"{limit:.{digits}f}".rstrip("0").rstrip(".") for limit in found.limits)
    why = f"{what}: {interval_text(found.interval, digits)}{unit}; the limits are {low} and {high}{unit}"
    why = why.replace("-", "\N{MINUS SIGN}")
    if found.p < LEVEL:
        return Finding("reproduced", f"{why}. Ours is within them ({p_text(found.p)}).")
    if found.outside:
        return Finding("not reproduced", f"{why}. The whole interval is outside.")
    return Finding("not shown", f"{why}. The interval is too wide or too near a limit to decide ({p_text(found.p)}).")


def at_least(shares: Shares, what: str) -> Finding:
    """Judge a claim of a share where more is not a failure: reproduced if ours is shown to reach their lower bound."""
    ours, bound = shares.ours, shares.theirs.low
    return _bounded(shares, what, bound, ours.low >= bound, ours.high < bound, ("at least", "below"))


def at_most(shares: Shares, what: str) -> Finding:
    """Judge a claim of a share where less is not a failure: reproduced if ours is shown to keep their upper bound."""
    ours, bound = shares.ours, shares.theirs.high
    return _bounded(shares, what, bound, ours.high <= bound, ours.low > bound, ("at most", "above"))


def _bounded(shares: Shares, what: str, bound: float, shown: bool, denied: bool, words: tuple[str, str]) -> Finding:
    (limit,) = percents(bound)
    why = f"{what}: {share_text(shares.ours)}, dissertation {share_text(shares.theirs)}."
    if shown:
        return Finding("reproduced", f"{why} Ours is {words[0]} {limit}.")
    if denied:
        return Finding("not reproduced", f"{why} Ours is {words[1]} {limit}.")
    return Finding("not shown", f"{why} Ours may be above or below {limit}.")


def falls(samples: Sequence[np.ndarray], names: Sequence[str], digits: int, unit: str = "") -> Finding:
    """Judge a claim that each sample is larger than the next: one-sided Mann-Whitney tests, all of which must agree."""
    verdicts: list[Verdict] = []
    parts = []
    for (a, b), (first, second) in zip(itertools.pairwise(samples), itertools.pairwise(names), strict=True):
        p = mann_whitney(a, b, "greater")
        if p is not None and p < LEVEL:
            verdicts.append("reproduced")
        else:
            verdicts.append("not shown" if p is None or not _is_no_larger(a, b) else "not reproduced")
        means = " and ".join(f"{np.mean(values):.{digits}f}{unit}" if len(values) else "none" for values in (a, b))
        parts.append(f"{first} against {second}: {means} on average ({p_text(p)})")
    return Finding(worst(verdicts), f"{'; '.join(parts)}; Mann-Whitney, one-sided.")


def _is_no_larger(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether the 95 % interval of the difference of means excludes that a is larger."""
    difference = mean_shift(b, a, paired=False)
    return difference.value <= 0.0 if math.isnan(difference.high) else difference.high <= 0.0


def together(findings: Sequence[tuple[str, Finding]]) -> Finding:
    """Return the finding on a claim of several parts, each with a name: all must agree."""
    why = " ".join(f"{name}: {finding.why}" if name else finding.why for name, finding in findings)
    return Finding(worst([finding.verdict for _, finding in findings]), why)


def worst(verdicts: Sequence[Verdict]) -> Verdict:
    """Return the least favourable of several verdicts."""
    order: tuple[Verdict, ...] = ("not reproduced", "not shown", "depends on the seed")
    return next((verdict for verdict in order if verdict in verdicts), "reproduced")


def over_campaigns(together_: Verdict, each: Sequence[Verdict]) -> Verdict:
    """Return the verdict on a claim from all missions together and from each campaign alone."""
    if together_ == "not reproduced" or not each:
        return together_
    passed = sum(verdict == "reproduced" for verdict in each)
    if 0 < passed < len(each):
        return "depends on the seed"
    return together_ if passed else "not shown"

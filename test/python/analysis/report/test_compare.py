"""Comparisons with the reference: pairs of equal number, Wilcoxon's test, Holm's correction by hand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy import stats

from robotteamsim import rng
from robotteamsim.analysis.report.contrasts import Pair, compare


@dataclass(frozen=True, eq=False)
class Values:
    """Values of trials with these numbers."""

    values: np.ndarray
    numbers: np.ndarray


def pair(where: str, first: np.ndarray, second: np.ndarray, numbers: np.ndarray | None = None) -> Pair[Values]:
    all_numbers = np.arange(1, len(first) + 1)
    a, b = Values(first, all_numbers), Values(second, all_numbers if numbers is None else numbers)
    return Pair(where, ("reference", "other"), a, b)


def test_p_values_are_those_of_wilcoxon_with_holms_correction():
    generator = rng.stream(1, "comparisons")
    base = generator.normal(0.0, 1.0, 20)
    shifts = (0.0, 0.4, 1.5)
    pairs = [pair(f"{shift}", base, base + shift + generator.normal(0.0, 0.8, 20)) for shift in shifts]
    found = compare(pairs, "value", 1, lambda sample: sample.values, paired=True)
    raw = [float(stats.wilcoxon(p.second.values - p.first.values).pvalue) for p in pairs]
    # Holm: the k-th smallest of m p values times m - k + 1, never below the ones before it, at most 1.
    expected, largest = [0.0] * len(raw), 0.0
    for rank, index in enumerate(np.argsort(raw)):
        largest = max(largest, min(1.0, raw[index] * (len(raw) - rank)))
        expected[index] = largest
    assert [each.p for each in found] == pytest.approx(expected)
    assert found[2].p < 0.01 < found[0].p


def test_missions_without_a_partner_do_not_count():
    one = pair("x", np.array([1.0, 2.0, 3.0]), np.array([30.0, 10.0]), np.array([3, 1]))
    (found,) = compare([one], "v", 1, lambda sample: sample.values, paired=True)
    assert (found.pairs, found.values) == (2, (2.0, 20.0))
    assert found.difference.value == 18.0
    assert found.superiority == 1.0


def test_equal_missions_have_no_test():
    (found,) = compare([pair("x", np.ones(5), np.ones(5))], "value", 1, lambda sample: sample.values, paired=True)
    assert (found.difference.value, found.superiority, found.p) == (0.0, 0.5, None)

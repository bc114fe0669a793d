"""Each controller compared with the reference in pairs of missions with the same victims."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from robotteamsim.analysis.report.rank_tests import holm, mean_shift, superiority, wilcoxon
from robotteamsim.analysis.report.statistics import Interval

Sample = TypeVar("Sample")


@dataclass(frozen=True, slots=True)
class Pair(Generic[Sample]):
    """Two samples of one place: the reference and another controller."""

    where: str
    reference: Sample
    other: Sample
    names: tuple[str, str]
    numbers: tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, slots=True)
class Difference:
    """The difference of two controllers in one quantity.

    values:      means of the reference and of the other controller.
    difference:  the other minus the reference, with the 95 % t interval of the pairs.
    superiority: probability that the other has the larger value; ties count half.
    p:           of Wilcoxon's signed-rank test, with Holm's correction over all comparisons of the quantity; None if
                 there is nothing to test, because all pairs are equal.
    """

    where: str
    names: tuple[str, str]
    quantity: str
    pairs: int
    values: tuple[float, float]
    difference: Interval
    superiority: float
    p: float | None


def differences(
    pairs: Sequence[Pair[Sample]], quantity: str, of: Callable[[Sample], np.ndarray]
) -> tuple[Difference, ...]:
    """Compare one quantity in all pairs of samples; missions without a partner do not count."""
    matched = [_matched(pair, of) for pair in pairs]
    known = [(pair, values) for pair, values in zip(pairs, matched, strict=True) if len(values[0])]
    p_values = holm([wilcoxon(a, b) for _, (a, b) in known])
    return tuple(
        Difference(
            where=pair.where,
            names=pair.names,
            quantity=quantity,
            pairs=len(a),
            values=(float(np.mean(a)), float(np.mean(b))),
            difference=mean_shift(a, b, paired=True),
            superiority=superiority(a, b, paired=True),
            p=p,
        )
        for (pair, (a, b)), p in zip(known, p_values, strict=True)
    )


def _matched(pair: Pair[Sample], of: Callable[[Sample], np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    _, first, second = np.intersect1d(*pair.numbers, return_indices=True)
    return of(pair.reference)[first].astype(float), of(pair.other)[second].astype(float)

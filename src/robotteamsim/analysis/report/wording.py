"""Numbers in sentences and tables."""

from __future__ import annotations

import math

from robotteamsim.analysis.report.statistics import Interval


def percents(*shares: float) -> list[str]:
    """Return shares as integer per cent, or all with one decimal if one is near 0 or 1."""
    values = [100.0 * share for share in shares]
    digits = 1 if any(0.0 < value < 5.0 or 95.0 < value < 100.0 for value in values) else 0
    return [f"{value:.{digits}f} %" for value in values]


def share_text(share: Interval) -> str:
    """Return a share with its interval in brackets."""
    value, low, high = percents(share.value, share.low, share.high)
    return f"{value} [{low}, {high}]"


def interval_text(interval: Interval, digits: int) -> str:
    """Return a value with its interval in brackets, or "[-, -]" where there is none."""
    if math.isnan(interval.low):
        return f"{interval.value:z.{digits}f} [-, -]"
    return f"{interval.value:z.{digits}f} [{interval.low:z.{digits}f}, {interval.high:z.{digits}f}]"


def difference_text(interval: Interval, digits: int) -> str:
    """Return a difference with its interval for a sentence, with minus signs instead of hyphens."""
    return interval_text(interval, digits).replace(" [-, -]", ", no interval").replace("-", "\N{MINUS SIGN}")


def p_text(p: float | None) -> str:
    """Return a text such as "p = 0.012"; None means that the samples allow no test."""
    if p is None:
        return "no test possible"
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}" if p < 0.1 else f"p = {p:.2f}"


def listed(words: list[str]) -> str:
    """Return words as "a, b and c"."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)

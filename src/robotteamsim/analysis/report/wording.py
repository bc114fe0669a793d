"""How numbers stand in sentences and tables."""

from __future__ import annotations

from robotteamsim.analysis.report.statistics import Interval


def percent(share: float) -> str:
    """Return a share as whole per cent, or with one decimal where it is near 0 or 1."""
    value = 100.0 * share
    return f"{value:.1f} %" if 0.0 < value < 5.0 or 95.0 < value < 100.0 else f"{value:.0f} %"


def share_text(share: Interval) -> str:
    """Return a share with its interval in brackets."""
    return f"{percent(share.value)} [{percent(share.low)}, {percent(share.high)}]"


def interval_text(interval: Interval, digits: int) -> str:
    """Return a value with its interval in brackets."""
    return f"{interval.value:.{digits}f} [{interval.low:.{digits}f}, {interval.high:.{digits}f}]"


def p_text(p: float | None) -> str:
    """Return "p = 0.012" and the like; none: no test can tell."""
    if p is None:
        return "no difference to test"
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}" if p < 0.1 else f"p = {p:.2f}"


def listed(words: list[str]) -> str:
    """Return words as "a, b and c"."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)

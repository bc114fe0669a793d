"""The first paragraphs of a report."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from robotteamsim.analysis.report.contrasts import Contrast
from robotteamsim.analysis.report.wording import interval_text, p_text

_MAX_COMPARED = 6
_MAX_SUMMARISED = 3


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

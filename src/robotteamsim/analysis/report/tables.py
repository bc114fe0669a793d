"""Tables of a report: CSV for programs, LaTeX for papers, rows for the page."""

from __future__ import annotations

import csv
import io
import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.report.contrasts import Contrast, Overall
from robotteamsim.analysis.report.samples import Panel, Series
from robotteamsim.analysis.report.statistics import Interval, bootstrap_mean, clopper_pearson, generator
from robotteamsim.analysis.report.wording import interval_text, p_text, share_text
from robotteamsim.recording.network_log import NetworkTotals
from robotteamsim.wording import safe_cell

_LATEX = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"$<$",
    ">": r"$>$",
    "\N{MINUS SIGN}": r"$-$",
    "\N{EN DASH}": "--",
    "\N{GREATER-THAN OR EQUAL TO}": r"$\ge$",
}


_LETTER_PT, _GAP_PT = 5.0, 12.0
"""Mean width of a letter of LaTeX's 10 pt, and the space between two columns of a table."""
_IN_COLUMN_PT = 315.0
"""A table of this width has letters of 8 pt when it is shrunk to a column of 3.5 inches, which is 252 pt."""


@dataclass(frozen=True, slots=True)
class Entry:
    """An entry with numbers. text: as readers see it. numbers: for CSV; of an interval value, lower and upper bound."""

    text: str
    numbers: tuple[str, ...]


UNKNOWN = Entry("-", ("",))
"""Where there is no value."""


def interval_entry(interval: Interval, digits: int) -> Entry:
    """Return a value with its interval."""
    return Entry(interval_text(interval, digits), _numbers(interval, digits))


def share_entry(share: Interval) -> Entry:
    """Return a share with its interval: per cent for readers, 0 to 1 in CSV."""
    return Entry(share_text(share), _numbers(share, 4))


def p_entry(p: float | None) -> Entry:
    """Return a p value; None means that the samples allow no test."""
    return Entry(p_text(p), ("" if p is None else f"{p:.4g}",))


def _numbers(interval: Interval, digits: int) -> tuple[str, ...]:
    values = interval.value, interval.low, interval.high
    return tuple("" if math.isnan(value) else f"{value:z.{digits}f}" for value in values)


@dataclass(frozen=True, slots=True)
class Table:
    """A table. name: of its files. title: its caption. The first `left` columns are left-aligned."""

    name: str
    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str | Entry, ...], ...]
    left: int = 1

    @property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """The rows as readers see them."""
        return tuple(tuple(entry.text if isinstance(entry, Entry) else entry for entry in row) for row in self.rows)

    def csv(self) -> str:
        """Return the table as comma-separated values; the bounds of intervals have columns of their own."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        columns = zip(self.head, *self.rows, strict=True)
        parts = [part for name, *entries in columns for part in _columns(str(name), entries)]
        writer.writerows(map(safe_cell, row) for row in zip(*parts, strict=True))
        return text.getvalue()

    def latex(self, in_columns: bool = False) -> str:
        """Return the table as a LaTeX float that is not wider than the text; its first line names the packages.

        Args: in_columns: of a paper in two columns: a table that is wider than one of them spans both.
        """
        columns_of = zip(self.head, *self.texts, strict=True)
        width_pt = sum(_LETTER_PT * max(map(len, column)) + _GAP_PT for column in columns_of)
        kind = "table*" if in_columns and width_pt > _IN_COLUMN_PT else "table"
        head = " & ".join(map(_latex, self.head))
        body = "\n".join(f"    {' & '.join(map(_latex, row))} \\\\" for row in self.texts)
        caption = f"\\caption{{{_latex(self.title)}}}\\label{{tab:{self.name}}}"
        columns = "l" * self.left + "r" * (len(self.head) - self.left)
        return (
            "% \\usepackage{adjustbox,booktabs}\n"
            f"\\begin{{{kind}}}\n  \\centering\n  {caption}\n"
            "  \\begin{adjustbox}{max width=\\linewidth}\n"
            f"  \\begin{{tabular}}{{{columns}}}\n    \\toprule\n    {head} \\\\\n    \\midrule\n"
            f"{body}\n    \\bottomrule\n  \\end{{tabular}}\n  \\end{{adjustbox}}\n\\end{{{kind}}}\n"
        )


def _columns(name: str, entries: Sequence[str | Entry]) -> list[tuple[str, ...]]:
    """Return a column as those of a CSV file: one, or value, lower and upper bound."""
    rows = [entry.numbers if isinstance(entry, Entry) else (entry,) for entry in entries]
    names = (name, f"{name} low", f"{name} high")[: max(map(len, rows))]
    padded = [(*row, *[""] * (len(names) - len(row))) for row in rows]
    return [(part, *(row[place] for row in padded)) for place, part in enumerate(names)]


def campaign_tables(
    panels: Sequence[Panel], between: Sequence[Contrast], all_cells: Overall | None
) -> tuple[Table, ...]:
    """Return the tables of a campaign, without empty ones; the one named "differences" compares the settings."""
    tables = (
        difference_table(between),
        _missions(panels),
        _victims(panels),
        _given_victims(panels),
        network_table(("",), [((name,), each.missions.networks) for name, each in _named(panels)]),
        _overall(all_cells),
    )
    return tuple(table for table in tables if table.rows)


def _missions(panels: Sequence[Panel]) -> Table:
    """Mean, median and mode, with standard deviation and intervals."""
    head: tuple[str, ...] = ("", "missions", "cut short", "time [s]", "SD", "median", "mode")
    head += ("victims saved", "areas", "endangered")
    rows = []
    for name, each in _named(panels):
        sample = each.missions
        times = sample.restricted_s
        rows.append(
            (
                name,
                str(len(sample)),
                str(int((~sample.finished).sum())),
                interval_entry(bootstrap_mean(times, generator("time", name)), 1),
                f"{np.std(times, ddof=1):.1f}" if len(times) > 1 else UNKNOWN,
                f"{np.median(times):.1f}",
                f"{min(statistics.multimode(np.rint(times).astype(int).tolist())):d}",
                interval_entry(bootstrap_mean(sample.victims_saved.astype(float), generator("victims", name)), 2),
                f"{np.mean(sample.areas_explored):.2f}",
                str(int(np.count_nonzero(sample.endangered))),
            )
        )
    return Table(
        "missions",
        "Missions of each setting: means with 95 % bootstrap intervals; missions with an endangered link",
        head,
        tuple(rows),
    )


def _victims(panels: Sequence[Panel]) -> Table:
    """Missions by the number of victims saved."""
    named = _named(panels)
    counts = range(max(each.missions.num_victims for _, each in named) + 1)
    rows = (
        (name, *(str(int(np.count_nonzero(each.missions.victims_saved == count))) for count in counts))
        for name, each in named
    )
    return Table(
        "victims", "Missions by the number of victims saved", ("", *(f"{count} saved" for count in counts)), tuple(rows)
    )


def _given_victims(panels: Sequence[Panel]) -> Table:
    """Durations of the missions that saved each number of victims."""
    rows = []
    for name, each in _named(panels):
        for saved in sorted(set(each.missions.victims_saved.tolist())):
            times_s = each.missions.time_given_s(saved)
            mean: str | Entry = f"{times_s[0]:.1f}"
            sd: str | Entry = UNKNOWN
            if len(times_s) > 1:
                mean = interval_entry(bootstrap_mean(times_s, generator("given", f"{name}, {saved}")), 1)
                sd = f"{np.std(times_s, ddof=1):.1f}"
            rows.append((name, str(saved), str(len(times_s)), mean, sd))
    title = "Duration given the number of victims saved: means with 95 % bootstrap intervals"
    return Table("durations_by_victims", title, ("", "saved", "missions", "time [s]", "SD"), tuple(rows), 2)


def difference_table(contrasts: Sequence[Contrast]) -> Table:
    """Return differences between settings: the names, the values of both, the difference, effect size and p of each."""
    paired, placed = any(c.pairs is not None for c in contrasts), any(c.where for c in contrasts)
    rows = []
    for c in contrasts:
        means = tuple(f"{value:.{c.decimals}f}" for value in c.values)
        shift = interval_entry(c.difference, c.decimals)
        where = (c.where,) if placed else ()
        pairs = (str(c.pairs),) if paired else ()
        rows.append(
            (*where, c.first, c.second, c.quantity, *pairs, *means, shift, f"{c.superiority:.2f}", p_entry(c.p))
        )
    test = "Wilcoxon, pairs of equal seed" if paired else "Mann-Whitney"
    title = f"Differences between settings: second minus first with 95 % t interval; {test}, p after Holm"
    names = (*(("at",) if placed else ()), "first", "second", "quantity")
    values = (*(("pairs",) if paired else ()), "first mean", "second mean", "difference", "P(second larger)", "p")
    return Table("differences", title, (*names, *values), tuple(rows), len(names))


def network_table(keys: Sequence[str], settings: Sequence[tuple[tuple[str, ...], Sequence[NetworkTotals]]]) -> Table:
    """Return the networks of the missions of each setting; the last columns only if a team has a base.

    Args: keys: heads of the settings' names.  settings: of each, its names and the totals of its missions.
    """
    known = [(names, totals) for names, totals in settings if totals]
    has_base = any(each.base_areas is not None for _, totals in known for each in totals)
    rows = tuple((*names, *_network_cells(names, totals, has_base)) for names, totals in known)
    head = ("missions", "never split", "time split [s]", "time endangered [s]", "links broken", "messages lost")
    title = "Networks: means with 95 % bootstrap intervals; missions whose team was never split, with exact intervals"
    base = ("areas known at the base", "victims known at the base") if has_base else ()
    return Table("networks", title, (*keys, *head, *base), rows, len(keys))


def _network_cells(names: tuple[str, ...], totals: Sequence[NetworkTotals], has_base: bool) -> tuple[str | Entry, ...]:
    def mean(key: str, digits: int) -> Entry:
        values = [getattr(each, key) for each in totals]
        if None in values:
            return UNKNOWN
        return interval_entry(bootstrap_mean(np.array(values, dtype=float), generator(key, *names)), digits)

    whole = sum(each.split_s == 0.0 for each in totals)
    return (
        str(len(totals)),
        share_entry(clopper_pearson(whole, len(totals))),
        *(mean("split_s", 1), mean("endangered_s", 1), mean("breaks", 1), mean("messages_lost", 1)),
        *((mean("base_areas", 2), mean("base_victims", 2)) if has_base else ()),
    )


def _overall(overall: Overall | None) -> Table:
    """Tests of all cells at once."""
    rows: list[tuple[str | Entry, ...]] = []
    if overall:
        rows.append(("time", "all settings equal (Kruskal-Wallis)", p_entry(overall.time_p)))
        rows.append(("victims saved", "all settings equal (Fisher-Freeman-Halton)", p_entry(overall.victims_p)))
        rows.append(("areas explored", "all settings equal (Fisher-Freeman-Halton)", p_entry(overall.areas_p)))
    return Table("overall", "Tests of all settings at once", ("", "hypothesis", "p"), tuple(rows), 2)


def _named(panels: Sequence[Panel]) -> list[tuple[str, Series]]:
    return [named for panel in panels for named in panel.named()]


def _latex(text: str) -> str:
    return "".join(_LATEX.get(letter, letter) for letter in text)

"""Tables of a report: CSV for programs, LaTeX for papers, rows for the page."""

from __future__ import annotations

import csv
import io
import re
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.report.contrasts import Contrast, Overall
from robotteamsim.analysis.report.samples import Panel, Series
from robotteamsim.analysis.report.statistics import bootstrap_mean, clopper_pearson, generator
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


_INTERVAL = re.compile(r"(\S+) \[(\S+), (\S+)]")


@dataclass(frozen=True, slots=True)
class Table:
    """A table. name: of its files. title: its caption. head, rows: texts; the first `left` columns are left-aligned."""

    name: str
    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left: int = 1

    def csv(self) -> str:
        """Return the table as comma-separated values; the bounds of intervals have columns of their own."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        columns = [
            column
            for name, *cells in zip(self.head, *self.rows, strict=True)
            for column in (_parted(name, cells) or [(name, *cells)])
        ]
        writer.writerows(map(safe_cell, row) for row in zip(*columns, strict=True))
        return text.getvalue()

    def latex(self) -> str:
        """Return the table as a LaTeX float that is not wider than the text; its first line names the packages."""
        head = " & ".join(map(_latex, self.head))
        body = "\n".join(f"    {' & '.join(map(_latex, row))} \\\\" for row in self.rows)
        caption = f"\\caption{{{_latex(self.title)}}}\\label{{tab:{self.name}}}"
        columns = "l" * self.left + "r" * (len(self.head) - self.left)
        return (
            "% \\usepackage{adjustbox,booktabs}\n"
            f"\\begin{{table}}\n  \\centering\n  {caption}\n"
            "  \\begin{adjustbox}{max width=\\linewidth}\n"
            f"  \\begin{{tabular}}{{{columns}}}\n    \\toprule\n    {head} \\\\\n    \\midrule\n"
            f"{body}\n    \\bottomrule\n  \\end{{tabular}}\n  \\end{{adjustbox}}\n\\end{{table}}\n"
        )


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
                interval_text(bootstrap_mean(times, generator("time", name)), 1),
                f"{np.std(times, ddof=1):.1f}" if len(times) > 1 else "-",
                f"{np.median(times):.1f}",
                f"{min(statistics.multimode(np.rint(times).astype(int).tolist())):d}",
                interval_text(bootstrap_mean(sample.victims_saved.astype(float), generator("victims", name)), 2),
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
            mean, sd = f"{times_s[0]:.1f}", "-"
            if len(times_s) > 1:
                mean = interval_text(bootstrap_mean(times_s, generator("given", f"{name}, {saved}")), 1)
                sd = f"{np.std(times_s, ddof=1):.1f}"
            rows.append((name, str(saved), str(len(times_s)), mean, sd))
    title = "Duration given the number of victims saved: means with 95 % bootstrap intervals"
    return Table("durations_by_victims", title, ("", "saved", "missions", "time [s]", "SD"), tuple(rows), 2)


def difference_table(contrasts: Sequence[Contrast]) -> Table:
    """Return differences between settings: the name, the values of both, the difference, effect size and p of each."""
    paired = any(c.pairs is not None for c in contrasts)
    rows = []
    for c in contrasts:
        means = tuple(f"{value:.{c.decimals}f}" for value in c.values)
        shift = interval_text(c.difference, c.decimals)
        setting = f"{c.first}, {c.second}" + (f" ({c.where})" if c.where else "")
        pairs = (str(c.pairs),) if paired else ()
        rows.append((setting, c.quantity, *pairs, *means, shift, f"{c.superiority:.2f}", p_text(c.p)))
    test = "Wilcoxon, pairs of equal seed" if paired else "Mann-Whitney"
    title = f"Differences between settings: second minus first with 95 % t interval; {test}, p after Holm"
    values = ("first", "second", "difference", "P(second larger)", "p")
    head = ("first, second", "", *(("pairs",) if paired else ()), *values)
    return Table("differences", title, head, tuple(rows), 2)


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


def _network_cells(names: tuple[str, ...], totals: Sequence[NetworkTotals], has_base: bool) -> tuple[str, ...]:
    def mean(key: str, digits: int) -> str:
        values = [getattr(each, key) for each in totals]
        if None in values:
            return "-"
        return interval_text(bootstrap_mean(np.array(values, dtype=float), generator(key, *names)), digits)

    whole = sum(each.split_s == 0.0 for each in totals)
    return (
        str(len(totals)),
        share_text(clopper_pearson(whole, len(totals))),
        *(mean("split_s", 1), mean("endangered_s", 1), mean("breaks", 1), mean("messages_lost", 1)),
        *((mean("base_areas", 2), mean("base_victims", 2)) if has_base else ()),
    )


def _overall(overall: Overall | None) -> Table:
    """Tests of all cells at once."""
    rows: list[tuple[str, ...]] = []
    if overall:
        rows.append(("time", "all settings equal (Kruskal-Wallis)", p_text(overall.time_p)))
        rows.append(("victims saved", "all settings equal (Fisher-Freeman-Halton)", p_text(overall.victims_p)))
        rows.append(("areas explored", "all settings equal (Fisher-Freeman-Halton)", p_text(overall.areas_p)))
    return Table("overall", "Tests of all settings at once", ("", "hypothesis", "p"), tuple(rows), 2)


def _named(panels: Sequence[Panel]) -> list[tuple[str, Series]]:
    return [named for panel in panels for named in panel.named()]


def _parted(name: str, cells: Sequence[str]) -> list[tuple[str, ...]]:
    """Return a column of intervals as three columns: values, lower and upper bounds; [] if none are intervals.

    A cell without an interval is a value without bounds.
    """
    found = [_INTERVAL.fullmatch(cell) for cell in cells]
    if not any(found) or any(" " in cell for cell, match in zip(cells, found, strict=True) if match is None):
        return []
    parts = [match.groups() if match else (cell, "", "") for cell, match in zip(cells, found, strict=True)]
    names = (name, f"{name} low", f"{name} high")
    return [(part, *(each[group] for each in parts)) for group, part in enumerate(names)]


def _latex(text: str) -> str:
    return "".join(_LATEX.get(letter, letter) for letter in text)

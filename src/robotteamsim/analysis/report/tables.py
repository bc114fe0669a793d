"""Tables of a report: CSV for programs, LaTeX for papers, rows for the page."""

from __future__ import annotations

import csv
import io
import math
import re
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.report.claims import Claim
from robotteamsim.analysis.report.comparison import Comparison, Differences, means
from robotteamsim.analysis.report.samples import Campaign, Cell, Sample
from robotteamsim.analysis.report.wording import interval_text, p_text, share_text
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
        """Return the table as a LaTeX float, or as a longtable over several pages if it consists of sentences.

        Its first line names the required packages. No table is wider than the text.
        """
        head = " & ".join(map(_latex, self.head))
        body = "\n".join(f"    {' & '.join(map(_latex, row))} \\\\" for row in self.rows)
        caption = f"\\caption{{{_latex(self.title)}}}\\label{{tab:{self.name}}}"
        top = f"    \\toprule\n    {head} \\\\\n    \\midrule\n"
        if self.left == len(self.head):
            return (
                "% \\usepackage{array,booktabs,longtable}\n"
                f"{{\\small\n\\begin{{longtable}}{{{_text_columns(self.rows)}}}\n  {caption} \\\\\n"
                f"{top}    \\endfirsthead\n{top}    \\endhead\n"
                f"{body}\n    \\bottomrule\n\\end{{longtable}}\n}}\n"
            )
        columns = "l" * self.left + "r" * (len(self.head) - self.left)
        return (
            "% \\usepackage{adjustbox,booktabs}\n"
            f"\\begin{{table}}\n  \\centering\n  {caption}\n"
            "  \\begin{adjustbox}{max width=\\linewidth}\n"
            f"  \\begin{{tabular}}{{{columns}}}\n{top}"
            f"{body}\n    \\bottomrule\n  \\end{{tabular}}\n  \\end{{adjustbox}}\n\\end{{table}}\n"
        )


def all_tables(
    campaign: Campaign, comparisons: Sequence[Comparison], differences: Differences | None, claims: Sequence[Claim]
) -> tuple[Table, ...]:
    """Return the tables of a report, without empty ones."""
    tables = [_claims(claims), _missions(campaign), _victims(campaign), _against(comparisons), _between(differences)]
    return tuple(table for table in tables if table.rows)


def _missions(campaign: Campaign) -> Table:
    """Mean, median and mode as in Tables 8 and 9, with standard deviation and intervals."""
    head: tuple[str, ...] = ("", "missions", "cut short", "time [s]", "SD", "median", "mode")
    head += ("victims saved", "areas", "endangered")
    rows = []
    for name, sample in _labelled(campaign.cells):
        times = sample.restricted_s
        found = means(sample, name)
        rows.append(
            (
                name,
                str(len(sample)),
                str(int((~sample.finished).sum())),
                interval_text(found.time_s, 1),
                f"{np.std(times, ddof=1):.1f}" if len(times) > 1 else "-",
                f"{np.median(times):.1f}",
                f"{min(statistics.multimode(np.rint(times).astype(int).tolist())):d}",
                interval_text(found.victims, 2),
                f"{found.areas.value:.2f}",
                str(int(np.count_nonzero(sample.endangered))),
            )
        )
    return Table(
        "missions",
        "Missions of each setting: means with 95 % bootstrap intervals; missions with an endangered link",
        head,
        tuple(rows),
    )


def _victims(campaign: Campaign) -> Table:
    """Missions by the number of victims saved."""
    labelled = _labelled(campaign.cells)
    counts = range(max(sample.num_victims for _, sample in labelled) + 1)
    rows = (
        (name, *(str(int(np.count_nonzero(sample.victims_saved == count))) for count in counts))
        for name, sample in labelled
    )
    return Table("victims", "Missions by the number of victims saved", ("", *map(str, counts)), tuple(rows))


def _against(comparisons: Sequence[Comparison]) -> Table:
    """Tests against the dissertation's missions."""
    rows = []
    for comparison in comparisons:
        interval = interval_text(comparison.time.interval, 3)
        rows.append((comparison.name, "mean time, ours over theirs [90 %]", interval, "0.9 to 1.1"))
        rows.append((comparison.name, "equivalence of mean times, after Holm", p_text(comparison.time_p), "p < 0.05"))
        rows.append(
            (
                comparison.name,
                "victims, Fisher-Freeman-Halton, after Holm",
                p_text(comparison.victims_p),
                "p \N{GREATER-THAN OR EQUAL TO} 0.05",
            )
        )
        for rate in comparison.rates:
            what = f"missions with at least {rate.saved} victims saved [95 %]"
            rows.append((comparison.name, what, share_text(rate.ours), share_text(rate.theirs)))
    return Table("tests", "Tests against the dissertation", ("", "test", "ours", "required, or theirs"), tuple(rows), 2)


def _between(differences: Differences | None) -> Table:
    """Tests between our own cells."""
    rows: list[tuple[str, ...]] = []
    if differences:
        rows.append(("time", "all settings equal (Kruskal-Wallis)", p_text(differences.time_p)))
        rows.append(("victims saved", "all settings equal (Fisher-Freeman-Halton)", p_text(differences.victims_p)))
        rows.append(("areas explored", "all settings equal (Fisher-Freeman-Halton)", p_text(differences.areas_p)))
        for pair in differences.pairs:
            rows.append(("time", f"{pair.first} against {pair.second} (Mann-Whitney, after Holm)", p_text(pair.p)))
    return Table("differences", "Tests between settings", ("", "hypothesis", "p"), tuple(rows), 2)


def _claims(claims: Sequence[Claim]) -> Table:
    rows = tuple((claim.text, claim.source, claim.verdict, claim.why) for claim in claims)
    return Table("claims", "The dissertation's claims", ("claim", "source", "verdict", "reason"), rows, 4)


def _labelled(cells: Sequence[Cell]) -> list[tuple[str, Sample]]:
    """Return our sample and theirs of each cell, with the labels used in figures."""
    labelled = []
    for cell in cells:
        labelled.append((f"{cell.name}, ours" if cell.theirs else cell.name, cell.ours))
        if cell.theirs is not None:
            labelled.append((f"{cell.name}, dissertation", cell.theirs))
    return labelled


def _parted(name: str, cells: Sequence[str]) -> list[tuple[str, ...]]:
    """Return a column of intervals as three columns: values, lower and upper bounds; [] if not all are intervals."""
    found = [_INTERVAL.fullmatch(cell) for cell in cells]
    matches = [match for match in found if match is not None]
    if len(matches) < len(cells):
        return []
    names = (name, f"{name} low", f"{name} high")
    return [(part, *(match[group] for match in matches)) for group, part in enumerate(names, 1)]


def _text_columns(rows: Sequence[Sequence[str]]) -> str:
    """Return column widths by the square root of the longest cell, at least that of the longest word."""
    weights = []
    for column in zip(*rows, strict=True):
        longest_word = max(len(word) for cell in column for word in cell.split())
        weights.append(max(math.sqrt(max(map(len, column))), 0.6 * longest_word))
    inner = f"\\dimexpr\\linewidth-{2 * len(weights)}\\tabcolsep"
    return "".join(
        rf">{{\raggedright\arraybackslash}}p{{{weight / sum(weights):.3f}{inner}\relax}}" for weight in weights
    )


def _latex(text: str) -> str:
    return "".join(_LATEX.get(letter, letter) for letter in text)

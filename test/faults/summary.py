"""The summary of a tool: a table on the terminal, a CSV file, and the faults."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

Row = Mapping[str, object]


def progress_bar(console: Console) -> Progress:
    """Return a bar with counts and times."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    return Progress(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=console)


def print_table(console: Console, title: str, rows: Sequence[Row]) -> None:
    """Print rows with the same keys."""
    table = Table(title=title)
    for key in rows[0] if rows else ():
        is_text = isinstance(rows[0][key], str)
        table.add_column(key, justify="left" if is_text else "right", no_wrap=is_text)
    for row in rows:
        table.add_row(*(escape(f"{value:.2f}" if isinstance(value, float) else str(value)) for value in row.values()))
    console.print(table)


def write_csv(path: Path, rows: Sequence[Row]) -> None:
    """Write rows with the same keys."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]) if rows else [])
        writer.writeheader()
        writer.writerows(rows)

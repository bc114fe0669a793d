"""Appends measurements to files in bench/results, with date, processor, commit and load of the machine."""

from __future__ import annotations

import csv
import datetime
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

RUN_COLUMNS = ("date", "cpu", "commit", "load")


def append(path: Path, work: str, robots: int, quantities: dict[str, float]) -> None:
    """Append one row per quantity. Quantities are named with their unit, as in "world [s/s]"."""
    rows = [(work, robots, quantity, f"{value:.4g}") for quantity, value in quantities.items()]
    append_rows(path, ("work", "robots", "quantity", "value"), rows)


def append_rows(path: Path, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Append rows to a table, which is created with its header if there is none."""
    is_new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if is_new:
            writer.writerow((*RUN_COLUMNS, *columns))
        run = (datetime.date.today().isoformat(), _cpu(), _commit(), f"{os.getloadavg()[0]:.1f}")
        writer.writerows((*run, *row) for row in rows)


def _cpu() -> str:
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    model = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return f"{model}, {os.cpu_count()} cores"


def _commit() -> str:
    command = ("git", "describe", "--always", "--dirty", "--abbrev=7")
    return subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parent).stdout.strip()

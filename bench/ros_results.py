"""Writes what the ROS benchmarks have measured into bench/results/ros.csv, one row per measurement."""

from __future__ import annotations

import csv
import datetime
import os
import subprocess
from pathlib import Path

COLUMNS = ("date", "cpu", "commit", "load", "work", "robots", "quantity", "value")


def append(path: Path, work: str, robots: int, quantities: dict[str, float]) -> None:
    """Append rows. Quantities are named with their unit, as in "world [s/s]"."""
    is_new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if is_new:
            writer.writerow(COLUMNS)
        run = (datetime.date.today().isoformat(), _cpu(), _commit(), f"{os.getloadavg()[0]:.1f}")
        for quantity, value in quantities.items():
            writer.writerow((*run, work, robots, quantity, f"{value:.4g}"))


def _cpu() -> str:
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    model = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return f"{model}, {os.cpu_count()} cores"


def _commit() -> str:
    command = ("git", "describe", "--always", "--dirty", "--abbrev=7")
    return subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parent).stdout.strip()

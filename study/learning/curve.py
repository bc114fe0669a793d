"""Collect the curves of trainings, and judge other controllers in the same missions: curve.csv.

Usage: python -m study.learning.curve DIR...     folders of trainings by examples/learning; needs the extra `train`
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

from bench.results_file import append_rows

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples" / "learning"))

import search_task  # noqa: E402

RESULTS = Path(__file__).with_suffix(".csv")
CONTROLLERS = ("random_walk", "rdpso", "greedy", "search")
MISSIONS = 10


def main(folders: list[str]) -> None:
    """Append the curves of the folders, and a row for each controller."""
    columns = search_task.Training.COLUMNS
    for folder in folders:
        with (Path(folder) / "learning_curve.csv").open(encoding="utf-8", newline="") as file:
            append_rows(RESULTS, columns, list(csv.reader(file))[1:])
    for controller in CONTROLLERS:
        judged = search_task.judge_controller(controller, MISSIONS)
        means = (f"{values.mean():.4g}" for values in judged)
        append_rows(RESULTS, columns, [(controller, "", "", "", *means)])


if __name__ == "__main__":
    main(sys.argv[1:])

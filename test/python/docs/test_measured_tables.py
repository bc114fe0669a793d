"""Numbers in the documentation are those that the benchmarks and the report have written."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
REPORT = "study/dissertation/report"


def rows(path: str) -> list[dict[str, str]]:
    with (ROOT / path).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def text(path: str) -> str:
    return " ".join((ROOT / path).read_text(encoding="utf-8").split())


def cell(row: dict[str, str], key: str, digits: int) -> str:
    mean, low, high = (f"{float(row[key + end]):.{digits}f}" for end in ("", "_low_95", "_high_95"))
    return f"{mean} [{low}, {high}]"


def share(row: dict[str, str]) -> str:
    return f"{100.0 * float(row['complete']):.0f} %"


@pytest.mark.parametrize("row", rows("study/swarm/adaptation.csv"), ids=lambda row: row["row"])
def test_table_of_adaptation_is_that_of_the_benchmark(row):
    numbers = [cell(row, "time_s", 0), *(cell(row, key, 1) for key in ("victims", "areas", "endangered_links"))]
    assert f"| {row['row']} | {' | '.join(numbers)} | {share(row)} |" in text("study/swarm/README.md")


def test_table_of_additions_is_that_of_the_benchmark():
    measured = {(row["row"], row["noise_db"]): row for row in rows("study/swarm/additions.csv")}
    page = text("study/swarm/README.md").replace("`", "")
    for name in sorted({name for name, _ in measured}):
        both = [measured[name, noise_db] for noise_db in ("20.0", "10.0")]
        numbers = [f"{cell(row, 'time_s', 0)} | {cell(row, 'victims', 1)} | {share(row)}" for row in both]
        assert f"| {name} | {' | '.join(numbers)} |" in page


@pytest.mark.parametrize("building", ["garage", "office", "office, exclusion as printed"])
def test_table_of_lost_robots_is_that_of_the_benchmark(building):
    complete = [
        (row["robots"], row["lost"], float(row["time_s"]))
        for row in rows("study/swarm/losses.csv")
        if row["building"] == building and row["all_areas"] == "1"
    ]

    def counts(robots: str, limit_s: float) -> str:
        own = [[time_s for r, n, time_s in complete if (r, n) == (robots, lost)] for lost in "012"]
        return ", ".join(str(sum(time_s <= limit_s for time_s in times_s)) for times_s in own)

    cells = [f"{counts(robots, 1200.0)} ({counts(robots, 600.0)})" for robots in "35"]
    assert f"| {building} | {cells[0]} |" in text("study/swarm/README.md")
    assert "printed" in building or f"| {cells[1]} |" in text("study/swarm/README.md")


def test_study_states_the_verdicts_of_the_shipped_report():
    verdicts = [row["verdict"] for row in rows(f"{REPORT}/tables/claims.csv") if row["basis"] == "not fitted"]
    yes, no = verdicts.count("reproduced"), verdicts.count("not reproduced")
    counts = f"{yes} are reproduced in all five campaigns, {no} are not reproduced, and {len(verdicts) - yes - no} are"
    page = text("study/dissertation/README.md")
    assert f"Of the {len(verdicts)} claims that were not fitted, {counts} undecided" in page
    assert "agreement with the means of Table 8 is calibration and confirms nothing" in page
    assert f"Of these {len(verdicts)} claims, {yes} are reproduced, {no} are not" in text(f"{REPORT}/report.html")

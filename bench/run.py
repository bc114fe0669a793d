"""Run the benchmarks of the C++ core and of its Python face, and print them as ratios.

Each row compares with a straightforward implementation (one ray per cell or link, a matrix power, a dense solver) and
with a memset of the map that it writes, measured in the same run. Values are medians over repetitions, each of them a
median over many turns. What runs on one thread is timed by its processor's time.
Usage: python bench/run.py build/devel/lib/robotteamsim/robotteamsim_bench [--csv bench/results/speed.csv]
"""

from __future__ import annotations

import argparse
import csv
import datetime
import json
import re
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

BENCH = Path(__file__).resolve().parent
TIME_UNITS_US = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


@dataclass(frozen=True, slots=True)
class Goal:
    """A limit of one figure of a row."""

    figure: str
    at_most: float
    unit: str

    def __str__(self) -> str:
        return f"<= {self.at_most:g} {self.unit}"


@dataclass(frozen=True, slots=True)
class Work:
    """One row: what is done, by which benchmark, beside which plain one, and how fast it should be."""

    name: str
    benchmark: str
    plain: str | None = None
    goal: Goal | None = None


def memsets(at_most: float) -> Goal:
    return Goal("memsets", at_most, "memsets")


FIEDLER = Goal("time_us", 5000.0, "us")

WORKS = (
    Work("radio map, 960k cells, 428 faces: AVX-512", "RadioMap/avx512", "RadioMapPlain", memsets(4.0)),
    Work("  AVX2", "RadioMap/avx2", "RadioMapPlain", memsets(8.0)),
    Work("  portable C++", "RadioMap/portable", "RadioMapPlain"),
    Work("  20,000 faces", "RadioMap20000Faces", "RadioMap20000FacesPlain"),
    Work("  each of 16, one thread: per map", "RadioMapEachOf16/1", "RadioMapPlain"),
    Work("  each of 16, two threads: per map", "RadioMapEachOf16/2", "RadioMapPlain"),
    Work("  best of 16, one thread: per cell and source", "RadioMapBestOf16/1"),
    Work("  best of 16, two threads: per cell and source", "RadioMapBestOf16/2"),
    Work("voice map, 960k cells, 5 victims", "VoiceMapOf5", "VoiceMapOf5Plain"),
    Work("path loss between two points, 428 faces", "PathLoss"),
    Work("links of 100 robots, 428 faces", "Links/100", "LinksPlain/100", Goal("per_item_ns", 150.0, "ns")),
    Work("  of 1000", "Links/1000", "LinksPlain/1000", Goal("per_item_ns", 40.0, "ns")),
    Work("  of 3000", "Links/3000", goal=Goal("per_item_ns", 20.0, "ns")),
    Work("  of 3000, into fresh memory", "LinksInFreshMemory/3000"),
    Work(
        "hops of 1000 robots, most in reach", "Hops/dense/1000", "HopsPlain/dense/1000", Goal("time_us", 6000.0, "us")
    ),
    Work("  few in reach", "Hops/sparse/1000", "HopsPlain/sparse/1000", Goal("time_us", 6000.0, "us")),
    Work("  of 3000 robots", "Hops/dense/3000"),
    Work("Fiedler value of 1000, most in reach", "Fiedler/dense/1000", "FiedlerPlain/dense/1000", FIEDLER),
    Work("  few in reach", "Fiedler/sparse/1000", "FiedlerPlain/sparse/1000", FIEDLER),
    Work("  of 3000 robots, most in reach", "Fiedler/dense/3000"),
    Work("  few in reach", "Fiedler/sparse/3000"),
    Work("laser of 3 robots: per beam", "LaserScans/3", "LaserScansPlain/3"),
    Work("  of 100", "LaserScans/100", "LaserScansPlain/100"),
    Work("  of 1000", "LaserScans/1000", "LaserScansPlain/1000", Goal("per_item_ns", 20.0, "ns")),
)


@dataclass(frozen=True, slots=True)
class Row:
    """What was measured; nothing where it makes no sense."""

    work: str
    time_us: float
    per_item_ns: float | None = None
    plain_us: float | None = None
    memsets: float | None = None
    goal: Goal | None = None

    @property
    def plain_ratio(self) -> float | None:
        """How many times longer the plain way takes."""
        return None if self.plain_us is None else self.plain_us / self.time_us

    @property
    def is_met(self) -> bool | None:
        """Whether the goal is met, where there is one."""
        if self.goal is None:
            return None
        return getattr(self, self.goal.figure) <= self.goal.at_most


def cpp_figures(program: Path, repetitions: int, pattern: str) -> tuple[dict[str, dict[str, float]], dict]:
    """Run Google Benchmark; return the median of each figure of each benchmark, and the context of the run."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "out.json")
        command = [str(program), f"--benchmark_repetitions={repetitions}", f"--benchmark_filter={pattern}"]
        command += ["--benchmark_min_time=0.2", "--benchmark_out_format=json", f"--benchmark_out={out}"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        report = json.loads(out.read_text(encoding="utf-8"))
    runs: dict[str, list[dict[str, float]]] = {}
    for run in report["benchmarks"]:
        if run["run_type"] != "iteration" or run.get("error_occurred"):
            continue
        name = re.sub(r"/(manual_time|real_time|process_time|iterations:\d+|repeats:\d+)", "", run["name"])
        runs.setdefault(name, []).append(_figures(run))
    medians = {
        name: {figure: statistics.median(run[figure] for run in of_one) for figure in of_one[0]}
        for name, of_one in runs.items()
    }
    return medians, report["context"]


def _figures(run: dict) -> dict[str, float]:
    figures = {"time_us": run.get("median_us", run["cpu_time"] * TIME_UNITS_US[run["time_unit"]])}
    if "ns_per_item" in run:
        figures["per_item_ns"] = run["ns_per_item"]
    elif "items_per_second" in run:
        figures["per_item_ns"] = 1e9 / run["items_per_second"]
    if "memsets" in run:
        figures["memsets"] = run["memsets"]
    return figures


def cpp_rows(figures: dict[str, dict[str, float]]) -> list[Row]:
    """Return the rows of WORKS that were measured, then one for each benchmark that WORKS does not name."""
    rows = []
    for work in WORKS:
        if work.benchmark in figures:
            plain_us = figures[work.plain]["time_us"] if work.plain in figures else None
            rows.append(Row(work.name, plain_us=plain_us, goal=work.goal, **figures[work.benchmark]))
    named = {work.benchmark for work in WORKS} | {work.plain for work in WORKS}
    return rows + [Row(name, **of_one) for name, of_one in figures.items() if name not in named]


def python_rows() -> tuple[list[Row], str]:
    """Run pytest-benchmark; return its rows and the name of the processor."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "out.json")
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:cacheprovider",
            *sorted(map(str, BENCH.glob("python/*_bench.py"))),
        ]
        command += ["--benchmark-timer=time.process_time", f"--benchmark-json={out}"]
        ran = subprocess.run(command, check=False, capture_output=True, text=True)
        if ran.returncode != 0:
            raise SystemExit(ran.stdout + ran.stderr)
        report = json.loads(out.read_text(encoding="utf-8"))
    rows = []
    for run in report["benchmarks"]:
        time_us, extra = run["stats"]["median"] * 1e6, run["extra_info"]
        rows.append(
            Row(
                extra["work"],
                time_us,
                per_item_ns=time_us * 1e3 / extra["items"] if "items" in extra else None,
                plain_us=extra.get("plain_us"),
                memsets=time_us / extra["memset_us"] if "memset_us" in extra else None,
            )
        )
    return rows, report["machine_info"]["cpu"]["brand_raw"]


def printed(value: float | None) -> str:
    """Return three digits of a number that is there."""
    if value is None:
        return ""
    return f"{value:,.0f}" if value >= 100.0 else f"{value:.3g}"


def table(rows: list[Row]) -> str:
    """Return rows as text."""
    heads = ("work", "time [us]", "per item [ns]", "plain [us]", "plain/this", "memsets", "goal", "")
    verdicts = {None: "", True: "met", False: "MISSED"}
    lines = [heads]
    for row in rows:
        numbers = map(printed, (row.time_us, row.per_item_ns, row.plain_us, row.plain_ratio, row.memsets))
        lines.append((row.work, *numbers, str(row.goal or ""), verdicts[row.is_met]))
    widths = [max(len(line[column]) for line in lines) for column in range(len(heads))]
    numeric = range(1, 6)
    return "\n".join(
        "  ".join(
            text.rjust(widths[column]) if column in numeric else text.ljust(widths[column])
            for column, text in enumerate(line)
        ).rstrip()
        for line in lines
    )


def write_csv(path: Path, rows: list[Row], run: dict[str, str]) -> None:
    """Write rows, each with where and when it was measured."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        figures = ("time_us", "per_item_ns", "plain_us", "plain_ratio", "memsets")
        writer.writerow((*run, "work", *figures, "goal", "is_met"))
        for row in rows:
            values = (getattr(row, figure) for figure in figures)
            numbers = ("" if value is None else f"{value:.4g}" for value in values)
            verdict = {None: "", True: "yes", False: "no"}[row.is_met]
            writer.writerow((*run.values(), row.work.strip(), *numbers, row.goal or "", verdict))


def commit() -> str:
    """Return the commit that is measured, and whether something has been changed since."""
    command = ["git", "-C", str(BENCH), "describe", "--always", "--dirty", "--exclude=*"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the built robotteamsim_bench")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--filter", default=".", help="C++ benchmarks whose name matches this")
    parser.add_argument("--csv", type=Path, help="write the table into this file too")
    options = parser.parse_args()
    figures, context = cpp_figures(options.program, options.repetitions, options.filter)
    from_python, cpu = python_rows()
    rows = cpp_rows(figures) + from_python
    run = {
        "date": datetime.date.today().isoformat(),
        "cpu": f"{cpu}, {context['num_cpus']} cores",
        "compiler": context["compiler"],
        "commit": commit(),
    }
    print(", ".join(run.values()))
    print(table(rows))
    if options.csv:
        write_csv(options.csv, rows, run)


if __name__ == "__main__":
    main()

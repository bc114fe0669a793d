"""Measure the processor time, user and system, that commands need to start, beside the interpreter alone.

All programs take turns, so that a busy machine slows them all. With --base, the commands of a former commit take turns,
too, and the ratio is printed.
Usage: python bench/start_bench.py [--rounds 15] [--base COMMIT]
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MISSION = ("run", "garage_sar", "--set", "mission.time_limit_s=0.2")
COMMANDS = {"--help": ("--help",), "--version": ("--version",), "run --help": ("run", "--help"), "run": MISSION}
GOALS = {"--help": 0.25, "--version": 0.25, "run": 0.6}
"""Of the commit before commands imported their modules on use."""


def busy_s(words: tuple[str, ...], sources: Path) -> float:
    """Return the processor time of one run of Python with the package in a folder [s]."""
    path = os.pathsep.join((str(sources), os.environ.get("PYTHONPATH", "")))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run((sys.executable, *words), check=True, env={**os.environ, "PYTHONPATH": path}, **silent)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--base", help="a commit to compare with, whose compiled module is that of today")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        sources = {"today": ROOT / "src"}
        if options.base:
            words = ("git", "-C", str(ROOT), "archive", options.base, "src", "scenarios", "maps", "templates", "msg")
            with subprocess.Popen(words, stdout=subprocess.PIPE) as made, tarfile.open(None, "r|", made.stdout) as tar:
                tar.extractall(folder)
            sources["base"] = Path(folder, "src")
        programs = {("python", "today"): ("-c", "pass")}
        programs |= {(name, when): ("-m", "robotteamsim.cli", *COMMANDS[name]) for name in COMMANDS for when in sources}
        spent_s: dict[tuple[str, str], list[float]] = {key: [] for key in programs}
        for _ in range(options.rounds + 1):  # the first round fills caches
            for key, words in programs.items():
                spent_s[key].append(busy_s(words, sources[key[1]]))
    medians = {key: statistics.median(values[1:]) for key, values in spent_s.items()}
    for name, when in programs:
        line = f"{name:<12}{when:<8}{medians[name, when]:.3f} s"
        if when == "today" and (name, "base") in medians:
            goal = f", goal {GOALS[name]:g}" if name in GOALS else ""
            line += f"  {medians[name, when] / medians[name, 'base']:.3f} of the base{goal}"
        print(line)


if __name__ == "__main__":
    main()

"""Measure the processor time, user and system, of commands on large buildings, beside that on a shipped arena.

The buildings: an office of 5,000 walls without doors and with 1,440, 5,000 walls at any angle, and an office of 8,000
walls and 2,280 doors. All commands take turns, so that a busy machine slows them all.
Usage: python bench/building_bench.py [--rounds 3] [--only PART_OF_NAME]
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
from pathlib import Path

from large_buildings import office, slanted
from start_bench import ROOT, busy_s

from robotteamsim.scenario.yaml_text import write

SHORT = ("--set", "mission.time_limit_s=1")
SMALL = "tutorial_arena"


def scenarios(folder: Path) -> list[str]:
    """Write the scenarios of large buildings; return their files."""
    plans = {
        "office_without_doors": office(1430) | {"doors": []},
        "office": office(1430),
        "slanted": slanted(5000),
        "office_of_8000_walls": office(2280),
    }
    files = []
    for name, plan in plans.items():
        folder.joinpath(f"{name}.plan.yaml").write_text(write(plan), encoding="utf-8")
        mission = {"areas": [{"name": "area", "center": [2.5, 8.0]}]}
        mission["victims"] = [{"name": "victim", "position": [2.5, 20.0]}]
        of = {"name": name, "plan": f"{name}.plan.yaml", "robots": {"count": 3, "start": [2.0, 3.0, 0.0]}}
        file = folder / f"{name}.yaml"
        file.write_text(write(of | {"mission": mission}), encoding="utf-8")
        files.append(str(file))
    return files


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="", help="measure only buildings whose name contains this")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        page = ("--html", str(Path(folder, "page.html")))
        commands = {"check": ("scenario", "check"), "run": ("run", *SHORT), "view --html": ("view", *SHORT, *page)}
        targets = [SMALL, *(file for file in scenarios(Path(folder)) if options.only in Path(file).stem)]
        spent_s: dict[tuple[str, str], list[float]] = {(target, name): [] for target in targets for name in commands}
        for _ in range(options.rounds):
            for target, name in spent_s:
                used_s = busy_s(("-m", "robotteamsim.cli", *commands[name], target), ROOT / "src")
                spent_s[target, name].append(used_s)
    medians = {key: statistics.median(values) for key, values in spent_s.items()}
    for (target, name), used_s in medians.items():
        print(f"{Path(target).stem:<22}{name:<13}{used_s:.2f} s  {used_s / medians[SMALL, name]:.1f} of {SMALL}")


if __name__ == "__main__":
    main()

"""Writes the missions of search benchmarks that are complete, one per line, for the tables of README.md.

Args: folders that `robotteamsim benchmark search --out` wrote. Cells with fewer missions than asked for are left out
and named. Printed, per cell: victims saved, time to save all (the limit where not all were), areas explored, and the
times in which the team was split and had endangered links.

python -m study.search.missions full_garage full_office --missions 30 [--csv FILE]
"""

from __future__ import annotations

import argparse
import csv
import math
from collections import defaultdict
from pathlib import Path

import numpy as np

from robotteamsim.analysis.benchmark.measures import last_saved_s
from robotteamsim.campaign import read_store
from robotteamsim.campaign.protocol import load_building

CSV = Path(__file__).with_suffix(".csv")
_CELL = ("building", "areas", "noise_db", "robots", "controller")
_NETWORK = ("split_s", "endangered_s", "breaks", "messages_lost")
_MISSION = (
    *("trial", "seed", "end", "time_s", "areas_explored", "victims_saved", "last_saved_s", *_NETWORK),
    "trajectory_hash",
)


def missions(folder: Path) -> dict[tuple[object, ...], list[tuple[object, ...]]]:
    """Return the missions of each cell of a benchmark, by the values of `_CELL`."""
    stored = read_store(folder)
    buildings = {cell[0] for cell in stored.settings["cells"]}
    limits_s = {building: load_building(building).mission.time_limit_s for building in buildings}
    cells: dict[tuple[object, ...], list[tuple[object, ...]]] = defaultdict(list)
    for outcome in stored.outcomes:
        building, *rest = stored.settings["cells"][outcome.cell]
        last_s, network = last_saved_s(outcome), outcome.network
        cells[(Path(building).stem, outcome.num_areas, *rest)].append(
            (
                outcome.number,
                outcome.seed,
                outcome.end,
                round(outcome.time_s or 0.0, 1),
                outcome.areas_explored,
                outcome.victims_saved,
                last_s if math.isfinite(last_s) else limits_s[building],
                *("" if network is None else getattr(network, name) for name in _NETWORK),
                (outcome.trajectory_hash or "")[:12],
            )
        )
    return cells


def main() -> None:
    """Write the complete cells, and print their means."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="+", metavar="DIR")
    parser.add_argument("--missions", type=int, required=True, help="of a complete cell")
    parser.add_argument("--csv", type=Path, default=CSV)
    options = parser.parse_args()
    with options.csv.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow((*_CELL, *_MISSION))
        for folder in options.folders:
            for cell, rows in missions(folder).items():
                name = ", ".join(map(str, cell))
                if len(rows) < options.missions:
                    print(f"{name}: left out: {len(rows)} of {options.missions} missions")
                    continue
                writer.writerows((*cell, *row) for row in rows)
                saved, last_s = (np.array([row[i] for row in rows], dtype=float) for i in (5, 6))
                areas, split_s, endangered_s = (np.mean([float(str(row[i])) for row in rows]) for i in (4, 7, 8))
                print(f"{name}: {saved.mean():.2f} victims, all after {last_s.mean():.0f} s, {areas:.1f} areas", end="")
                print(f", split {split_s:.1f} s, endangered {endangered_s:.0f} s")


if __name__ == "__main__":
    main()

"""Missions of a free and of a connected team that search, with equal seeds: what staying connected costs.

The victims are at random places, as in `benchmark search`. Missions are appended to the CSV as they end; those that it
has already are not run again. Printed, per cell of the CSV: mean number of victims with its 95 % interval; the
shares of missions that saved all victims, explored all areas, and were never split, with 95 % intervals [wilson1927];
the mean time, and that over the time of the free team. --bound prints how many robots a chain of likely links from a
base at the start to each area, and to all floor, needs at least.
Usage: python -m study.search.connected --missions 50 --building garage isr_floor office
"""

from __future__ import annotations

import argparse
import csv
import statistics
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import msgspec
import numpy as np

from robotteamsim.campaign.protocol import SearchProtocol, search_design
from robotteamsim.control.search.cells import cell_grid, cell_paths
from robotteamsim.control.search.connected import predicted_links
from robotteamsim.recording.network_log import NetworkLog, NetworkTotals
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation
from study.intervals import mean_with_interval

CSV = Path(__file__).with_suffix(".csv")
TEAMS = {"search": "free", "search_connected": "connected"}
KEYS = ("building", "noise_db", "robots", "team", "seed")
NUM_VICTIMS = SearchProtocol((), (), (), (), trials=1).victims
TOTALS = tuple(name for name in NetworkTotals.__struct_fields__ if not name.startswith("base"))
COLUMNS = (*KEYS, "time_s", "victims", "areas", "num_areas", *TOTALS, "trajectory_hash")


def mission(scenario: Scenario, seed: int) -> tuple[object, ...]:
    """Run a mission; return its row without the keys."""
    seeded = scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": seed})})
    log = NetworkLog()
    result = Simulation(seeded).run([log])
    totals = msgspec.structs.asdict(log.totals)
    found = (round(result.time_s, 1), result.victims_saved, result.areas_explored, result.num_areas)
    return (*found, *(totals[name] for name in TOTALS), result.trajectory_hash[:8])


def run_missing(options: argparse.Namespace) -> None:
    """Run the missions that the CSV lacks, seed by seed."""
    done = {tuple(row[key] for key in KEYS) for row in read(options.csv)}
    protocol = SearchProtocol(
        tuple(name for name, team in TEAMS.items() if team in options.teams),
        tuple(options.building),
        tuple(options.noise),
        tuple(options.robots),
        trials=1,
    )
    cells = search_design(protocol).cells
    missing: dict[tuple[str, ...], tuple[Scenario, int]] = {}
    for seed in range(options.first_seed, options.first_seed + options.missions):
        for cell in cells:
            building, noise_db, count, controller = cell.values
            key = (building, f"{noise_db:g}", str(count), TEAMS[controller], str(seed))
            if key not in done:
                missing[key] = cell.scenario, seed
    with ProcessPoolExecutor(options.workers) as pool:
        futures = {pool.submit(mission, *trial): key for key, trial in missing.items()}
        for future in as_completed(futures):
            append(options.csv, (*futures[future], *future.result()))


def read(path: Path) -> list[dict[str, str]]:
    """Return the rows of the CSV, sorted: missions are appended as they end, and intervals depend on the order."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return sorted(csv.DictReader(file), key=lambda row: [row[key] for key in KEYS])


def append(path: Path, row: Sequence[object]) -> None:
    """Append a row to the CSV, which is created with its header if there is none."""
    is_new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([COLUMNS, row] if is_new else [row])


def print_bound(building: str) -> None:
    """Print the fewest robots that connect a base at the start with a robot in each area, and with all floor.

    A robot in an area is at any place inside it. With fewer robots, the plan, the radio and the margin forbid it.
    """
    scenario = search_design(SearchProtocol(tuple(TEAMS)[1:], (building,), (30.0,), (1,), trials=1)).cells[0].scenario
    setup, grid, control = resolve(scenario), cell_grid(scenario), scenario.control.as_kind(SearchControl)
    reach_m, radio = setup.robots[0].reach_m, scenario.radio.model_dump_json()
    _, likely = predicted_links(setup.building, reach_m, grid, (), radio, scenario.network, control.link_margin_db)
    start = cell_paths(setup.building, reach_m, grid, (), None).start_of(setup.start_m(0))
    hops = np.where(likely[start], 1, 0)
    while (fresh := (hops == 0) & likely[hops > 0].any(axis=0)).any():
        hops[fresh] = hops.max() + 1
    centres_m = np.array([grid.centre_of(cell) for cell in range(grid.size)])
    print(building, "robots:", int(hops.max()), "for all floor")
    for area in scenario.mission.areas:
        inside = (np.linalg.norm(centres_m - area.center, axis=1) <= area.radius_m) & (hops > 0)
        print(f"  {area.name}: {hops[inside].min() if inside.any() else 'none suffice'}")


def wilson(count: int, of: int) -> str:
    """Return a proportion with its 95 % interval [wilson1927], in whole percent."""
    z2 = 1.96**2
    middle = (count + 0.5 * z2) / (of + z2)
    half = 1.96 / (of + z2) * (count * (of - count) / of + 0.25 * z2) ** 0.5
    return f"{count}/{of} [{100.0 * (middle - half):.0f}, {100.0 * (middle + half):.0f}] %"


def print_table(rows: list[dict[str, str]]) -> None:
    """Print a line per building, noise, number of robots and team; ratios are of missions that both teams have run."""
    print("building noise robots team: victims [95 %]; all victims; all areas; never split; time [s]; over free")
    by_key = {tuple(row[key] for key in KEYS): row for row in rows}
    for cell in sorted({tuple(row[key] for key in KEYS[:4]) for row in rows}):
        own = [row for row in rows if tuple(row[key] for key in KEYS[:4]) == cell]
        mean, low, high = mean_with_interval(np.array([float(row["victims"]) for row in own]))
        counts = (
            sum(int(row["victims"]) == NUM_VICTIMS for row in own),
            sum(row["areas"] == row["num_areas"] for row in own),
            sum(float(row["split_s"]) == 0.0 for row in own),
        )
        pairs = [(by_key.get((*cell[:3], "free", row["seed"])), row) for row in own]
        both = [(float(free["time_s"]), float(row["time_s"])) for free, row in pairs if free]
        ratio = sum(b for _, b in both) / sum(a for a, _ in both) if both else float("nan")
        time_s = statistics.fmean(float(row["time_s"]) for row in own)
        shares = "; ".join(wilson(count, len(own)) for count in counts)
        print(*cell, f"{mean:.2f} [{low:.2f}, {high:.2f}]; {shares}; {time_s:.0f}; {ratio:.2f}", sep=" ")


def main() -> None:
    """Run missions, or print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=0, help="of each cell; 0: print the table alone")
    parser.add_argument("--first-seed", type=int, default=70001)
    parser.add_argument("--building", nargs="+", default=["office"], help="as in `robotteamsim benchmark search`")
    parser.add_argument("--teams", nargs="+", default=["free", "connected"], choices=["free", "connected"])
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--noise", type=float, nargs="+", default=[10.0, 20.0, 30.0])
    parser.add_argument("--robots", type=int, nargs="+", default=[3, 5, 8])
    parser.add_argument("--csv", type=Path, default=CSV)
    parser.add_argument("--bound", action="store_true", help="print the fewest robots of a chain instead")
    options = parser.parse_args()
    if options.bound:
        for building in options.building:
            print_bound(building)
        return
    if options.missions:
        run_missing(options)
    print_table(read(options.csv))


if __name__ == "__main__":
    main()

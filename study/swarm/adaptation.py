"""Measures the effect of adapted coefficients: garage and office missions without adaptation and with both kinds.

All rows run with the same seeds, and with exclusion as printed. Printed and written, per row: means with 95 % bootstrap
intervals of time, victims, areas and endangered links, and the share of missions in which all areas were explored. In
the office, eight robots of a swarm explore four areas; the radio is weak.
Usage: python -m study.swarm.adaptation [--trials 30] [--workers 2] [--csv FILE]
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from study.swarm.additions import PRINTED_EXCLUSION, Row, mission, row_of, write_rows

FIRST_SEED = 3001
CSV = Path(__file__).with_suffix(".csv")
OFFICE = (
    "control.algorithm=rdpso",
    "robots.count=8",
    "mission.base=null",
    "mission.areas=[{name: area_1, center: [18, 15]}, {name: area_2, center: [42, 14]}, "
    "{name: area_3, center: [56, 31]}, {name: area_4, center: [12, 21]}]",
)
PLACES: dict[str, tuple[str, tuple[str, ...], float]] = {
    "garage, 20 dB": ("garage_sar", PRINTED_EXCLUSION, 20.0),
    "garage, 10 dB": ("garage_sar", PRINTED_EXCLUSION, 10.0),
    "office, 30 dB": ("office_manet", (*OFFICE, *PRINTED_EXCLUSION), 30.0),
}
"""Scenario, overrides and noise [dB]."""


def main() -> None:
    """Run all missions, print the table and write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=30)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--csv", type=Path, default=CSV)
    options = parser.parse_args()
    seeds = range(FIRST_SEED, FIRST_SEED + options.trials)
    rows: list[Row] = []
    with ProcessPoolExecutor(options.workers) as pool:
        futures = {
            (place, kind): [
                pool.submit(mission, scenario, (*overrides, f"control.adaptation={kind}"), noise_db, seed)
                for seed in seeds
            ]
            for place, (scenario, overrides, noise_db) in PLACES.items()
            for kind in ("none", "crisp", "fuzzy")
        }
        for (place, kind), trials in futures.items():
            row = row_of(f"{place}, {kind}", PLACES[place][2], [trial.result() for trial in trials])
            rows.append(row)
            print(row, flush=True)
    write_rows(options.csv, rows)


if __name__ == "__main__":
    main()

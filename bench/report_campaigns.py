"""Run the five campaigns of docs/report, judge each and all together, and write the report: `make report`.

The seeds are the first nine digits of pi, e, and the square roots of 2, 3 and 5. None was used to choose a parameter.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

from robotteamsim.cli import main

SEEDS = (314159265, 271828182, 141421356, 173205080, 223606797)
NOISES_DB = (10, 20, 30)
TRIALS = 100


def run() -> int:
    """Run campaigns and report. Returns: an exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, default=Path("build/report"), help="of the campaigns; %(default)s")
    parser.add_argument("--out", type=Path, default=Path("docs/report"), help="of the report; %(default)s")
    parser.add_argument("--resume", action="store_true", help="keep finished missions: only if no code has changed")
    options = parser.parse_args()
    if not options.resume:
        shutil.rmtree(options.folder, ignore_errors=True)
    folders = [options.folder / f"seed_{seed}" for seed in SEEDS]
    noise = [word for noise_db in NOISES_DB for word in ("--noise", str(noise_db))]
    for seed, folder in zip(SEEDS, folders, strict=True):
        command = ["campaign", "garage_sar", *noise, "--trials", str(TRIALS), "--seed", str(seed), "--quiet"]
        print(f"-- {TRIALS} trials per level, seed {seed}", flush=True)
        if status := main([*command, "--out", str(folder)]):
            return status
    return main(["report", *map(str, folders), "--out", str(options.out)])


if __name__ == "__main__":
    sys.exit(run())

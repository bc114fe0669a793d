"""Search for the cause of the missing spread at 30 dB: durations of garage missions under changed settings.

python -m study.dissertation.spread_causes --missions 40 --noise 30
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
from collections.abc import Callable

import numpy as np

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

FIRST_SEED = 5_000_000
_Draw = Callable[[np.random.Generator], list[str]]


def _poses(rng: np.random.Generator) -> list[str]:
    poses = [
        [round(4.0 + rng.uniform(-0.5, 0.5), 3), round(5.0 + 1.3 * row + rng.uniform(-0.5, 0.5), 3), rng.uniform(-3, 3)]
        for row in (-1, 0, 1)
    ]
    return [f"robots.start_poses={poses}"]


def _speed(rng: np.random.Generator) -> list[str]:
    factor = rng.normal(1.0, 0.05)
    return [f"control.max_step_speed_mps={0.58 * factor}", f"robots.drive.max_speed_mps={0.7 * factor}"]


def _iteration(rng: np.random.Generator) -> list[str]:
    return [f"control.iteration_s={round(rng.uniform(0.75, 1.25), 1)}"]


CHANGES: dict[str, list[str] | _Draw] = {
    "none": [],
    "start poses drawn": _poses,
    "laser noise": ["robots.laser.noise_m=0.03"],
    "speed limit drawn": _speed,
    "exclusion after 2 iterations": ["control.exclusion.search_counter_max=2"],
    "straight navigation": ["control.navigation=straight"],
    "alpha 0.6": ["control.alpha=0.6"],
    "c3 1.2": ["control.c3=1.2"],
    "local-best radius 3 m": ["voice.local_best_radius_m=3"],
    "sensing radius 1.5 m": ["control.sensing_radius_m=1.5"],
    "sensing radius 2 m": ["control.sensing_radius_m=2"],
    "iteration drawn": _iteration,
    "odometry": ["control.localisation=odometry"],
}


def _mission(task: tuple[str, float, int]) -> tuple[float, int]:
    """Return the time, 600 s for a mission that was cut short, and the number of victims saved."""
    name, noise_db, seed = task
    change = CHANGES[name]
    settings = change(np.random.default_rng(seed)) if callable(change) else change
    result = Simulation(load("garage_sar", [*settings, f"voice.noise_db={noise_db}", f"run.seed={seed}"])).run()
    return (result.time_s if result.end == "areas_explored" else 600.0), result.victims_saved


def main() -> None:
    """Print a line per change."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--missions", type=int, default=40, help="at least 2; default %(default)s")
    parser.add_argument("--noise", type=float, default=30.0, help="background noise [dB]; default %(default)s")
    options = parser.parse_args()
    print(f"{'change':30} {'mean [s]':>9} {'SD [s]':>7} {'victims':>8} {'more than two':>14}")
    with multiprocessing.Pool() as pool:
        for name in CHANGES:
            tasks = [(name, options.noise, FIRST_SEED + index) for index in range(options.missions)]
            times_s, saved = zip(*pool.map(_mission, tasks, chunksize=4), strict=True)
            share = sum(count > 2 for count in saved) / options.missions
            mean_s, sd_s = statistics.fmean(times_s), statistics.stdev(times_s)
            print(f"{name:30} {mean_s:9.1f} {sd_s:7.1f} {statistics.fmean(saved):8.2f} {share:14.0%}", flush=True)


if __name__ == "__main__":
    main()

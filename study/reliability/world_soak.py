"""Whether memory stays flat while 100 robots with lasers drive for a long time.

Usage: python -m study.reliability.world_soak [--robots 100] [--minutes 60]
Prints the resident memory once a minute; ends with status 1 if it grew by more than 1 MB after the first tenth.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from bench.world_bench import REDRAW_STEPS, RUN, free_robots, plan_of_rectangles, random_twists
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

MAX_GROWTH_MB = 1.0


def resident_mb() -> float:
    """Return how much memory this process holds."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    line = next(line for line in status.splitlines() if line.startswith("VmRSS:"))
    return int(line.split()[1]) * 1024e-6


def main() -> None:
    """Drive, and print the memory."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--minutes", type=float, default=60.0)
    options = parser.parse_args()
    generator = np.random.default_rng(1)
    plan = plan_of_rectangles(np.random.default_rng(7))
    robots = free_robots(plan, options.robots, generator)
    world = World(plan, robots, RUN)
    sensors = RobotSensors(world, robots, 1)
    start_s, told_min, settled_mb = time.monotonic(), -1, None
    while (passed_min := (time.monotonic() - start_s) / 60.0) < options.minutes:
        twists = random_twists(options.robots, generator)
        for _ in range(REDRAW_STEPS):
            world.step(twists)
            sensors.read()
        if settled_mb is None and passed_min > 0.1 * options.minutes:
            settled_mb = resident_mb()
        if int(passed_min) > told_min:
            told_min = int(passed_min)
            print(f"{told_min:4d} min  {world.sim_time_ns * 1e-9:9.0f} s simulated  {resident_mb():.1f} MB", flush=True)
    growth_mb = resident_mb() - (settled_mb or resident_mb())
    print(f"grew by {growth_mb:.2f} MB after the first tenth of {options.minutes:g} min")
    sys.exit(growth_mb > MAX_GROWTH_MB)


if __name__ == "__main__":
    main()

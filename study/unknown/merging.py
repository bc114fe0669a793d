"""Whether robots that are not told where they start find their place in the map of their team, and the right one.

Robots explore with `control.mapping.starts: unknown`, until all know their place or the time is over. Prints a line per
mission and a summary. A merge is wrong if the error of the robot's pose is above 0.5 m or 3 degrees.
Usage: python -m study.unknown.merging SCENARIO [--missions 20] [--first-seed 40001] [--seconds 300] [--set KEY=VALUE]
"""

from __future__ import annotations

import argparse
import math
from typing import NamedTuple

import numpy as np

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

WRONG_M, WRONG_DEG = 0.5, 3.0


class Merge(NamedTuple):
    """When a robot found its place, and how wrong it was."""

    time_s: float
    error_m: float
    error_deg: float

    @property
    def is_wrong(self) -> bool:
        """Whether it is not its place."""
        return self.error_m > WRONG_M or self.error_deg > WRONG_DEG


def main() -> None:
    """Run the missions and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario")
    parser.add_argument("--missions", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=40001)
    parser.add_argument("--seconds", type=float, default=300.0)
    parser.add_argument("--set", action="append", default=[])
    options = parser.parse_args()
    merges: list[Merge] = []
    searching = 0
    for seed in range(options.first_seed, options.first_seed + options.missions):
        settings = ["control.mapping.starts=unknown", *options.set, f"run.seed={seed}"]
        simulation = Simulation(load(options.scenario, settings))
        found = mission(simulation, options.seconds)
        asked = [i for i in simulation.scenario.searcher_ids if not simulation.setup.knows_start(i)]
        merges += found.values()
        searching += len(asked)
        said = (f"robot_{i} {m.time_s:.0f} s {m.error_m:.3f} m {m.error_deg:.2f} deg" for i, m in found.items())
        wrong = sum(merge.is_wrong for merge in found.values())
        print(
            f"{seed}: {len(found)} of {len(asked)}{f', {wrong} WRONG' if wrong else ''}; {', '.join(said)}", flush=True
        )
    print(f"{searching} robots; {len(merges)} found their place, {sum(merge.is_wrong for merge in merges)} a wrong one")
    if merges:
        for name, values in zip(("time [s]", "error [m]", "error [deg]"), np.array(merges).T, strict=True):
            middle, high, most = np.percentile(values, (50, 95, 100))
            print(f"  {name:11} median {middle:.3g}, 95 % {high:.3g}, most {most:.3g}")


def mission(simulation: Simulation, seconds: float) -> dict[int, Merge]:
    """Run one mission until all know their place, and return when each found it."""
    found: dict[int, Merge] = {}
    asked = {i for i in simulation.scenario.searcher_ids if not simulation.setup.knows_start(i)}
    simulation.mission.start()
    for _ in range(round(seconds / simulation.scenario.run.step_s)):
        record = simulation.step()
        for i in asked - found.keys():
            believed = record.decisions[i].localisation
            if believed is not None and believed.state == "tracking":
                apart = record.readings[i].true_pose.inverse() @ believed.pose
                error_deg = abs(math.degrees(apart.yaw_rad))
                found[i] = Merge(record.sim_time_s, math.hypot(apart.x_m, apart.y_m), error_deg)
        if len(found) == len(asked) or record.mission.state not in ("waiting", "running"):
            break
    return found


if __name__ == "__main__":
    main()

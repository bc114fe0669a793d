"""How robots that do not know their building do in whole missions: areas, victims, maps, poses and messages.

Prints a line per mission, and a summary. Usage: python -m study.unknown.missions SCENARIO [--missions 20]
[--first-seed 30001] [--set KEY=VALUE]
"""

from __future__ import annotations

import argparse
import math

import numpy as np

from robotteamsim.recording.exploration import ExplorationLog
from robotteamsim.scenario import load
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result, Simulation, StepRecord
from study.unknown.localisation import WRONG_M


class Believed(Observer):
    """An observer that compares the believed poses with the true ones.

    errors_m: of each robot in each step.
    lost, wrong: robots' steps in which a robot says that it does not know its pose, or is wrong without saying so.
    """

    def begin(self, setup: Setup) -> None:
        """Discard an earlier mission."""
        self.errors_m: list[float] = []
        self.lost = self.wrong = 0

    def step(self, record: StepRecord) -> None:
        """Process one step."""
        for reading, decision in zip(record.readings, record.decisions, strict=True):
            if decision.localisation is None:
                continue
            apart = reading.true_pose.inverse() @ decision.localisation.pose
            self.errors_m.append(math.hypot(apart.x_m, apart.y_m))
            is_tracking = decision.localisation.state == "tracking"
            self.lost += not is_tracking
            self.wrong += is_tracking and self.errors_m[-1] > WRONG_M

    def end(self, result: Result) -> None:
        """Nothing is left to do."""


def main() -> None:
    """Run the missions and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario")
    parser.add_argument("--missions", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=30001)
    parser.add_argument("--set", action="append", default=[])
    options = parser.parse_args()
    rows, errors_m, lost, wrong = [], [], 0, 0
    for seed in range(options.first_seed, options.first_seed + options.missions):
        simulation = Simulation(load(options.scenario, [*options.set, f"run.seed={seed}"]))
        explored, believed = ExplorationLog(simulation), Believed()
        result = simulation.run([explored, believed])
        found = explored.exploration
        assert found is not None
        values = result.areas_explored, result.victims_saved, result.time_s, found.right, found.bytes_per_s
        rows.append((*values, max(believed.errors_m)))
        errors_m += believed.errors_m
        lost, wrong = lost + (believed.lost > 0), wrong + (believed.wrong > 0)
        print(f"{seed}: {found}; {' '.join(f'{value:g}' for value in rows[-1])}", flush=True)
    table = np.array(rows)
    print("areas, victims, time [s], walls within 10 cm, bytes per robot and s, largest error of a pose [m]:")
    for name, values in (("mean", table.mean(axis=0)), ("least", table.min(axis=0)), ("most", table.max(axis=0))):
        print(f"  {name:5} {' '.join(f'{value:10.4g}' for value in values)}")
    print(f"median error of a pose {np.median(errors_m):.3f} m, 95 % {np.percentile(errors_m, 95):.3f} m")
    print(f"missions with a robot that was lost: {lost}; with one that was wrong: {wrong}")


if __name__ == "__main__":
    main()

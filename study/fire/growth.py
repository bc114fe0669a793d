"""Heat release rate of fires on grids of several sizes: in a hall, in the open, next to a wall and in a corner, and in
garage_rescue; from few cells on, second by second.

`python -m study.fire.growth > study/fire/growth.csv`
"""

from __future__ import annotations

import csv
import math
import sys

from robotteamsim.hazards import Hazards
from robotteamsim.scenario import from_mapping, load
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.scenario import Scenario

ULTRA_FAST_KW_S2 = 0.1876
SEEDS = range(9000, 9020)
HALL: dict[str, object] = {"name": "hall", "bounds": {"max": [40, 40]}}
PLACES = {"hall": [20.1, 20.1], "wall": [20.1, 0.1], "corner": [0.1, 0.1]}
CARPET = {
    "name": "carpet",
    "polygon": [[0, 0], [40, 0], [40, 40], [0, 40]],
    "growth": "ultra_fast",
    "load_mj_m2": 5000,
}


class _Doors:
    version = 0

    def closed(self) -> dict[str, bool]:
        return {}


def heat_mw(scenario: Scenario, times_s: list[int]) -> list[float]:
    """Return the heat release rate of a fire at some times, ascending, with all doors as at the start [MW]."""
    hazards, found = Hazards(scenario, Building(scenario.plan)), []
    step_ns, step = scenario.run.step_ns, 0
    for time_s in times_s:
        while step * step_ns < time_s * 10**9 + step_ns:
            step += 1
            hazards.step(step * step_ns, _Doors())
        found.append(hazards.heat_release_kw / 1e3)
    return found


def in_hall(place: str, cell_m: float, growth_sd: float, seed: int) -> Scenario:
    """Return a hall of 40 x 40 m with one fuel and a fire in one of PLACES."""
    fire = {"fuel": [CARPET], "ignitions": [{"position": PLACES[place]}], "cell_m": cell_m, "growth_sd": growth_sd}
    run = {"seed": seed, "step_s": 1.0, "physics_substeps": 20}
    robots = [{"start_pose": [1.0, 1.0, 0.0]}]
    return from_mapping({"name": "hall", "plan": HALL, "robots": robots, "fire": fire, "run": run}, "hall")


def main() -> None:
    """Print one row for each fire and time."""
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(["place", "cell_m", "growth_sd", "seed", "time_s", "heat_mw"])
    times_s = [round(math.sqrt(megawatts * 1e3 / ULTRA_FAST_KW_S2)) for megawatts in (12, 25, 50)]
    for cell_m in (0.25, 0.5, 1.0):
        for growth_sd, seeds in ((0.0, SEEDS[:1]), (0.2, SEEDS)):
            for seed in seeds:
                for place in PLACES:
                    found_mw = heat_mw(in_hall(place, cell_m, growth_sd, seed), times_s)
                    for time_s, megawatts in zip(times_s, found_mw, strict=True):
                        rows.writerow([place, cell_m, growth_sd, seed, time_s, f"{megawatts:.3f}"])
                garage = load("garage_rescue", [f"fire.{k}" for k in (f"cell_m={cell_m}", f"growth_sd={growth_sd}")])
                garage = garage.model_copy(update={"run": garage.run.model_copy(update={"seed": seed})})
                rows.writerow(["garage_rescue", cell_m, growth_sd, seed, 300, f"{heat_mw(garage, [300])[0]:.3f}"])
    # Deviation depends on how many cells burn, not on their size.
    times_s = list(range(1, 361))
    for time_s, megawatts in zip(times_s, heat_mw(in_hall("hall", 1.0, 0.0, SEEDS[0]), times_s), strict=True):
        rows.writerow(["hall", 1.0, 0.0, SEEDS[0], time_s, f"{megawatts:.6f}"])


if __name__ == "__main__":
    main()

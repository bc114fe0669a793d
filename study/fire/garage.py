"""Missions of `garage_fire` by RDPSO and `search`, and by `search` when it begins 400 s after the fire.

`nice python -m study.fire.garage > study/fire/garage.csv`
"""

from __future__ import annotations

import csv
import sys
from collections import Counter

from robotteamsim.mission.events import AreaPassedOver
from robotteamsim.mission.team_events import RobotFailedByHeat
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

FIRST_SEED = 74001
TEAMS = (("rdpso", 0, 40), ("search", 0, 20), ("search", 400, 20))
"""Algorithm, when it begins after the fire [s], and number of missions."""
COLUMNS = (
    *("algorithm", "begins_s", "seed", "end", "time_s", "areas_explored", "areas_passed_over"),
    *("victims_saved", "victims_dead", "robots_failed"),
)


def mission(algorithm: str, begins_s: int, seed: int) -> tuple[object, ...]:
    """Run one mission; return its row without the first three columns."""
    scenario = load("garage_fire", [f"control.algorithm={algorithm}", f"run.seed={seed}", "mission.autostart=false"])
    simulation = Simulation(scenario)
    while simulation.world.sim_time_ns < begins_s * 10**9:
        simulation.step()
    simulation.mission.start()
    happened: Counter[type] = Counter()
    while simulation.mission.status.state != "ended":
        happened.update(type(event.what) for event in simulation.step().events)
    status = simulation.mission.status
    found = (status.end, round(status.time_s, 1), status.areas_explored, happened[AreaPassedOver])
    return (*found, status.victims_saved, status.victims.count("dead"), happened[RobotFailedByHeat])


def main() -> None:
    """Print one row per mission."""
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(COLUMNS)
    for algorithm, begins_s, count in TEAMS:
        for seed in range(FIRST_SEED, FIRST_SEED + count):
            rows.writerow([algorithm, begins_s, seed, *mission(algorithm, begins_s, seed)])
            sys.stdout.flush()


if __name__ == "__main__":
    main()

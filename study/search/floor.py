"""How far a team that searches is from the least time that its mission can take, by number of robots.

The bound is the clairvoyant team of docs/benchmark.md with the areas in their order: it knows the victims, ends with
the last area, and drives at most at `max_step_speed_mps`. Printed per number of robots: the mean time with a 95 %
interval, the time of one robot divided by the number, the bound, and when each area was explored and the last victim
saved.

python -m study.search.floor --missions 20 --noise 30 --robots 1 2 3 4 6 8 --seed 5001
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import statistics
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.benchmark.bound import CONTACT_M, OptimisticFloor
from robotteamsim.analysis.benchmark.routes import longest_route
from robotteamsim.mission.events import Event
from robotteamsim.scenario import load
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

TIME_LIMIT_S = 1200.0
"""One robot needs longer than the scenario allows."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The times of one mission [s]; `saved_s` has one per saved victim."""

    end_s: float
    explored_s: tuple[float, ...]
    saved_s: tuple[float, ...]


def scenario_of(robots: int, noise_db: float, seed: int) -> Scenario:
    """Return a garage mission of a team that searches."""
    overrides = (
        "control.algorithm=search",
        f"robots.count={robots}",
        f"voice.noise_db={noise_db}",
        f"mission.time_limit_s={TIME_LIMIT_S}",
        f"run.seed={seed}",
    )
    return load("garage_sar", list(overrides))


def least_time_s(scenario: Scenario) -> float:
    """Return a lower bound on the time in which a team can save all victims and explore all areas in their order.

    Assign each victim and each area to the robot that saves or explores it, and order the goals of each robot by time.
    No route has an earlier area after a later one, or anything after the last area, with which the mission ends.
    Routes are bounded as in docs/benchmark.md. Allowing an earlier area after a victim who comes after a later area, as
    here, only makes the bound smaller.
    """
    setup = resolve(scenario)
    mission, robots = scenario.mission, setup.robots
    floor = OptimisticFloor(setup.building, min(robot.radius_m for robot in robots) - CONTACT_M)
    starts_m = [robot.start_pose[:2] for robot in robots]
    victims_m, areas_m = [victim.position for victim in mission.victims], [area.center for area in mission.areas]
    radii_m = np.array([area.radius_m for area in mission.areas] + [mission.save_distance_m] * len(victims_m))
    num_areas = len(areas_m)
    from_starts, legs = floor.lengths_m(starts_m, areas_m + victims_m, float(radii_m.max()))
    to_victims, between_victims = floor.lengths_m(starts_m, victims_m, mission.save_distance_m)
    from_starts[:, num_areas:] = np.maximum(from_starts[:, num_areas:], to_victims)
    legs[num_areas:, num_areas:] = np.maximum(legs[num_areas:, num_areas:], between_victims)
    goals_m = np.array(areas_m + victims_m)
    apart_m = np.linalg.norm(goals_m[:, None] - goals_m, axis=2) - radii_m[:, None] - radii_m
    legs = np.maximum(legs, apart_m)
    legs[np.tril_indices(num_areas, -1)] = math.inf
    legs[num_areas - 1] = math.inf
    speed_mps = min(scenario.control.max_step_speed_mps, max(robot.drive.max_speed_mps for robot in robots))
    # Routes may be too short, because they jump within the discs of the goals: the farthest goal is a bound as well.
    farthest_m = float(from_starts.min(axis=0).max())
    return max(longest_route(from_starts, legs), farthest_m) / speed_mps


def _mission(task: tuple[int, float, int]) -> Outcome:
    simulation = Simulation(scenario_of(*task))
    events: list[Event] = []
    simulation.mission.start()
    while simulation.mission.status.state != "ended":
        events += simulation.step().events
    explored_s = tuple(event.time_s for event in events if event.kind == "area_explored")
    saved_s = tuple(event.time_s for event in events if event.kind == "victim_saved")
    return Outcome(events[-1].time_s, explored_s, saved_s)


def _line(robots: int, outcomes: list[Outcome], one_s: float, bound_s: float) -> str:
    times_s = [outcome.end_s for outcome in outcomes]
    mean_s = statistics.fmean(times_s)
    half_s = 1.96 * statistics.stdev(times_s) / math.sqrt(len(times_s))
    complete = [outcome.explored_s for outcome in outcomes]
    num_areas = min(map(len, complete))
    explored = " ".join(f"{statistics.fmean(times[i] for times in complete):6.1f}" for i in range(num_areas))
    last_s = statistics.fmean(max(outcome.saved_s, default=math.nan) for outcome in outcomes)
    saved = statistics.fmean(len(outcome.saved_s) for outcome in outcomes)
    times = f"{robots:6d} {mean_s:7.1f} +-{half_s:5.1f} {one_s / robots:8.1f} {bound_s:7.1f} {mean_s / bound_s:5.2f}"
    return f"{times} {saved:5.2f} {last_s:7.1f}   {explored}"


def main() -> None:
    """Print a line per number of robots."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=20, help="at least 2; default %(default)s")
    parser.add_argument("--noise", type=float, default=30.0, help="background noise [dB]; default %(default)s")
    parser.add_argument("--robots", type=int, nargs="+", default=[1, 2, 3, 4, 6, 8], help="default 1 2 3 4 6 8")
    parser.add_argument("--seed", type=int, default=5001, help="of the first mission; default %(default)s")
    options = parser.parse_args()
    if options.missions < 2:
        parser.error(f"--missions: {options.missions} is below 2")
    print("robots time [s]         one / n   bound ratio saved last[s]   areas explored [s]")
    with multiprocessing.Pool() as pool:
        one_s = math.nan
        for robots in options.robots:
            tasks = [(robots, options.noise, options.seed + index) for index in range(options.missions)]
            outcomes = pool.map(_mission, tasks, chunksize=1)
            if robots == 1:
                one_s = statistics.fmean(outcome.end_s for outcome in outcomes)
            print(_line(robots, outcomes, one_s, least_time_s(scenario_of(*tasks[0]))), flush=True)


if __name__ == "__main__":
    main()

"""The measures of the tasks of learning for scripted controllers, or for a learned policy (module:Class).

Each controller drives the task's scenario with the same seeds. Written: a row per mission with its return, the mean of
the agents' summed rewards, and what the mission reports. Printed: means with 95 % bootstrap intervals.
Usage: python -m study.learning.tasks [--task explore] [--controller my_policy:Policy] [--trials 10] [--out FILE.csv]
"""

from __future__ import annotations

import argparse
import csv
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from robotteamsim.analysis.report.statistics import bootstrap_mean, generator
from robotteamsim.campaign.protocol import control_of
from robotteamsim.learning import TASKS, task
from robotteamsim.learning.observe import area_of
from robotteamsim.learning.reward import Reward, Steps
from robotteamsim.recording.exploration import ExplorationLog, found_maps
from robotteamsim.recording.idleness import IdlenessLog
from robotteamsim.recording.measures import Measures
from robotteamsim.recording.network_log import NetworkLog
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Simulation, StepRecord

BASELINES = {
    "garage_search": ("search", "rdpso", "greedy", "cover", "random_walk"),
    "floor_search": ("search", "rdpso", "greedy", "cover", "random_walk"),
    "explore": ("cover", "boustrophedon", "search", "random_walk"),
    "explore_unknown": ("frontier", "study.learning.follow_frontier:FollowFrontier", "random_walk"),
    "connected_coverage": ("cover_connected", "cover", "search_connected", "random_walk"),
    "patrol": ("sebs", "conscientious_reactive", "random_walk"),
    "rescue": ("search", "rdpso", "random_walk"),
}
QUANTITIES = ("return", "saved", "dead", "dose", "areas", "end_s", "covered", "known", "t90_s", "split_s", "idle_s")

Row = dict[str, str | float]


class Return(Observer):
    """Adds up the rewards of a mission."""

    def __init__(self, reward: type[Reward], simulation: Simulation) -> None:
        self._make, self._simulation, self.total = reward, simulation, 0.0

    def begin(self, setup: Setup) -> None:
        """Begin with nothing."""
        self._reward, self.total = self._make(setup, setup.scenario.searcher_ids), 0.0
        self._reward.begin(0, replace(setup, found=dict(enumerate(found_maps(self._simulation)))))

    def step(self, record: StepRecord) -> None:
        """Add the mean reward of the agents."""
        ids, status, state = self._reward.robot_ids, record.mission, record.state
        of_robots = record.present[ids], state.contact[ids], np.nan_to_num(state.positions_m[ids])
        parts = *of_robots, status.areas_explored, status.victims_saved, area_of(status.task)
        steps = Steps(lambda _: record, np.array([0]), *(np.array([part]) for part in parts))
        self.total += float(self._reward.of_step(steps).mean())


def run_trial(name: str, controller: str, seed: int) -> Row:
    """Return what a mission has led to."""
    of = task(name, overrides=[f"run.seed={seed}"])
    control = control_of(controller, {"map": of["scenario"].control.map})
    simulation = Simulation(of["scenario"].model_copy(update={"control": control}))
    won, exploration = Return(of["reward"], simulation), ExplorationLog(simulation)
    measures, network, idleness = Measures(), NetworkLog(), IdlenessLog()
    own: dict[str, list[Observer]] = {"patrol": [idleness], "explore_unknown": [exploration]}
    result = simulation.run([measures, network, won, *own.get(name, [])])
    measured, explored = measures.measured, exploration.exploration
    return {
        "task": name,
        "controller": controller,
        "seed": seed,
        "return": round(won.total, 3),
        "saved": result.victims_saved,
        "dead": result.victims_dead,
        "dose": round(sum(p.dose for p in result.egress.people), 3) if result.egress else "",
        "areas": result.areas_explored,
        "end_s": result.time_s,
        "covered": "" if measured.coverage is None else measured.coverage,
        "known": "" if explored is None else explored.known,
        "t90_s": "" if explored is None or explored.t90_s is None else explored.t90_s,
        "split_s": network.totals.split_s,
        "idle_s": "" if idleness.idleness is None else round(idleness.idleness.mean_s, 2),
        "hash": result.trajectory_hash[:12],
    }


def print_means(rows: list[Row]) -> None:
    """Print the mean of each quantity that a controller's missions have."""
    for name, controller in dict.fromkeys((str(row["task"]), str(row["controller"])) for row in rows):
        own = [row for row in rows if (row["task"], row["controller"]) == (name, controller)]
        cells = []
        for quantity in QUANTITIES:
            values = np.array([float(row[quantity]) for row in own if row[quantity] != ""])
            if values.size:
                mean = bootstrap_mean(values, generator(name, controller, quantity))
                cells.append(f"{quantity} {mean.value:.4g} [{mean.low:.4g}, {mean.high:.4g}]")
        print(f"{name}, {controller}: {len(own)} missions: {'; '.join(cells)}")


def main() -> None:
    """Run the missions."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", action="append", choices=TASKS, help="repeatable; default: all")
    parser.add_argument("--controller", action="append", help="in place of the baselines; repeatable")
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(".csv"))
    options = parser.parse_args()
    with ProcessPoolExecutor(options.workers) as pool:
        futures = [
            pool.submit(run_trial, name, controller, seed)
            for seed in range(1, options.trials + 1)
            for name in options.task or TASKS
            for controller in options.controller or BASELINES[name]
        ]
        rows = []
        with options.out.open("w", newline="") as file:
            writer = csv.DictWriter(file, ("task", "controller", "seed", *QUANTITIES, "hash"), lineterminator="\n")
            writer.writeheader()
            for future in futures:
                rows.append(future.result())
                writer.writerow(rows[-1])
                file.flush()
    print_means(rows)


if __name__ == "__main__":
    main()

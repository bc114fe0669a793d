"""Garage missions in Box2D and in Gazebo with the same seeds: outcome, speed, and processor time.

Gazebo follows the clock of gazebo_clock.py, which waits for the decisions of each step, so that outcomes do not depend
on the load of the machine. `speed` is simulated over wall time, and depends on it; `*_busy` is the processor time of
Gazebo and of the simulation with its controllers, per simulated second. `make bench_gazebo` builds what this needs.
Usage: python -m study.worlds.gazebo_missions [--first 44001] [--trials 30] [--chroot DIR] [--csv FILE] [--table]
appends a row per mission, and prints the table of all rows; --table: only that.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np

from bench.results_file import append_rows
from bench.ros_processes import GRACE_S, ROSLAUNCH, environment
from robotteamsim.analysis.report.statistics import Interval, bootstrap_mean, clopper_pearson, generator
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation
from robotteamsim.simulation.record import Result
from study.worlds.mujoco_missions import OUTCOME, outcome

ROOT = Path(__file__).resolve().parents[2]
PLUGINS = ROOT / "build" / "gazebo" / "devel" / "lib"
COST = ("speed", "gazebo_busy", "simulation_busy")
MISSION_S = 3600.0
"""Longest duration of a mission [s, wall]."""


def box2d_mission(seed: int) -> tuple[object, ...]:
    """Return the row of a headless mission."""
    result = Simulation(load("garage_sar", [f"run.seed={seed}"])).run([])
    return (*outcome("box2d", seed, result), *(math.nan for _ in COST))


def gazebo_mission(seed: int, chroot: str) -> tuple[object, ...]:
    """Return the row of a mission in Gazebo. Args: chroot: folder that has Gazebo; "": this machine has it."""
    with tempfile.TemporaryDirectory() as folder:
        port, env = environment(folder)
        gazebo_port, _ = environment(folder)
        env |= {"GAZEBO_MASTER_URI": f"http://localhost:{gazebo_port}", "GAZEBO_IP": "127.0.0.1"}
        gzserver = f"{ROOT}/setup/gazebo-chroot.sh run {chroot} gzserver" if chroot else "gzserver"
        robots = " ".join(map(str, range(load("garage_sar").num_robots)))
        arguments = [f"in_gazebo:={robots}", "localization:=ground_truth", "controllers:=inside", "rviz:=false"]
        arguments += (f"seed:={seed}", f"out:={folder}/out", f"gzserver:={gzserver}", f"plugins:={PLUGINS}")
        launch = (*ROSLAUNCH, "-p", str(port), "robotteamsim", "scenario.launch", "world:=gazebo", *arguments)
        cost_file, log_file = Path(folder, "cost.json"), Path(folder, "log.txt")
        clock = (sys.executable, "-m", "study.worlds.gazebo_clock", str(cost_file))
        with (
            log_file.open("w") as log,
            subprocess.Popen(launch, env=env, cwd=folder, stdout=log, stderr=log) as mission,
            subprocess.Popen(clock, env=env, cwd=ROOT, stdout=log, stderr=log) as clocking,
        ):
            try:
                if clocking.wait(MISSION_S) == 0:
                    mission.wait(GRACE_S)
            finally:
                for process in (clocking, mission):
                    process.send_signal(signal.SIGINT)
                for process in (clocking, mission):
                    process.wait(GRACE_S)
        if mission.returncode or not cost_file.exists():
            raise RuntimeError(f"seed {seed}: status {mission.returncode}\n{log_file.read_text()}")
        result = msgspec.convert(json.loads(Path(folder, "out", "mission.json").read_text())["result"], Result)
        costs = json.loads(cost_file.read_text())
        return (*outcome("gazebo", seed, result), *(f"{costs[name]:.4g}" for name in COST))


def print_table(path: Path) -> None:
    """Print outcomes with 95 % intervals: exact ones of shares, bootstrap ones of means."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    worlds = {name: {row["seed"]: row for row in rows if row["world"] == name} for name in ("box2d", "gazebo")}
    seeds = [seed for seed in worlds["box2d"] if seed in worlds["gazebo"]]

    def values(world: str, column: str) -> np.ndarray:
        return np.array([float(worlds[world][seed][column]) for seed in seeds])

    for world in worlds:
        explored = [worlds[world][seed]["end"] == "areas_explored" for seed in seeds]
        share = clopper_pearson(sum(explored), len(seeds))
        print(f"{world}: {len(seeds)} missions, all areas {sum(explored)} ({share.low:.3f} to {share.high:.3f})")
        for column in ("areas", "victims", "time_s", "distance_m", "contact_s"):
            print(f"  {column} {_text(bootstrap_mean(values(world, column), generator('gazebo', world, column)))}")
    for column in ("victims", "time_s"):
        differences = values("gazebo", column) - values("box2d", column)
        print(f"gazebo - box2d: {column} {_text(bootstrap_mean(differences, generator('gazebo', 'pairs', column)))}")
    for column in COST:
        low, median, high = np.percentile(values("gazebo", column), (0, 50, 100))
        print(f"gazebo: {column} {median:.3g}, {low:.3g} to {high:.3g}")


def _text(interval: Interval) -> str:
    return f"{interval.value:.2f} ({interval.low:.2f} to {interval.high:.2f})"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the missions, print and record them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=44001, help="the first seed")
    parser.add_argument("--trials", type=int, default=30, help="number of seeds")
    parser.add_argument("--chroot", default=os.environ.get("GAZEBO_CHROOT", ""), help="folder that has Gazebo")
    parser.add_argument("--csv", type=Path, default=Path(__file__).with_suffix(".csv"))
    parser.add_argument("--table", action="store_true", help="run nothing")
    options = parser.parse_args(arguments)
    for seed in range(options.first, options.first + (0 if options.table else options.trials)):
        for row in (box2d_mission(seed), gazebo_mission(seed, options.chroot)):
            print(*row, flush=True)
            append_rows(options.csv, ("world", "seed", *OUTCOME, *COST), [row])
    print_table(options.csv)


if __name__ == "__main__":
    main()

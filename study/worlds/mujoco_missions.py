"""Garage missions in Box2D and in MuJoCo with the same seeds: outcome, slip of the tyres, lean.

Slip forward is the distance by which the tyres rolled farther than the robots drove, slip to the side the distance that
they moved across their rolling direction, both as shares of the distance; sampled once per step.
Usage: python -m study.worlds.mujoco_missions [--first 1] [--trials 30] [--csv FILE]       appends a row per mission
"""

from __future__ import annotations

import argparse
import math
import statistics
from pathlib import Path

import numpy as np

from bench.results_file import append_rows
from robotteamsim.scenario import load
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.simulation.record import Result
from robotteamsim.world.mujoco.wheels import Chassis
from robotteamsim.world.mujoco.world import MujocoWorld

OUTCOME = ("end", "time_s", "areas", "victims", "distance_m", "contact_s")
COLUMNS = ("world", "seed", *OUTCOME, "slip_forward", "slip_side", "mean_lean_mrad", "max_lean_mrad")


def outcome(world: str, seed: int, result: Result) -> tuple[object, ...]:
    """Return world, seed and OUTCOME of a mission."""
    distance_m = sum(robot.distance_m for robot in result.robots)
    contact_s = sum(robot.contact_s for robot in result.robots)
    totals = (result.end, result.time_s, result.areas_explored, result.victims_saved)
    return (world, seed, *totals, f"{distance_m:.4g}", f"{contact_s:.4g}")


class SlipMeter:
    """Observes a mission in MuJoCo."""

    def __init__(self, world: MujocoWorld, robot: PlacedRobot, num_robots: int) -> None:
        self._world = world
        self._radius_m = Chassis.of(robot).wheel_radius_m
        joints = [[f"robot_{i}/wheel_{side}" for side in ("left", "right")] for i in range(num_robots)]
        self._wheels = np.array([[world.engine.model.joint(name).dofadr[0] for name in names] for names in joints])
        self.rolled_m, self.driven_m, self.aside_m = 0.0, 0.0, 0.0
        self.leans_rad: list[float] = []

    def begin(self, scenario: object) -> None:
        """Do nothing."""

    def step(self, record: StepRecord) -> None:
        """Add one step."""
        step_s = self._world.step_ns * 1e-9
        twists = np.array([(twist.linear_x_mps, twist.linear_y_mps) for twist in self._world.twists()])
        rims_mps = self._world.engine.data.qvel[self._wheels].mean(axis=1) * self._radius_m
        self.rolled_m += float(np.abs(rims_mps).sum()) * step_s
        self.driven_m += float(np.abs(twists[:, 0]).sum()) * step_s
        self.aside_m += float(np.abs(twists[:, 1]).sum()) * step_s
        self.leans_rad += self._world.engine.lean_rad().tolist()

    def end(self, result: Result) -> None:
        """Do nothing."""

    def abandon(self) -> None:
        """Do nothing."""


def mission(world: str, seed: int) -> tuple[object, ...]:
    """Return the row of one mission."""
    scenario = load("garage_sar", [f"run.world={world}", f"run.seed={seed}"])
    simulation = Simulation(scenario)
    meter = None
    if isinstance(simulation.world, MujocoWorld):
        meter = SlipMeter(simulation.world, resolve(scenario).robots[0], scenario.num_robots)
    result = simulation.run([meter] if meter else [])
    slip: tuple[float, ...] = (math.nan,) * 4
    if meter:
        shares = (meter.rolled_m - meter.driven_m) / meter.driven_m, meter.aside_m / meter.driven_m
        slip = (*shares, 1000.0 * statistics.fmean(meter.leans_rad), 1000.0 * max(meter.leans_rad))
    return (*outcome(world, seed, result), *(f"{value:.4g}" for value in slip))


def main() -> None:
    """Run the missions, print and record them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--trials", type=int, default=30, help="number of seeds")
    parser.add_argument("--csv", type=Path, default=Path(__file__).with_suffix(".csv"))
    options = parser.parse_args()
    for seed in range(options.first, options.first + options.trials):
        for world in ("box2d", "mujoco"):
            row = mission(world, seed)
            print(*row, flush=True)
            append_rows(options.csv, COLUMNS, [row])


if __name__ == "__main__":
    main()

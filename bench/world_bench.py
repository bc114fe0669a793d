"""How much faster than real time the world runs with a laser on every robot, beside its peers.

A plan of 60 x 40 m with 80 rectangles; robots of the default kind (a disc of 0.2 m; 181 beams over 180 degrees, 5 m)
draw new speeds every 2 s. A step of 0.1 s has five physics steps of 20 ms, a scan and the odometry of every robot. One
core; its busy time is what counts, which is wall time on an idle machine. To compare machines, the last column says how
many such steps take as long as sorting a million numbers in NumPy does in the same run.
Usage: python bench/world_bench.py [--robots 3 30 100 1000] [--runs 5] [--seconds 1.0] [--csv FILE]
"""

from __future__ import annotations

import argparse
import csv
import datetime
import math
import resource
import statistics
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

RUN = Run()
REDRAW_STEPS = 20
"""2 s: as long a robot keeps its speeds."""

TEAMS = (3, 30, 100, 1000)
GOALS = {3: 5000.0, 30: 700.0, 100: 200.0, 1000: 12.0}
PEERS = {
    "ARGoS": {3: 890.0, 30: 72.0, 100: 19.4, 1000: 1.16},
    "Stage": {3: 453.0, 30: 52.0, 100: 13.5, 1000: 0.41},
    "Flatland": {3: 84.0, 30: 5.3, 100: 1.1, 1000: 0.01},
}
"""Simulated over wall seconds on the same work, once, on two cores of such a machine; not measured here."""


def plan_of_rectangles(generator: np.random.Generator) -> FloorPlan:
    walls = (
        Wall(name="south", start=(0.0, 0.1), end=(60.0, 0.1)),
        Wall(name="north", start=(0.0, 39.9), end=(60.0, 39.9)),
        Wall(name="west", start=(0.1, 0.2), end=(0.1, 39.8)),
        Wall(name="east", start=(59.9, 0.2), end=(59.9, 39.8)),
    )
    blocks = []
    for i in range(76):
        x, y = generator.uniform(1.0, 56.0), generator.uniform(1.0, 36.0)
        width, depth = generator.uniform(0.2, 3.0, 2)
        corners = ((x, y), (x + width, y), (x + width, y + depth), (x, y + depth))
        blocks.append(Block(name=f"block_{i}", polygon=corners))
    return FloorPlan(name="rectangles", bounds=Bounds(max=(60.0, 40.0)), walls=walls, blocks=tuple(blocks))


def free_robots(plan: FloorPlan, count: int, generator: np.random.Generator) -> list[PlacedRobot]:
    solid, robots = obstacles(plan), []
    while len(robots) < count:
        x, y = generator.uniform(0.5, 59.5), generator.uniform(0.5, 39.5)
        apart = all(math.dist((x, y), robot.start_pose[:2]) > 0.5 for robot in robots)
        if apart and solid.distance(shapely.Point(x, y)) > 0.3:
            robots.append(PlacedRobot(start_pose=(x, y, generator.uniform(-math.pi, math.pi))))
    return robots


def random_twists(count: int, generator: np.random.Generator) -> np.ndarray:
    return generator.uniform((-0.2, 0.0, -1.0), (0.7, 0.0, 1.0), (count, 3))


@dataclass(frozen=True, slots=True)
class Row:
    """What was measured of a team; the first two in simulated over busy seconds."""

    robots: int
    with_lasers: float
    without: float
    steps_per_sorting: float
    memory_mb: float

    @property
    def is_met(self) -> bool | None:
        """Whether the goal is met, where there is one."""
        return self.with_lasers >= GOALS[self.robots] if self.robots in GOALS else None


def times_real_time(plan: FloorPlan, count: int, *, with_sensors: bool, seconds: float) -> float:
    generator = np.random.default_rng(1)
    robots = free_robots(plan, count, generator)
    world = World(plan, robots, RUN)
    sensors = RobotSensors(world, robots, 1)
    spent_s = 0.0
    while spent_s < seconds:
        twists = random_twists(count, generator)
        start_s = time.process_time()
        for _ in range(REDRAW_STEPS):
            world.step(twists)
            if with_sensors:
                sensors.read()
        spent_s += time.process_time() - start_s
    return world.sim_time_ns * 1e-9 / spent_s


def sorting_s() -> float:
    """Return the busy time that NumPy takes to sort a million numbers."""
    numbers = np.random.default_rng(1).random(1_000_000)
    start_s = time.process_time()
    numbers.sort()
    return time.process_time() - start_s


def measure(plan: FloorPlan, count: int, runs: int, seconds: float) -> Row:
    """Return medians over runs."""
    sensing, bare, sorting = (
        statistics.median(once() for _ in range(runs))
        for once in (
            lambda: times_real_time(plan, count, with_sensors=True, seconds=seconds),
            lambda: times_real_time(plan, count, with_sensors=False, seconds=seconds),
            sorting_s,
        )
    )
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-6
    return Row(count, sensing, bare, sensing / RUN.step_s * sorting, memory_mb)


def table(rows: list[Row]) -> str:
    """Return rows as text, peers beside."""
    lines = [("robots", "this [x real time]", "goal", "", *PEERS, "this / best peer", "no lasers", "steps per sorting")]
    for row in rows:
        goal = GOALS.get(row.robots)
        peers = [speeds.get(row.robots) for speeds in PEERS.values()]
        best = max((speed for speed in peers if speed), default=None)
        verdict = {None: "", True: "met", False: "MISSED"}[row.is_met]
        lines.append(
            (
                str(row.robots),
                f"{row.with_lasers:,.0f}",
                f"{goal:,.0f}" if goal else "",
                verdict,
                *(f"{speed:g}" if speed else "" for speed in peers),
                f"{row.with_lasers / best:.1f}" if best else "",
                f"{row.without:,.0f}",
                f"{row.steps_per_sorting:.1f}",
            )
        )
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return "\n".join("  ".join(text.rjust(width) for text, width in zip(line, widths, strict=True)) for line in lines)


def write_csv(path: Path, rows: list[Row]) -> None:
    """Write rows, each with the date."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("date", "robots", "with_lasers", "goal", "without", "steps_per_sorting", "peak_memory_mb"))
        for row in rows:
            figures = (row.with_lasers, GOALS.get(row.robots, math.nan), row.without, row.steps_per_sorting)
            numbers = (f"{figure:.4g}" for figure in (*figures, row.memory_mb))
            writer.writerow((datetime.date.today().isoformat(), row.robots, *numbers))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=list(TEAMS))
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1.0, help="of each run")
    parser.add_argument("--csv", type=Path, help="write the table into this file too")
    options = parser.parse_args()
    plan = plan_of_rectangles(np.random.default_rng(7))
    rows = [measure(plan, count, options.runs, options.seconds) for count in options.robots]
    print(f"simulated over wall seconds, medians of {options.runs} runs; {RUN.physics_substeps} physics steps per step")
    print(table(rows))
    print(f"peak memory, Python included: {rows[-1].memory_mb:.0f} MB")
    if options.csv:
        write_csv(options.csv, rows)


if __name__ == "__main__":
    main()

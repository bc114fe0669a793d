"""How much faster than real time the world runs with a laser on every robot, beside its peers.

A plan of 60 x 40 m with 80 rectangles; robots of the default kind (a disc of 0.2 m; 181 beams over 180 degrees, 5 m)
draw new speeds every 2 s. A step of 0.1 s has five physics steps of 20 ms, a scan and the odometry of every robot. One
core; its busy time is what counts, which is wall time on an idle machine. To compare machines, the last column says how
many such steps take as long as sorting a million numbers in NumPy. The three are measured by turns, so that a neighbour
on the same core slows them alike.
Usage: python bench/world_bench.py [--robots 3 30 100 1000] [--rounds 15] [--seconds 0.4] [--csv FILE]
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
    solid = obstacles(plan)
    robots: list[PlacedRobot] = []
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
    """What was measured of a team: medians over rounds; speeds in simulated over busy seconds."""

    robots: int
    with_lasers: float
    slowest: float
    fastest: float
    without: float
    steps_per_sorting: float
    memory_mb: float

    @property
    def is_met(self) -> bool | None:
        """Whether the goal is met, where there is one."""
        return self.with_lasers >= GOALS[self.robots] if self.robots in GOALS else None


class Course:
    """A team that drives about."""

    def __init__(self, plan: FloorPlan, count: int, *, with_sensors: bool) -> None:
        self._generator = np.random.default_rng(1)
        robots = free_robots(plan, count, self._generator)
        self._world = World(plan, robots, RUN)
        self._sensors = RobotSensors(self._world, robots, 1) if with_sensors else None

    def times_real_time(self, seconds: float) -> float:
        """Drive on for some busy seconds; return simulated over busy seconds."""
        spent_s, begin_ns = 0.0, self._world.sim_time_ns
        while spent_s < seconds:
            twists = random_twists(self._world.num_robots, self._generator)
            start_s = time.process_time()
            for _ in range(REDRAW_STEPS):
                self._world.step(twists)
                if self._sensors:
                    self._sensors.read()
            spent_s += time.process_time() - start_s
        return (self._world.sim_time_ns - begin_ns) * 1e-9 / spent_s


def sorting_s() -> float:
    """Return the busy time that NumPy takes to sort a million numbers."""
    numbers = np.random.default_rng(1).random(1_000_000)
    start_s = time.process_time()
    numbers.sort()
    return time.process_time() - start_s


def measure(plan: FloorPlan, count: int, rounds: int, seconds: float) -> Row:
    """Return medians over rounds; each round sorts numbers and drives a team with lasers and one without."""
    sensing, bare = Course(plan, count, with_sensors=True), Course(plan, count, with_sensors=False)
    figures = []
    for _ in range(rounds):
        speed = sensing.times_real_time(seconds)
        figures.append((speed, bare.times_real_time(seconds), speed / RUN.step_s * sorting_s()))
    speeds, bare_speeds, steps = zip(*figures, strict=True)
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-6
    medians = statistics.median(speeds), min(speeds), max(speeds), statistics.median(bare_speeds)
    return Row(count, *medians, statistics.median(steps), memory_mb)


def table(rows: list[Row]) -> str:
    """Return rows as text, peers beside."""
    heads = ("robots", "this [x real time]", "rounds", "goal", "", *PEERS, "this / best peer", "no lasers")
    lines = [(*heads, "steps per sorting")]
    for row in rows:
        goal = GOALS.get(row.robots)
        peers = [speeds.get(row.robots) for speeds in PEERS.values()]
        best = max((speed for speed in peers if speed), default=None)
        verdict = {None: "", True: "met", False: "MISSED"}[row.is_met]
        lines.append(
            (
                str(row.robots),
                f"{row.with_lasers:,.0f}",
                f"{row.slowest:,.0f} to {row.fastest:,.0f}",
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
        speeds = ("with_lasers", "slowest", "fastest", "goal", "without")
        writer.writerow(("date", "robots", *speeds, "steps_per_sorting", "peak_memory_mb"))
        for row in rows:
            figures = (row.with_lasers, row.slowest, row.fastest, GOALS.get(row.robots, math.nan), row.without)
            numbers = (f"{figure:.4g}" for figure in (*figures, row.steps_per_sorting, row.memory_mb))
            writer.writerow((datetime.date.today().isoformat(), row.robots, *numbers))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=list(TEAMS))
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--seconds", type=float, default=0.4, help="busy seconds of each team in a round")
    parser.add_argument("--csv", type=Path, help="write the table into this file too")
    options = parser.parse_args()
    plan = plan_of_rectangles(np.random.default_rng(7))
    rows = [measure(plan, count, options.rounds, options.seconds) for count in options.robots]
    print(f"simulated over busy seconds, medians of {options.rounds} rounds; {RUN.physics_substeps} of physics a step")
    print(table(rows))
    print(f"peak memory, Python included: {rows[-1].memory_mb:.0f} MB")
    if options.csv:
        write_csv(options.csv, rows)


if __name__ == "__main__":
    main()

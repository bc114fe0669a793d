"""How much faster than real time the world runs, with and without sensors at 10 Hz.

A plan of 60 x 40 m with 80 rectangles; robots of the default kind (181 beams, 5 m) drive at random. One
core; its busy time is what counts, which is wall time on an idle machine. To compare machines, the last column says
how many steps with sensors take as long as sorting a million numbers in NumPy does in the same run.
Usage: python bench/world_bench.py [--robots 3 30 100] [--runs 5] [--seconds 1.0]
"""

from __future__ import annotations

import argparse
import math
import statistics
import time

import numpy as np
import shapely

from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.sensing.laser import Laser
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

RUN = Run()
BATCH_STEPS = 20
BEAMS = 181


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


def times_real_time(plan: FloorPlan, count: int, *, with_sensors: bool, seconds: float) -> float:
    generator = np.random.default_rng(1)
    robots = free_robots(plan, count, generator)
    world = World(plan, robots, RUN)
    sensors = RobotSensors(world, robots, 1)
    spent_s = 0.0
    while spent_s < seconds:
        twists = random_twists(count, generator)
        start_s = time.process_time()
        for _ in range(BATCH_STEPS):
            world.step(twists)
            if with_sensors:
                sensors.read()
        spent_s += time.process_time() - start_s
    return world.sim_time_ns * 1e-9 / spent_s


def scan_us(plan: FloorPlan, count: int, seconds: float) -> float:
    """Return the time of one laser scan, the call from Python included [us]."""
    generator = np.random.default_rng(1)
    robots = free_robots(plan, count, generator)
    world = World(plan, robots, RUN)
    laser, scans, start_s = Laser(robots[0].laser, world), 0, time.process_time()
    while time.process_time() - start_s < seconds:
        laser.scan(range(count), [generator] * count)
        scans += count
    return (time.process_time() - start_s) / scans * 1e6


def sorting_s() -> float:
    """Return the busy time that NumPy takes to sort a million numbers."""
    numbers = np.random.default_rng(1).random(1_000_000)
    start_s = time.process_time()
    numbers.sort()
    return time.process_time() - start_s


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=[3, 30, 100, 1000])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1.0, help="of each run")
    options = parser.parse_args()
    plan = plan_of_rectangles(np.random.default_rng(7))
    print(f"medians of {options.runs} runs")
    print(
        "robots  world [x real time]  with sensors [x real time]  laser [us/scan]  laser [ns/beam]  steps per sorting"
    )
    for count in options.robots:
        bare, sensing, scans, sorting = (
            statistics.median(measure() for _ in range(options.runs))
            for measure in (
                lambda: times_real_time(plan, count, with_sensors=False, seconds=options.seconds),  # noqa: B023
                lambda: times_real_time(plan, count, with_sensors=True, seconds=options.seconds),  # noqa: B023
                lambda: scan_us(plan, count, options.seconds),  # noqa: B023
                sorting_s,
            )
        )
        steps = sensing / RUN.step_s * sorting
        print(f"{count:6d}  {bare:19.0f}  {sensing:26.0f}  {scans:15.2f}  {scans / BEAMS * 1e3:15.1f}  {steps:17.1f}")


if __name__ == "__main__":
    main()

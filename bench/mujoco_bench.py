"""How much faster than real time the world of MuJoCo runs, what a ray costs, and how many images a camera takes.

The plan, the robots and their speeds are those of `world_bench.py`: a plan of 60 x 40 m with 80 rectangles, robots of
the default kind that draw new speeds every 2 s. A step of 0.1 s has 20 steps of MuJoCo. One core; its busy time is
what counts. Box2D runs the same teams in alternation, so that a busy machine slows both.
Usage: python bench/mujoco_bench.py [--robots 3 30] [--rounds 7] [--seconds 1] [--csv FILE]
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from results_file import append
from world_bench import REDRAW_STEPS, free_robots, plan_of_rectangles, random_twists

from robotteamsim.scenario.sections import Run
from robotteamsim.scenario.sensors import Camera
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World
from robotteamsim.world.mujoco.world import MujocoWorld

CAMERA = Camera(name="camera")
CAMERA_GOAL = 9.0
"""Images of 320 x 240 pixels per second."""

GOALS = {3: 80.0, 30: 8.0}
"""Times real time, by the number of robots, without sensors."""


@dataclass(frozen=True, slots=True)
class Speeds:
    """Medians over rounds.

    bare, with_lasers, box2d: simulated over busy seconds, of MuJoCo without and with lasers, and of Box2D.
    ray_s: busy time of a ray.  images_per_s: images per busy second.
    """

    bare: float
    with_lasers: float
    box2d: float
    ray_s: float
    images_per_s: float


class Course:
    """A team that drives about."""

    def __init__(self, kind: type[World] | type[MujocoWorld], count: int) -> None:
        self._generator = np.random.default_rng(1)
        plan = plan_of_rectangles(np.random.default_rng(7))
        robots = free_robots(plan, count, self._generator)
        self._robots = [robot.model_copy(update={"cameras": (CAMERA,)}) for robot in robots]
        self._world = kind(plan, self._robots, Run())
        self._sensors = RobotSensors(self._world, robots, 1)  # without the camera, which is measured alone

    def drive(self, seconds: float, *, with_sensors: bool = False) -> float:
        """Drive on for some busy seconds; return simulated over busy seconds."""
        spent_s, begin_ns = 0.0, self._world.sim_time_ns
        while spent_s < seconds:
            twists = random_twists(self._world.num_robots, self._generator)
            start_s = time.process_time()
            for _ in range(REDRAW_STEPS):
                self._world.step(twists)
                if with_sensors:
                    self._sensors.read()
            spent_s += time.process_time() - start_s
        return (self._world.sim_time_ns - begin_ns) * 1e-9 / spent_s

    def ray_s(self, repetitions: int = 20) -> float:
        """Return the busy time of one ray of a scan."""
        start_s = time.process_time()
        for _ in range(repetitions):
            self._sensors.read()
        beams = sum(robot.laser.beams for robot in self._robots)
        return (time.process_time() - start_s) / repetitions / beams

    def images_per_s(self, repetitions: int = 20) -> float:
        """Return how many images of 320 x 240 pixels a camera takes per busy second, after the first."""
        self._world.image(0, CAMERA)  # opens the context of OpenGL
        start_s = time.process_time()
        for _ in range(repetitions):
            self._world.image(0, CAMERA)
        return repetitions / (time.process_time() - start_s)


def measure(count: int, rounds: int, seconds: float) -> Speeds:
    """Return medians over rounds."""
    mujoco, box2d = Course(MujocoWorld, count), Course(World, count)
    rows = [
        (
            mujoco.drive(seconds),
            mujoco.drive(seconds, with_sensors=True),
            box2d.drive(0.2 * seconds),
            mujoco.ray_s(),
            mujoco.images_per_s(),
        )
        for _ in range(rounds)
    ]
    return Speeds(*map(statistics.median, zip(*rows, strict=True)))


def main() -> None:
    """Measure, print and record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=list(GOALS))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--seconds", type=float, default=1.0, help="busy seconds of each measurement in a round")
    parser.add_argument("--csv", type=Path, default=Path(__file__).parent / "results" / "mujoco.csv")
    options = parser.parse_args()
    for count in options.robots:
        found = measure(count, options.rounds, options.seconds)
        goal = GOALS.get(count)
        verdict = "" if goal is None else f" (goal {goal:g}: {'met' if found.bare >= goal else 'MISSED'})"
        print(
            f"{count} robots: {found.bare:.1f} x real time{verdict}, with lasers {found.with_lasers:.1f}, "
            f"Box2D {found.box2d:,.0f}; a ray {found.ray_s * 1e6:.2f} us; {found.images_per_s:.0f} images/s "
            f"(goal {CAMERA_GOAL:g}: {'met' if found.images_per_s >= CAMERA_GOAL else 'MISSED'})"
        )
        quantities = {
            "MuJoCo [s/s]": found.bare,
            "MuJoCo with lasers [s/s]": found.with_lasers,
            "Box2D [s/s]": found.box2d,
            "ray [us]": found.ray_s * 1e6,
            "images [1/s]": found.images_per_s,
        }
        append(options.csv, "mujoco", count, quantities)


if __name__ == "__main__":
    main()

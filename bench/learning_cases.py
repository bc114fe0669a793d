"""The environments that learning_bench.py measures, each in a process and with the Python that has its packages.

All have the garage, three robots if not stated (discs with differential drives), steps of 0.1 s, 181 beams over 180
degrees and 5 m that see walls and robots, and random actions, drawn beforehand. With equal laser positions, the scans
of the three simulators differ by at most 1.3 mm at the start, as IR-SIM's discs are polygons; VMAS has lasers in the
centre only. What each computes beyond that is in `Case.computes`.

The peers have their fastest configurations: VMAS no gradients, no drag and the simplest integration, and batches of 64
too, sometimes faster than 256; IR-SIM no figure, and walls as polygons, which are three times as fast as a
map. IR-SIM 2.12.1, which casts the beams of all robots together, could not be installed. Our time includes resets of
missions that have ended; the peers' never end.
Usage: python bench/learning_cases.py CASE BUILDING.json SECONDS
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

ROBOTS = 3
BEAMS, RANGE_M = 181, 5.0
NUM_ACTIONS = 256
"""Drawn beforehand, then repeated."""

Building = dict[str, Any]
Step = Callable[[], object]


@dataclass(frozen=True, slots=True)
class Case:
    """An environment. steps: how many steps of the simulation a call makes; goal: robot steps per second."""

    make: Callable[[Building], Step]
    missions: int = 1
    robots: int = ROBOTS
    steps: int = 1
    goal: float | None = None
    is_peer: bool = False
    computes: str = "walls in lasers, radio, voices; accelerations, contacts, 5 substeps, messages, odometry, rewards"

    @property
    def robot_steps(self) -> int:
        """Robot steps of a call."""
        return self.robots * self.missions * self.steps


def random_actions(missions: int = 1) -> np.ndarray:
    """Return actions within [-1, 1], shape (NUM_ACTIONS, robots, missions, 2)."""
    return np.random.default_rng(1).uniform(-1.0, 1.0, (NUM_ACTIONS, ROBOTS, missions, 2)).astype(np.float32)


def parallel_env(_: Building, *, every: int = 1) -> Step:
    """Step `parallel_env`; a mission that has ended begins again."""
    from robotteamsim import learning

    env = learning.parallel_env("garage_sar", every=every)
    env.reset(seed=1)
    drawn = random_actions()[:, :, 0]
    actions = itertools.cycle([dict(zip(env.possible_agents, row, strict=True)) for row in drawn])

    def step() -> None:
        if not env.agents:
            env.reset()
        env.step(next(actions))

    return step


def batch_env(_: Building, *, missions: int, robots: int = ROBOTS, every: int = 1, said: int = 0) -> Step:
    """Step `BatchEnv`, which begins missions that have ended again."""
    from robotteamsim import learning
    from robotteamsim.scenario import load

    scenario = load("garage_sar", [f"robots.count={robots}"])
    env = learning.BatchEnv(scenario, missions, every=every, said=said)
    env.reset(seed=1)
    shape = NUM_ACTIONS, missions, robots, *env.act.space.shape
    actions = itertools.cycle(np.random.default_rng(1).uniform(-1.0, 1.0, shape).astype(np.float32))
    return lambda: env.step(next(actions))


def vmas(building: Building, *, missions: int) -> Step:
    """Step a scenario of VMAS whose walls are boxes."""
    import torch
    from vmas import make_env
    from vmas.simulator.core import Agent, Box, Landmark, Sphere, World
    from vmas.simulator.dynamics.diff_drive import DiffDrive
    from vmas.simulator.scenario import BaseScenario
    from vmas.simulator.sensors import Lidar

    torch.set_num_threads(1)

    class Garage(BaseScenario):  # type: ignore[misc]
        def make_world(self, batch_dim: int, device: torch.device, **_: Any) -> World:
            world = World(batch_dim, device, dt=0.1, drag=0.0)
            half = 0.5 * np.pi
            for i in range(ROBOTS):
                lidar = Lidar(world, -half, half, BEAMS, RANGE_M, entity_filter=lambda _: True, render=False)
                shape, reach = Sphere(building["radius_m"]), [building["speed_mps"], building["turn_radps"]]
                drive = DiffDrive(world, integration="euler")
                world.add_agent(Agent(f"robot_{i}", shape=shape, sensors=[lidar], u_multiplier=reach, dynamics=drive))
            self.places = []
            for i, corners in enumerate(building["walls"]):
                a, b, c, _ = (np.array(corner) for corner in corners)
                length, width, middle = np.linalg.norm(b - a), np.linalg.norm(c - b), 0.5 * (a + c)
                world.add_landmark(Landmark(f"wall_{i}", shape=Box(float(length), float(width)), collide=True))
                self.places.append((*middle, np.arctan2(*(b - a)[::-1])))
            return world

        def reset_world_at(self, env_index: int | None = None) -> None:
            placed = zip(self.world.agents + self.world.landmarks, building["starts"] + self.places, strict=True)
            for entity, (x, y, yaw) in placed:
                entity.set_pos(torch.tensor([x, y], dtype=torch.float32), env_index)
                entity.set_rot(torch.tensor([yaw], dtype=torch.float32), env_index)

        def observation(self, agent: Agent) -> torch.Tensor:
            state = agent.state
            return torch.cat((agent.sensors[0].measure() / RANGE_M, state.pos, state.rot, state.vel, state.ang_vel), -1)

        def reward(self, agent: Agent) -> torch.Tensor:
            return torch.zeros(self.world.batch_dim)

    env = make_env(Garage(), missions)
    env.reset(seed=1)
    actions = itertools.cycle([list(row) for row in torch.from_numpy(random_actions(missions))])
    return torch.inference_mode()(lambda: env.step(next(actions)))


def ir_sim(building: Building, *, collision_mode: str) -> Step:
    """Step a world of IR-SIM whose walls are polygons."""
    import irsim
    import yaml

    speed, turn = building["speed_mps"], building["turn_radps"]
    lidar = {
        "name": "lidar2d",
        "range_max": RANGE_M,
        "angle_range": float(np.pi),
        "number": BEAMS,
        "offset": [building["laser_m"], 0.0, 0.0],
    }
    robot = {
        "kinematics": {"name": "diff"},
        "shape": {"name": "circle", "radius": building["radius_m"]},
        "vel_min": [-speed, -turn],
        "vel_max": [speed, turn],
        "sensors": [lidar],
    }
    width, height = building["size_m"]
    world = {"width": width, "height": height, "step_time": 0.1, "collision_mode": collision_mode}
    walls = [
        {"shape": {"name": "polygon", "vertices": corners}, "state": [0.0, 0.0, 0.0]} for corners in building["walls"]
    ]
    content = {"world": world, "robot": [robot | {"state": start} for start in building["starts"]], "obstacle": walls}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "garage.yaml")
        path.write_text(yaml.safe_dump(content), encoding="utf-8")
        env = irsim.make(str(path), headless=True, log_level="CRITICAL", seed=1)
    reach = np.array([speed, turn], np.float32)
    actions = itertools.cycle([list(row * reach) for row in random_actions()[:, :, 0]])
    ids = list(range(ROBOTS))

    def step() -> list[np.ndarray]:
        env.step(next(actions), ids)
        return [np.concatenate((robot.get_lidar_scan()["ranges"], robot.state[:, 0])) for robot in env.robot_list]

    return step


def jaxnav(_: Building, *, missions: int, steps: int) -> Step:
    """Step JaxNav, compiled, many steps in a call; a mission begins again as it was, since drawing others takes longer.

    Its buildings are grids of 11 x 11 cells of 1 m.
    """
    import jax
    from jaxmarl.environments.jaxnav.jaxnav_env import JaxNav

    lidar = {"lidar_num_beams": BEAMS, "lidar_max_range": RANGE_M, "lidar_angle_factor": 0.5}
    env = JaxNav(ROBOTS, **lidar)
    drawn = np.random.default_rng(1).uniform(-1.0, 1.0, (steps, missions, ROBOTS, 2)).astype(np.float32)
    actions = {agent: drawn[:, :, i] for i, agent in enumerate(env.agents)}
    first = jax.vmap(env.reset)(jax.random.split(jax.random.key(2), missions))[1]

    def one(carried: Any, chosen: Any) -> tuple[Any, Any]:
        key, key_of_step = jax.random.split(carried[0])
        seen, state, rewards, done, _ = jax.vmap(env.step)(
            jax.random.split(key_of_step, missions), carried[1], chosen, first
        )
        return (key, state), (seen, rewards, done)

    many = jax.jit(lambda carried: jax.lax.scan(one, carried, actions))
    carried = jax.random.key(1), first

    def step() -> None:
        nonlocal carried
        carried, _ = jax.block_until_ready(many(carried))

    return step


VMAS = Case(partial(vmas, missions=1), is_peer=True, computes="walls in lasers; contacts as springs")
IR_SIM = Case(partial(ir_sim, collision_mode="contact"), is_peer=True, computes="walls in lasers; contacts, grip")
BATCH = Case(partial(batch_env, missions=256), missions=256)

CASES = {
    "parallel_env": Case(parallel_env, goal=50_000.0),
    "parallel_env, every 5": Case(partial(parallel_env, every=5), steps=5),
    "BatchEnv of 256": replace(BATCH, goal=150_000.0),
    "BatchEnv of 64, 10 robots that say 4 numbers": Case(
        partial(batch_env, missions=64, robots=10, said=4), missions=64, robots=10, goal=60_000.0
    ),
    "VMAS": VMAS,
    "VMAS of 64": replace(VMAS, make=partial(vmas, missions=64), missions=64),
    "VMAS of 256": replace(VMAS, make=partial(vmas, missions=256), missions=256),
    "IR-SIM": IR_SIM,
    "IR-SIM, no contacts": replace(
        IR_SIM, make=partial(ir_sim, collision_mode="unobstructed"), computes="walls in lasers"
    ),
    "JaxNav of 64": Case(
        partial(jaxnav, missions=64, steps=10),
        missions=64,
        steps=10,
        is_peer=True,
        computes="walls in lasers; lasers as points every 5 cm; a contact ends the mission, rewards",
    ),
}
"""What is compared; ratios are to the first."""

SOAKED = {"parallel_env, for long": Case(parallel_env), "BatchEnv of 256, for long": BATCH}
"""What is run once, for its memory."""


def memory_mb() -> float:
    """Return the resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") * 1e-6


def measure(case: Case, step: Step, seconds: float) -> dict[str, float]:
    """Step for some seconds of processor time, at least three times; the growth is that in the second half."""
    calls, next_s, samples = 0, 0.0, []
    begin_s, wall_begin_s = time.process_time(), time.perf_counter()
    while (spent_s := time.process_time() - begin_s) < seconds or calls < 3:
        if spent_s >= next_s:
            samples.append((spent_s, memory_mb()))
            next_s = spent_s + seconds / 100.0
        step()
        calls += 1
    wall_s = time.perf_counter() - wall_begin_s
    times_s, memories_mb = np.array(samples[len(samples) // 2 :]).T
    mb_per_s = np.polyfit(times_s, memories_mb, 1)[0] if len(times_s) > 1 else np.nan
    return {
        "robot_steps_per_s": calls * case.robot_steps / spent_s,
        "per_wall_s": calls * case.robot_steps / wall_s,
        "robot_steps": calls * case.robot_steps,
        "memory_mb": memory_mb(),
        "mb_per_hour": 3600.0 * mb_per_s,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", choices=CASES | SOAKED)
    parser.add_argument("building", type=Path)
    parser.add_argument("seconds", type=float)
    options = parser.parse_args()
    case = (CASES | SOAKED)[options.case]
    step = case.make(json.loads(options.building.read_text(encoding="utf-8")))
    for _ in range(3):
        step()  # warm-up
    print(json.dumps(measure(case, step, options.seconds)))


if __name__ == "__main__":
    main()

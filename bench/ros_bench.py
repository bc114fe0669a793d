"""How many times as fast as real time a world runs in ROS: with many robots and one subscriber, and with missions.

- `subscribed`: the world alone (world.launch), robots of the default kind (181 beams) at 10 Hz in the plan of
  bench/world_bench.py, flat out. One C++ client subscribes to every robot's odom, base_scan, base_pose_ground_truth and
  contact, and /tf and /clock, and drives the robots. The world starts when all these topics are connected. From the
  first message to the last one of the last step; `lost` counts messages that are missing or out of order, and must be
  0; busy times are of the two processes, per simulated second: on a busy machine, 1 / (the longer of them) is more
  reliable than the speed.
- `lockstep` and `free`: a mission of three robots, from its first step on, flat out; and the processor time of all
  nodes per simulated second, without that of a mission of 1 s, which is the start.

Starting the nodes is not counted. Usage, with the build's devel/setup.sh sourced:
python bench/ros_bench.py LISTENER [--robots 30 100 300] [--steps 100] [--runs 3] [--mission-seconds 120] [--csv FILE]
where LISTENER is build/devel/lib/robotteamsim/robotteamsim_ros_listener.
"""

from __future__ import annotations

import argparse
import json
import resource
import signal
import statistics
import subprocess
import tempfile
import xmlrpc.client
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import results_file
from ros_processes import GRACE_S, ROSLAUNCH, busy_s, environment
from world_bench import free_robots, plan_of_rectangles

from robotteamsim.scenario.loading import write_floor_plan

STEP_S = 0.1
TIMEOUT_S = 300
START_S = 1.0


@dataclass(frozen=True)
class Heard:
    """What the client got; busy times are per simulated second."""

    speed: float
    messages: int
    lost: int
    world_busy: float
    client_busy: float


def write_scenario(folder: str, count: int) -> None:
    plan = plan_of_rectangles(np.random.default_rng(7))
    write_floor_plan(plan, f"{folder}/plan.yaml")
    robots = [
        {"start_pose": [round(value, 6) for value in robot.start_pose], "cmd_vel_hold_s": 3.0}
        for robot in free_robots(plan, count, np.random.default_rng(1))
    ]
    # JSON is YAML.
    Path(folder, "many.yaml").write_text(json.dumps({"name": "many", "plan": "plan.yaml", "robots": robots}))


def world_pid(master_uri: str) -> int:
    _, _, uri = xmlrpc.client.ServerProxy(master_uri).lookupNode("/ros_bench", "/simulation")
    return xmlrpc.client.ServerProxy(uri).getPid("/ros_bench")[2]


def heard(listener: str, count: int, steps: int) -> Heard:
    """Run a world with one subscriber, and return what it received."""
    with tempfile.TemporaryDirectory() as folder:
        port, env = environment(folder)
        write_scenario(folder, count)
        world = (
            *ROSLAUNCH,
            "-p",
            str(port),
            "robotteamsim",
            "world.launch",
            "odometry:=step",
            "paused:=true",
            "speed:=0",
            f"scenario:={folder}/many.yaml",
        )
        client = (listener, str(count), str(steps), str(round(STEP_S * 1e9)), str(TIMEOUT_S))
        with (
            open(f"{folder}/world.txt", "w") as log,
            subprocess.Popen(world, env=env, cwd=folder, stdout=log, stderr=log) as launch,
            subprocess.Popen(client, env=env, stdout=subprocess.PIPE, text=True) as counting,
        ):
            try:
                while "first" not in counting.stdout.readline():  # roscpp reports its master there, too
                    if counting.poll() is not None:
                        raise RuntimeError(f"the client ended:\n{Path(folder, 'world.txt').read_text()}")
                pid = world_pid(env["ROS_MASTER_URI"])
                before_s = busy_s(pid)
                line = counting.stdout.readline()
                world_busy_s = busy_s(pid) - before_s
            finally:
                for process in (counting, launch):
                    process.send_signal(signal.SIGINT)
                    process.wait(GRACE_S)
    got = json.loads(line)
    topics = 4 * count + 1
    wanted = topics * steps
    lost = max(0, wanted - (got["messages"] - got["clock"])) + got["out_of_order"]
    sim_s = steps * STEP_S
    return Heard(sim_s / got["wall_s"], got["messages"], lost, world_busy_s / sim_s, got["busy_s"] / sim_s)


@dataclass(frozen=True)
class MissionRun:
    """sim_s: simulated time; speed: over wall time; cpu_s: processor time of all nodes, with their start."""

    sim_s: float
    speed: float
    cpu_s: float


def mission_run(robots: int, seconds: float, lockstep: bool) -> MissionRun:
    """Run a mission under roslaunch."""
    with tempfile.TemporaryDirectory() as folder:
        port, env = environment(folder)
        command = [*ROSLAUNCH, "-p", str(port), "robotteamsim", "garage_sar.launch"]
        command += [f"robots:={robots}", f"lockstep:={str(lockstep).lower()}", "speed:=0", "rviz:=false", "seed:=7"]
        command += [f"set:=mission.time_limit_s={seconds}", f"out:={folder}/out"]
        before_s = children_cpu_s()
        subprocess.run(command, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        result = json.loads((Path(folder) / "out" / "mission.json").read_text())["result"]
        sim_s = result["sim_time_s"]
        return MissionRun(sim_s, sim_s / result["wall_s"], children_cpu_s() - before_s)


def children_cpu_s() -> float:
    """Return the processor time of all ended processes that this one has started, and theirs."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def measure_missions(robots: int, seconds: float, runs: int, csv: Path | None) -> None:
    """Print and store speed, and processor time per simulated second without that of the start."""
    for name, lockstep in (("lockstep", True), ("free", False)):
        start = mission_run(robots, START_S, lockstep)
        done = [mission_run(robots, seconds, lockstep) for _ in range(runs)]
        speed = statistics.median(run.speed for run in done)
        cost = statistics.median((run.cpu_s - start.cpu_s) / (run.sim_s - start.sim_s) for run in done)
        print(f"{name:8s} {robots:4d}  {speed:7.2f}  all nodes {cost:.3f} s/s", flush=True)
        if csv:
            results_file.append(csv, name, robots, {"speed": speed, "all nodes [s/s]": cost})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("listener")
    parser.add_argument("--robots", type=int, nargs="*", default=[30, 100, 300])
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--mission-robots", type=int, default=3)
    parser.add_argument("--mission-seconds", type=float, default=120.0, help="0: no missions")
    parser.add_argument("--csv", type=Path, help="append the rows to this file, too")
    options = parser.parse_args()
    if not Path(options.listener).is_file():
        parser.error(f"{options.listener} does not exist; `make bench_ros` builds it")
    print(f"medians of {options.runs} runs, x real time")
    print("       robots    speed  messages/s  lost  world [s/s]  client [s/s]")
    for count in options.robots:
        runs = [heard(options.listener, count, options.steps) for _ in range(options.runs)]
        runs.sort(key=lambda run: run.speed)
        run, lost = runs[len(runs) // 2], max(run.lost for run in runs)
        per_s = run.messages * run.speed / (options.steps * STEP_S)
        print(
            f"subscribed {count:4d}  {run.speed:7.2f}  {per_s:10.0f}  {lost:4d}  {run.world_busy:11.3f}"
            f"  {run.client_busy:12.3f}",
            flush=True,
        )
        if options.csv:
            busy = {"world [s/s]": run.world_busy, "client [s/s]": run.client_busy}
            results_file.append(options.csv, "subscribed", count, {"speed": run.speed, "lost": lost, **busy})
    if options.mission_seconds:
        measure_missions(options.mission_robots, options.mission_seconds, options.runs, options.csv)


if __name__ == "__main__":
    main()

"""Whether a team whose controllers share one process keeps time over ROS, and what each node costs for it.

A mission of many robots at real time; one listener to one robot's answers, as all robots of the process answer a step
together. Printed: the share of steps that were answered, how fast the clock went, and the processor time of each node
per simulated second. On a busy machine the last is the reliable figure.
Usage, with the build's devel/setup.sh sourced:
python bench/ros_team_bench.py [--robots 30] [--seconds 30] [--set K=V] [--csv FILE]
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import results_file
import rospy
from ros_network_bench import Listener, launched, pid_of
from ros_processes import busy_s

NODES = ("simulation", "controllers")
STEP_S = 0.1
WARM_UP_STEPS = 50


def measure(robots: int, seconds: float, csv: Path | None) -> None:
    """Listen to a run that is under way, and print what was seen."""
    rospy.init_node("bench", disable_rostime=True, disable_signals=True)
    answers = Listener("/robot_0/cmd_vel_stamped")
    deadline_s = time.monotonic() + 180.0
    while len(answers.arrivals) < WARM_UP_STEPS:
        if time.monotonic() > deadline_s:
            raise SystemExit(f"/robot_0/cmd_vel_stamped: fewer than {WARM_UP_STEPS} messages came within three minutes")
        time.sleep(0.1)
    pids = {name: pid_of(name) for name in NODES}
    first, before_s = len(answers.arrivals), {name: busy_s(pid) for name, pid in pids.items()}
    time.sleep(seconds)
    used_s = {name: busy_s(pid) - before_s[name] for name, pid in pids.items()}
    arrivals = answers.arrivals[first:]
    wall_s, sim_s = ((arrivals[-1][i] - arrivals[0][i]) * unit for i, unit in ((0, 1.0), (1, 1e-9)))
    share = (len({stamp_ns for _, stamp_ns in arrivals}) - 1) / round(sim_s / STEP_S)
    costs = ", ".join(f"{name} {used / sim_s:.3f} s" for name, used in used_s.items())
    steps = round(sim_s / STEP_S)
    print(f"ros team, {robots} robots: {share:.0%} of {steps} steps answered, {sim_s / wall_s:.2f} x real time")
    print(f"ros team, processor time per simulated second: {costs}; together {sum(used_s.values()) / sim_s:.3f} s")
    if csv:
        quantities = {f"{name} [s/s]": used / sim_s for name, used in used_s.items()}
        results_file.append(csv, "team", robots, {"answered": share, "speed": sim_s / wall_s, **quantities})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--set", default="", help="overrides of the scenario, split at blanks")
    parser.add_argument("--csv", type=Path, help="append the rows to this file, too")
    options = parser.parse_args()
    with launched(f"robots:={options.robots}", "controllers:=team", f"set:={options.set}"):
        measure(options.robots, options.seconds, options.csv)


if __name__ == "__main__":
    main()

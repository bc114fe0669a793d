"""How much faster than real time a mission of three robots runs in ROS: in lockstep, and without, both flat out.

From the first step on; starting the nodes is not counted. Usage, with the build's devel/setup.sh sourced:
python bench/ros_bench.py [--robots 3] [--runs 3] [--seconds 120]
"""

from __future__ import annotations

import argparse
import json
import os
import socket
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def speed(robots: int, seconds: float, lockstep: bool) -> float:
    """Run a mission under roslaunch and return its simulated over its wall time."""
    with tempfile.TemporaryDirectory() as folder:
        port = free_port()
        command = [sys.executable, "-c", "import roslaunch; roslaunch.main()", "-p", str(port)]
        command += ["robotteamsim", "garage_sar.launch", f"robots:={robots}", f"lockstep:={str(lockstep).lower()}"]
        command += ["speed:=0", "rviz:=false", "seed:=7", f"set:=mission.time_limit_s={seconds}", f"out:={folder}/out"]
        environment = os.environ | {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOME": folder}
        subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        result = json.loads((Path(folder) / "out" / "mission.json").read_text())["result"]
        return result["sim_time_s"] / result["wall_s"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=3)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=120.0)
    options = parser.parse_args()
    for name, lockstep in (("lockstep", True), ("free", False)):
        speeds = [speed(options.robots, options.seconds, lockstep) for _ in range(options.runs)]
        print(
            f"ros {name}, {options.robots} robots: {statistics.median(speeds):.1f} x real time (of {options.runs} runs)"
        )


if __name__ == "__main__":
    main()

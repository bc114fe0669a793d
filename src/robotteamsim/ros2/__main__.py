"""Runs a mission with all its nodes, as `ros2 launch robotteamsim mission.launch.py` does."""

import signal

# Imports take a second or more; Ctrl-C would end them with a traceback.
signal.signal(signal.SIGINT, signal.SIG_DFL)

# ruff: noqa: E402
import argparse
import contextlib
import importlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from typing import Any

from robotteamsim.ending import ending_signals
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.message_parts import robot_name
from robotteamsim.nodes.launched import NOT_SET, lock_domain, read_scenario
from robotteamsim.nodes.settings import HOSTED
from robotteamsim.ros2.arguments import given_parameters

NODE = """
import os, signal, threading
signal.signal(signal.SIGINT, signal.SIG_DFL)

def end_with_the_starter():  # which holds the other end of the pipe that is the standard input
    os.read(0, 1)
    os.kill(os.getpid(), signal.SIGTERM)

threading.Thread(target=end_with_the_starter, daemon=True).start()
from robotteamsim.nodes.start import start
start({node!r})
"""
"""The program of a node."""
CHECK_S = 0.1
"""Interval of checks whether a node has ended [s, wall]."""
GRACE_S = 10.0
"""A node that does not end by then is killed [s, wall]."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run until the simulation has ended; return its exit status."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    split = given.index("--ros-args") if "--ros-args" in given else len(given)
    options = _parser().parse_args(given[:split])
    try:
        importlib.import_module("rclpy")
    except ImportError as error:
        version = f"{sys.version_info.major}.{sys.version_info.minor}"
        what = f"this Python {version} has no rclpy ({error}); expected a ROS 2 for it to be sourced (docs/ros2.md)"
        sys.stderr.write(f"robotteamsim.ros2: {what}\n")
        return 2
    seed = [] if options.seed is None else [f"run.seed={options.seed}"]
    settings = {
        "scenario": options.scenario,
        "robots": options.robots,
        "set": "".join(f"{one}\n" for one in (*options.set, *seed)),
        "controllers": options.controllers,
        "teleop": options.teleop,
        "lockstep": options.lockstep,
        "allow_code": options.allow_code,
    }
    own = {name: getattr(options, name) for name in ("speed", "out", "stays", "paused", "localization")}
    for name in given_parameters(given):
        if name in {*settings, *own, "seed"}:  # ROS takes two values of different types without an error
            instead = "the first argument" if name == "scenario" else f"the option --{name.replace('_', '-')}"
            sys.stderr.write(f"robotteamsim.ros2: -p {name}; expected {instead}\n")
            return 2
    try:
        num_robots = read_scenario(settings.get).team_size
        with lock_domain(_domain()):  # before controllers start, which would answer another simulation
            pass
    except RobotTeamSimError as error:
        sys.stderr.write(f"robotteamsim.ros2: {error}\n")
        return 2
    nodes = [_node("simulation", settings | own, more=given[split + 1 :])]
    if options.controllers == "team":
        nodes.append(_node("controllers", {}))
    elif options.controllers == "nodes":
        nodes += [_node("controller", {"robot_id": i}, namespace=f"/{robot_name(i)}") for i in range(num_robots)]
    return _run(nodes)


def _domain() -> int:
    text = os.environ.get("ROS_DOMAIN_ID", "")
    return int(text) if text.isdecimal() else 0  # the nodes report a wrong one


def _natural(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text}; expected a whole number from 0 on")
    return int(text)


def _parser() -> argparse.ArgumentParser:
    more = "Arguments of ROS for the simulation follow --ros-args, such as -p stamped_cmd_vel:=true."
    parser = argparse.ArgumentParser(prog="python -m robotteamsim.ros2", description=__doc__, epilog=more)
    parser.add_argument("scenario", help="name or file of a scenario")
    parser.add_argument("--robots", type=_natural, default=NOT_SET, metavar="N", help="number of robots")
    parser.add_argument("--seed", type=int, metavar="S", help="seed of all random numbers")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="changes a key of the scenario")
    parser.add_argument("--speed", type=float, default=5.0, help="times real time; 0: as fast as possible (default: 5)")
    parser.add_argument("--lockstep", action="store_true", help="each step waits for all controllers")
    parser.add_argument("--controllers", choices=HOSTED, default="nodes", help="where they run (default: nodes)")
    parser.add_argument("--teleop", type=_natural, default=NOT_SET, metavar="ID", help="id of robot driven by cmd_vel")
    frames = "ground_truth: tf has map -> odom of each robot (default); none: it has not"
    parser.add_argument("--localization", choices=("ground_truth", "none"), default="ground_truth", help=frames)
    parser.add_argument("--out", default="", metavar="FOLDER", help="where mission.json and trajectories go")
    parser.add_argument("--stays", action="store_true", help="go on after the end of the mission")
    parser.add_argument("--paused", action="store_true", help="start paused, see the service /simulation/resume")
    parser.add_argument("--allow-code", action="store_true", help="allow code that the scenario's file names")
    return parser


def _node(
    node: str, parameters: dict[str, Any], namespace: str = "/", more: Sequence[str] = ()
) -> subprocess.Popen[bytes]:
    """Start a node as its script does. Args: more: arguments of ROS."""
    values = [part for key, value in parameters.items() for part in ("-p", f"{key}:={json.dumps(value)}")]
    command = (sys.executable, "-c", NODE.format(node=node), "--ros-args", "-r", f"__ns:={namespace}", *values, *more)
    return subprocess.Popen(command, stdin=subprocess.PIPE, env=os.environ | {"ROS_VERSION": "2"})


def _run(nodes: Sequence[subprocess.Popen[bytes]]) -> int:
    """Wait until one of the nodes has ended, and end the others; return the exit status of the mission."""
    signals: list[int] = []
    for number in ending_signals():
        signal.signal(number, lambda number, _: signals.append(number))
    simulation = nodes[0]
    while not signals and all(node.poll() is None for node in nodes):
        time.sleep(CHECK_S)
    is_first = simulation.poll() is not None
    _terminate(nodes)
    for node in nodes:
        with contextlib.suppress(subprocess.TimeoutExpired):
            node.wait(GRACE_S)
        node.kill()
    status = simulation.wait()
    if signals:
        with contextlib.suppress(OSError):  # of a closed terminal
            sys.stderr.write("robotteamsim.ros2: interrupted; /mission/abort ends a mission with its results\n")
        return 128 + signals[0]
    if is_first and status >= 0:
        return status
    who = "the simulation has been killed" if is_first else "a controller has ended, and this ends the mission"
    sys.stderr.write(f"robotteamsim.ros2: {who}\n")
    return 1


def _terminate(nodes: Sequence[subprocess.Popen[bytes]]) -> None:
    for node in nodes:
        node.terminate()


if __name__ == "__main__":
    sys.exit(main())

"""Runs the controllers of a team: all in one process, or each in its own. The scenario says how many there are."""

import importlib
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Sequence
from multiprocessing.connection import wait as wait_for_any
from multiprocessing.process import BaseProcess
from typing import Any

import rosgraph

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.message_parts import robot_name
from robotteamsim.nodes.launched import read_ros1_scenario, ros1_setting_name
from robotteamsim.ros.master import wait_for_master

ENDING_S = 0.5
"""In this time after the end of another process, this one receives the signal that ends a launch [s, wall]."""


def main() -> None:
    """Run all controllers in this process, or fork one for each robot but the first, whose controller runs here."""
    wait_for_master()
    is_team = _parameter(ros1_setting_name("controllers"), "nodes") == "team"
    try:
        num_robots = 1 if is_team else read_ros1_scenario(_parameter).team_size
    except RobotTeamSimError:
        num_robots = 1  # whose node reports the mistake
    if is_team or num_robots == 0:  # a launch ends with this process, also where people are alone
        importlib.import_module("robotteamsim.ros.nodes.controller").main_of_team()
        return
    children = [_fork(robot_id) for robot_id in range(1, num_robots)]
    threading.Thread(target=_end_with_any, args=(children,), daemon=True).start()
    _run_controller(0)


def _parameter(name: str, default: Any) -> Any:
    try:
        return rosgraph.Master("/controllers").getParam(name)
    except rosgraph.MasterError:  # It is not set.
        return default


def _fork(robot_id: int) -> BaseProcess:
    # The modules imported so far are shared in memory.
    name = f"/{robot_name(robot_id)}/controller"
    context = multiprocessing.get_context("fork")
    child = context.Process(target=_run_child, args=(robot_id,), name=name, daemon=True)
    child.start()
    return child


def _run_child(robot_id: int) -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    threading.Thread(target=_end_with_any, args=([parent],), daemon=True).start()
    _run_controller(robot_id)


def _end_with_any(processes: Sequence[Any]) -> None:
    """End this process when one of the others has ended."""
    ended = wait_for_any([process.sentinel for process in processes]) if processes else []
    # At the end of a launch, all processes are ended; the signal to this one may come a little later.
    if importlib.import_module("robotteamsim.ros.node").wait_for_shutdown(ENDING_S):
        return
    for process in processes:
        if process.sentinel in ended:
            sys.stderr.write(f"{process.name} has ended\n")
            os.kill(os.getpid(), signal.SIGTERM)


def _run_controller(robot_id: int) -> None:
    """Become the node of a robot; rospy reads name and namespace when it is imported."""
    os.environ["ROS_NAMESPACE"] = f"/{robot_name(robot_id)}"
    sys.argv = [sys.argv[0], f"_robot_id:={robot_id}"]
    importlib.import_module("robotteamsim.ros.nodes.controller").main()

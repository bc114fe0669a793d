"""Prints the parameters of a robot's amcl; its failure ends `amcl_robot.launch` before any node starts."""

import sys
from pathlib import Path
from typing import Any

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.message_parts import MAP_FRAME, robot_name
from robotteamsim.nodes.launched import read_scenario
from robotteamsim.ros.programs import installed
from robotteamsim.scenario.yaml_text import read_mapping, write
from robotteamsim.setup import resolve
from robotteamsim.wording import counted

ARGUMENTS = ("FILE", "SCENARIO", "ROBOTS", "SEED", "SET", "ROBOT")


def main() -> None:
    """Print the parameters as YAML. If that is not possible, exit with one line and status 2.

    The arguments are a file of parameters, and those of amcl_robot.launch: scenario, robots, seed, set, robot.
    """
    if len(sys.argv) != len(ARGUMENTS) + 1:
        given = counted(len(sys.argv) - 1, "argument")
        sys.stderr.write(f"amcl_parameters: {given}; expected {' '.join(ARGUMENTS)}\n")
        sys.exit(2)
    file, scenario, robots, seed, overrides, robot = sys.argv[1:]
    if seed:
        overrides += f" run.seed={seed}"
    launched = {"scenario": scenario, "robots": int(robots), "set": overrides}
    try:
        parameters = read_mapping(Path(file), file, "parameters") | parameters_of(int(robot), launched)
    except RobotTeamSimError as error:
        sys.stderr.write(f"amcl_robot.launch: {error}\n")
        sys.exit(2)
    sys.stdout.write(write(parameters))


def parameters_of(robot_id: int, launched: dict[str, Any]) -> dict[str, Any]:
    """Return the frames, the noise of the odometry and the start of a robot, as parameters of amcl.

    Args:   launched: the scenario, by the names of the settings of nodes, see `read_scenario`.
    Raises: RobotTeamSimError: amcl is not installed, the scenario has a mistake, or there is no such robot.
    """
    if installed("amcl", "amcl") is None:
        raise RobotTeamSimError(
            "amcl (ROS package amcl) is not installed; install it, or use scenario.launch with another program that"
            " publishes map -> odom"
        )
    robots = resolve(read_scenario(launched.get)).robots
    if not 0 <= robot_id < len(robots):
        raise RobotTeamSimError(f"robot: {robot_id}; expected 0 to {len(robots) - 1}")
    x_m, y_m, yaw_rad = robots[robot_id].start_pose
    name = robot_name(robot_id)
    frames = {"global_frame_id": MAP_FRAME, "odom_frame_id": f"{name}/odom", "base_frame_id": f"{name}/base_link"}
    odometry = robots[robot_id].odometry
    noise = {f"odom_alpha{i}": 0.5 * getattr(odometry, f"alpha{i}") for i in (1, 2, 3, 4)}
    return frames | noise | {"initial_pose_x": x_m, "initial_pose_y": y_m, "initial_pose_a": yaw_rad}

"""The pose that a robot uses as its own."""

from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose
from robotteamsim.scenario.firefighters import centre_body
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Robot, Team
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.world.placement import placed_robots


class Localiser:
    """The robot's pose in `map`: the ground truth, or its known start composed with its odometry.

    With localisation tf, the nodes of ROS put the pose from tf in place of the ground truth.
    """

    def __init__(self, robot_id: int, scenario: Scenario) -> None:
        self._map_T_odom: Pose | None = None
        if scenario.control.localisation == "odometry":
            self._map_T_odom = Pose(*placed_robots(scenario)[robot_id].start_pose)

    def map_T_base_link(self, reading: RobotReading) -> Pose:  # noqa: N802
        """Return the robot's pose in `map`."""
        if self._map_T_odom is None:
            return reading.true_pose
        return self._map_T_odom @ reading.odometry.pose.pose


def check_headless(scenario: Scenario) -> None:
    """Raises: ScenarioError: the robots' poses come from tf, which only nodes of ROS can read."""
    if scenario.control.localisation == "tf":
        key = "control.localisation"
        text = f"{key}: 'tf' is available only in ROS; expected 'ground_truth' or 'odometry'"
        raise ScenarioError(scenario.origin.line(text, key))


def body_of(robot_id: int, scenario: Scenario) -> Robot:
    """Return one member of the team. Raises: ScenarioError: no such robot."""
    if not 0 <= robot_id < scenario.team_size:
        raise ScenarioError(f"{scenario.name}: there is no robot {robot_id}, only 0 to {scenario.team_size - 1}")
    if robot_id < scenario.num_robots:
        return scenario.robots if isinstance(scenario.robots, Team) else scenario.robots[robot_id]
    return scenario.firefighters if scenario.firefighters and robot_id in scenario.firefighter_ids else centre_body()

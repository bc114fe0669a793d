"""The pose that a robot uses as its own."""

from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.setup import Setup


class Localiser:
    """The robot's pose in `map`: the ground truth, or its known start composed with its odometry.

    With localisation tf, the nodes of ROS put the pose from tf in place of the ground truth.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        self._map_T_odom: Pose | None = None
        if setup.scenario.control.localisation == "odometry":
            self._map_T_odom = Pose(*setup.robots[robot_id].start_pose)

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

"""The pose that a robot uses as its own."""

from __future__ import annotations

from robotteamsim.geometry import Pose
from robotteamsim.interface import Observation
from robotteamsim.setup import Setup


class OwnPose:
    """The pose of one robot in `map` by `control.localisation`: the true one, or its known start and its odometry.

    With localisation tf, the nodes of ROS put the pose from tf in place of the true one.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        by_odometry = setup.scenario.control.localisation == "odometry"
        self._map_T_odom = Pose(*setup.robots[robot_id].start_pose) if by_odometry else None

    def at(self, observation: Observation) -> Pose:
        """Return the pose in a step."""
        robot = observation.robot
        return robot.true_pose if self._map_T_odom is None else self._map_T_odom @ robot.odometry.pose.pose

"""All that robots perceive of the world by themselves: laser, odometry, contact."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.geometry import PoseReading
from robotteamsim.rng import stream
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.laser import Laser
from robotteamsim.sensing.odometry import Odometry
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.world import World


class RobotSensors:
    """The sensors of all robots of a world. Random streams: ("odometry", id) and ("laser", id)."""

    def __init__(self, world: World, robots: Sequence[PlacedRobot], seed: int) -> None:
        """Args: robots: those that the world was built with, in id order."""
        self._world = world
        self._robots = tuple(robots)
        self._seed = seed
        lasers = {model: Laser(model, world) for model in dict.fromkeys(robot.laser for robot in self._robots)}
        self._lasers = [lasers[robot.laser] for robot in self._robots]
        self.reset()

    def read(self) -> list[RobotReading]:
        """Return every robot's reading after the step that the world made last, in id order.

        Odometry adds that step's motion, so this is called once after each step.
        """
        world = self._world
        state = zip(world.poses(), world.twists(), world.motions(), world.in_contact(), strict=True)
        return [
            RobotReading(
                ground_truth=PoseReading.from_pose(pose),
                twist=twist,
                odometry=self._odometries[robot_id].step(motion, twist),
                ranges_m=self._lasers[robot_id].scan(robot_id, self._laser_streams[robot_id]),
                in_contact=in_contact,
            )
            for robot_id, (pose, twist, motion, in_contact) in enumerate(state)
        ]

    def reset(self) -> None:
        """Begin again as new, after `World.reset`: odometry at its origin, all random streams from their start."""
        step_s = self._world.step_ns * 1e-9
        self._laser_streams = [stream(self._seed, "laser", robot_id) for robot_id in range(len(self._robots))]
        self._odometries = [
            Odometry(robot.odometry, step_s, stream(self._seed, "odometry", robot_id))
            for robot_id, robot in enumerate(self._robots)
        ]

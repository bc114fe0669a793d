"""Judges the mission of robots that something else moves: another simulator, a recording, real robots."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision
from robotteamsim.mission import Sensed
from robotteamsim.sensing.readings import OdometryReading, RobotReading
from robotteamsim.setup import Setup
from robotteamsim.simulation.record import Observer, StepRecord
from robotteamsim.simulation.simulation import Simulation
from robotteamsim.simulation.trial import Trial

_NOWHERE = Pose(math.nan, math.nan, math.nan)
_NOTHING = Decision()
_NO_RANGES = np.zeros(0, dtype=np.float32)


class Judge:
    """A mission for which the poses and the decisions of its robots are given.

    All else is computed as in a simulation: voices, radio, people, fire, doors that the schedule moves, and the rules.
    The mission begins with the first step.
    """

    def __init__(self, setup: Setup, observers: Sequence[Observer] = ()) -> None:
        """Begin. Raises: RecordingError: an observer cannot write."""
        self._poses: Sequence[PoseReading | None] = ()
        self._touching: Sequence[bool] = ()
        self._decisions: Sequence[Decision] = ()
        self._simulation = Simulation(setup, controllers=self)
        self._simulation.sensors = self
        self._simulation.mission.start()
        self.trial = Trial(setup, observers)

    @property
    def faults(self) -> Sequence[str]:
        """As for all controllers."""
        return [""] * len(self._poses)

    def follow(
        self, poses: Sequence[PoseReading | None], touching: Sequence[bool], decisions: Sequence[Decision]
    ) -> StepRecord:
        """Judge a step, and show it to the observers.

        Args: poses:     true ones of each robot at the end of the step; None: it is not there.
              touching:  whether each robot touches something.
              decisions: of each robot; their commands have no effect.
        """
        self._poses, self._touching, self._decisions = poses, touching, decisions
        simulation = self._simulation
        for robot_id, pose in enumerate(poses):
            # Where there is no room, the body stays where it was.
            with contextlib.suppress(PlacementError, ValueError):
                if pose is None:
                    simulation.remove_robot(robot_id)
                elif not simulation.world.present[robot_id]:
                    simulation.spawn_robot(robot_id, pose.pose)
                else:
                    simulation.world.set_pose(robot_id, pose.pose)
        record = simulation.step()
        self.trial.add(record)
        return record

    def read(self) -> _core.state.State:
        """As for all sensors."""
        state = _core.state.State(len(self._poses))
        for robot_id, (pose, touches) in enumerate(zip(self._poses, self._touching, strict=True)):
            if pose is not None:
                odometry = OdometryReading(pose, Twist())
                state.put_reading(robot_id, RobotReading(pose, Twist(), odometry, _NO_RANGES, touches))
            else:
                state.place(robot_id, _NOWHERE)
        return state

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        there = sensed.present.tolist()
        return tuple(one if is_there else _NOTHING for one, is_there in zip(self._decisions, there, strict=True))

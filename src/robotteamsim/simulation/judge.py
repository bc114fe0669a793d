"""Judges the mission of robots that something else moves: another simulator, a recording, real robots."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

from robotteamsim import _core
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose
from robotteamsim.interface import Decision
from robotteamsim.mission import Sensed
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.setup import Setup
from robotteamsim.simulation.record import Observer, StepRecord
from robotteamsim.simulation.simulation import Simulation
from robotteamsim.simulation.trial import Trial

_NOWHERE = Pose(math.nan, math.nan, math.nan)
_NOTHING = Decision()


class Judge:
    """A mission whose robots are where they are told to be, and whose controllers say what they are told to say.

    All else is computed as in a simulation: voices, radio, people, fire, doors that the schedule moves, and the rules.
    The mission begins with the first step.
    """

    def __init__(self, setup: Setup, observers: Sequence[Observer] = ()) -> None:
        """Begin. Raises: RecordingError: an observer cannot write."""
        self._readings: Sequence[RobotReading | None] = ()
        self._decisions: Sequence[Decision] = ()
        self._simulation = Simulation(setup, controllers=self)
        self._simulation.sensors = self
        self._simulation.mission.start()
        self.trial = Trial(setup, observers)

    @property
    def faults(self) -> Sequence[str]:
        """As for all controllers."""
        return [""] * len(self._readings)

    def follow(self, readings: Sequence[RobotReading | None], decisions: Sequence[Decision]) -> StepRecord:
        """Judge a step, and show it to the observers.

        Args: readings:  of each robot at the end of the step; None: it is not there.
              decisions: of each robot; their commands have no effect.
        """
        self._readings, self._decisions = readings, decisions
        simulation = self._simulation
        for robot_id, reading in enumerate(readings):
            # Where there is no room, the body stays where it was.
            with contextlib.suppress(PlacementError, ValueError):
                if reading is None:
                    simulation.remove_robot(robot_id)
                elif not simulation.world.present[robot_id]:
                    simulation.spawn_robot(robot_id, reading.true_pose)
                else:
                    simulation.world.set_pose(robot_id, reading.true_pose)
        record = simulation.step()
        self.trial.add(record)
        return record

    def read(self) -> _core.state.State:
        """As for all sensors."""
        state = _core.state.State(len(self._readings))
        for robot_id, reading in enumerate(self._readings):
            if reading is not None:
                state.put_reading(robot_id, reading)
            else:
                state.place(robot_id, _NOWHERE)
        return state

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        there = sensed.present.tolist()
        return tuple(one if is_there else _NOTHING for one, is_there in zip(self._decisions, there, strict=True))

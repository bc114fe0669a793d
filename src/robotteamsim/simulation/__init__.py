"""One trial: the step loop, its environment, its records."""

from robotteamsim.simulation.environment import Environment
from robotteamsim.simulation.record import Observer, Result, RobotTotals, StepRecord
from robotteamsim.simulation.simulation import Simulation, true_positions_m
from robotteamsim.simulation.tally import Tally
from robotteamsim.simulation.trajectory_hash import TrajectoryHash

__all__ = [
    "Environment",
    "Observer",
    "Result",
    "RobotTotals",
    "Simulation",
    "StepRecord",
    "Tally",
    "TrajectoryHash",
    "true_positions_m",
]

"""One trial: the step loop, its environment, its records."""

from robotteamsim.simulation.controllers import Controllers, TeamControllers
from robotteamsim.simulation.record import Observer, Result, RobotTotals, StepRecord
from robotteamsim.simulation.simulation import Simulation
from robotteamsim.simulation.trial import TrajectoryHash

__all__ = [
    "Controllers",
    "Observer",
    "Result",
    "RobotTotals",
    "Simulation",
    "StepRecord",
    "TeamControllers",
    "TrajectoryHash",
]

"""Recorders that look on while a trial runs, and the files that they write."""

from robotteamsim.recording.bag import BagWriter
from robotteamsim.recording.results import ResultWriter, result_summary
from robotteamsim.recording.trajectories import TumWriter
from robotteamsim.simulation.trajectory_hash import TrajectoryHash

__all__ = ["BagWriter", "ResultWriter", "TrajectoryHash", "TumWriter", "result_summary"]

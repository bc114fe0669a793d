"""Recorders: observers that write a trial to files."""

from typing import TYPE_CHECKING, Any

from robotteamsim.recording.results import ResultWriter, result_summary
from robotteamsim.recording.trajectories import TumWriter
from robotteamsim.simulation.trajectory_hash import TrajectoryHash

if TYPE_CHECKING:
    from robotteamsim.recording.bag import BagWriter

__all__ = ["BagWriter", "ResultWriter", "TrajectoryHash", "TumWriter", "result_summary"]


def __getattr__(name: str) -> Any:
    """Import `BagWriter` on first use, because rosbags is slow to load and few processes write a bag."""
    if name != "BagWriter":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from robotteamsim.recording.bag import BagWriter

    return BagWriter

"""Recorders: observers that write a trial to files."""

from typing import TYPE_CHECKING, Any

from robotteamsim.recording.results import ResultWriter, result_summary
from robotteamsim.recording.trajectories import TumWriter
from robotteamsim.simulation.trial import TrajectoryHash

if TYPE_CHECKING:
    from robotteamsim.recording.bag_writer import BagWriter
    from robotteamsim.recording.mcap_writer import McapWriter

__all__ = ["BagWriter", "McapWriter", "ResultWriter", "TrajectoryHash", "TumWriter", "result_summary"]


def __getattr__(name: str) -> Any:
    """Import writers of bags on first use, because rosbags is slow to load and few processes write a bag."""
    if name == "BagWriter":
        from robotteamsim.recording.bag_writer import BagWriter

        return BagWriter
    if name == "McapWriter":
        from robotteamsim.recording.mcap_writer import McapWriter

        return McapWriter
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

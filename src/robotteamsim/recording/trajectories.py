"""Writes trajectories as text files that evo and most plotting tools can read."""

import math
from pathlib import Path

from robotteamsim.geometry import PoseReading
from robotteamsim.message_parts import robot_name
from robotteamsim.recording.files import prepare_folder, remove_empty, write_atomically
from robotteamsim.setup import Setup
from robotteamsim.simulation import Result, StepRecord

TUM_HEADER = "# timestamp tx ty tz qx qy qz qw"


class TumWriter:
    """Writes each robot's true trajectory into `folder`/robot_<id>.tum when the mission has ended.

    The format is that of the TUM RGB-D benchmark: one pose in `map` per line, [s], [m], unit quaternion. Steps in which
    a robot was absent have no line.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._steps: list[tuple[int, list[PoseReading]]] = []
        self._created: list[Path] = []

    def begin(self, setup: Setup) -> None:
        """Raises: RecordingError: the folder cannot be written."""
        self._steps = []
        self._created = prepare_folder(self._folder)

    def step(self, record: StepRecord) -> None:
        """Keep the true poses of one step."""
        self._steps.append((record.sim_time_ns, [reading.ground_truth for reading in record.readings]))

    def end(self, result: Result) -> None:
        """Write all trajectories, and delete those of further robots of a mission before. Raises: RecordingError."""
        written = set()
        for robot_id in range(len(result.robots)):
            steps = [(time_ns, poses[robot_id]) for time_ns, poses in self._steps]
            lines = [tum_line(time_ns, pose) for time_ns, pose in steps if not math.isnan(pose.x_m)]
            path = self._folder / f"{robot_name(robot_id)}.tum"
            write_atomically(path, "\n".join([TUM_HEADER, *lines, ""]))
            written.add(path)
        for path in self._folder.glob("robot_*.tum"):
            if path not in written and path.stem.removeprefix("robot_").isdecimal():
                path.unlink()

    def abandon(self) -> None:
        """Discard the steps so far, and the folder if it is new and empty."""
        self._steps = []
        remove_empty(self._created)


def tum_line(time_ns: int, pose: PoseReading) -> str:
    """Return one line of a TUM file; its numbers are exact."""
    seconds, nanoseconds = divmod(time_ns, 10**9)
    return f"{seconds}.{nanoseconds:09d} {pose.x_m!r} {pose.y_m!r} 0 0 0 {pose.qz!r} {pose.qw!r}"

"""One number for all trajectories of a trial: equal hashes mean equal bits."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import numpy as np
from msgspec.structs import astuple

from robotteamsim.geometry import PoseReading


class TrajectoryHash:
    """SHA-256 over the true poses of all robots in every step.

    Of each step: the stamp as a little-endian int64 [ns], then x, y, qz, qw of each robot in id order as little-endian
    float64. It runs from the first step to the step in which the mission ended, both included.
    """

    def __init__(self) -> None:
        self._sha256 = hashlib.sha256()

    def update(self, sim_time_ns: int, ground_truth: Sequence[PoseReading] | np.ndarray) -> None:
        """Add one step. Args: ground_truth: as an array: shape (n, 4)."""
        rows = ground_truth if isinstance(ground_truth, np.ndarray) else np.array(list(map(astuple, ground_truth)))
        self._sha256.update(sim_time_ns.to_bytes(8, "little", signed=True))
        self._sha256.update(np.asarray(rows, "<f8").tobytes())

    def hexdigest(self) -> str:
        """Return the hash of the steps so far, 64 hexadecimal digits."""
        return self._sha256.hexdigest()

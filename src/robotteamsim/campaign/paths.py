"""The paths of a trial's robots, in a compact form."""

import struct
import zlib

import numpy as np

from robotteamsim.errors import CampaignError
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, StepRecord

PERIOD_S = 1.0
"""Time between two stored positions; rounded to a whole number of steps, at least one."""

_UNIT_M = 0.01
_HEADER = struct.Struct("<II")
_MOST_DEFLATED = 1100
"""Deflated data grow by at most 1032 times [zlib]."""


class PathLog(Observer):
    """Records the true positions of all robots once a second, to a centimetre.

    An absent robot has its last recorded position, or its start pose if there is none.
    """

    def begin(self, setup: Setup) -> None:
        """Clear the log."""
        self._every = max(round(PERIOD_S / setup.scenario.run.step_s), 1)
        self._starts_m = np.array([robot.start_pose[:2] for robot in setup.robots]).reshape(-1, 2)
        self._positions_m: list[np.ndarray] = []

    def step(self, record: StepRecord) -> None:
        """Record the first step, and then one per period."""
        if (record.step_index - 1) % self._every == 0:
            last_m = self._positions_m[-1] if self._positions_m else self._starts_m
            self._positions_m.append(np.where(record.present[:, None], record.state.positions_m, last_m))

    def encoded(self) -> bytes:
        """Return the paths, as `decode_paths` reads them."""
        return encode_paths(np.array(self._positions_m, dtype=np.float64))


def encode_paths(positions_m: np.ndarray) -> bytes:
    """Return paths as bytes, the same for equal paths; about 2 bytes per robot and second.

    Two little-endian uint32, samples and robots; then, deflated, the differences from sample to sample as little-endian
    int32 [cm], starting from (0, 0). Args: positions_m: shape (samples, robots, 2), in `map` [m].
    """
    units = np.rint(positions_m / _UNIT_M).astype("<i4")
    differences = np.diff(units, axis=0, prepend=np.zeros_like(units[:1]))
    return _HEADER.pack(*units.shape[:2]) + zlib.compress(differences.tobytes(), level=6)


def decode_paths(data: bytes) -> np.ndarray:
    """Return positions [m] in `map`, shape (samples, robots, 2), to a centimetre. Raises: CampaignError: no paths."""
    try:
        samples, robots = _HEADER.unpack_from(data)
        size = samples * robots * 8
        if not samples or size > _MOST_DEFLATED * len(data):
            raise ValueError(f"{len(data)} bytes cannot have {samples} positions of {robots} robots")
        inflating = zlib.decompressobj()
        inflated = inflating.decompress(data[_HEADER.size :], size + 1)
        if not inflating.eof or len(inflated) != size:
            raise ValueError(f"they are not {samples} positions of {robots} robots")
        differences = np.frombuffer(inflated, dtype="<i4").reshape(samples, robots, 2)
    except (struct.error, zlib.error, ValueError) as error:
        raise CampaignError(f"stored paths cannot be read: {error}") from None
    return np.asarray(np.cumsum(differences, axis=0, dtype=np.int64) * _UNIT_M)

"""The links of a team as bits, for large teams: the matrices of 1000 robots have 30 MB, their links 0.25 MB."""

import msgspec
import numpy as np

from robotteamsim.network.graph import hop_count
from robotteamsim.network.messages import NetworkState, Traffic


class CompactLinks(msgspec.Struct, frozen=True, eq=False):
    """The links of n robots in one step.

    present:           bool, shape (n,).
    adjacency:         uint8, shape (n, (n + 7) // 8): row i has a bit for each robot, the lowest first.
    endangered:        in the same form.
    num_links, num_endangered: numbers of direct links, and of the endangered ones among them.
    fiedler_value, traffic: as in `NetworkState`.
    weakened:          int64, shape (k, 2): pairs of ids, the smaller one first, whose link has become endangered, or
                       has broken, since the step encoded before. In the first one, all endangered links.
    weakened_rssi_dbm: float64, shape (k,); -inf if one of the two has left.
    """

    present: np.ndarray
    adjacency: np.ndarray
    endangered: np.ndarray
    num_links: int
    num_endangered: int
    fiedler_value: float
    traffic: Traffic
    weakened: np.ndarray
    weakened_rssi_dbm: np.ndarray

    @property
    def swarm_connectivity(self) -> float:
        """C_s of eq. (34): Fiedler value over the number of robots present."""
        return self.fiedler_value / max(int(np.count_nonzero(self.present)), 1)


class LinksEncoder:
    """Encodes the network step by step."""

    def __init__(self) -> None:
        nobody = np.zeros((0, 0), dtype=np.bool_)
        self._version = -1
        self._adjacency = self._endangered = nobody
        self._bits = nobody.view(np.uint8), nobody.view(np.uint8)
        self._counts = 0, 0

    def encode(self, network: NetworkState) -> CompactLinks:
        """Return the links of a step; those of unchanged matrices have the same arrays as in the step before."""
        weakened = np.zeros((0, 2), dtype=np.int64)
        adjacency, endangered = network.adjacency, network.endangered
        if network.version != self._version:
            self._version = network.version
            weakened = self._weakened(adjacency, endangered)
            self._adjacency, self._endangered = adjacency, endangered
            self._bits = _packed(adjacency), _packed(endangered)
            self._counts = int(np.count_nonzero(adjacency)) // 2, int(np.count_nonzero(endangered)) // 2
        return CompactLinks(
            np.diagonal(network.hop_count) >= 0,
            *self._bits,
            *self._counts,
            network.fiedler_value,
            network.traffic,
            weakened,
            network.rssi_dbm[weakened[:, 0], weakened[:, 1]],
        )

    def _weakened(self, adjacency: np.ndarray, endangered: np.ndarray) -> np.ndarray:
        if self._adjacency.shape == adjacency.shape:
            was_safe, was_endangered = self._adjacency & ~self._endangered, self._endangered
            weak = (endangered & ~was_endangered) | (was_safe & ~(adjacency & ~endangered))
        else:
            weak = endangered
        pairs = np.argwhere(weak)
        return np.asarray(pairs[pairs[:, 0] < pairs[:, 1]], dtype=np.int64)


def unpacked(bits: np.ndarray, num_robots: int) -> np.ndarray:
    """Return the matrix of rows of bits: bool, shape (n, n)."""
    return np.unpackbits(bits, axis=1, count=num_robots, bitorder="little").view(np.bool_)


def hops_among(adjacency: np.ndarray, present: np.ndarray) -> np.ndarray:
    """Return the hop counts of a team: int32, shape (n, n), as in `NetworkState`; -1 on the diagonal for absent robots.

    Raises: ValueError: the matrix is not symmetric, or not zero on the diagonal.
    """
    hops = hop_count(adjacency)
    absent = np.flatnonzero(~present)
    hops[absent, absent] = -1
    return hops


def row_bytes(num_robots: int) -> int:
    """Return the number of bytes in a row of bits."""
    return (num_robots + 7) // 8


def _packed(matrix: np.ndarray) -> np.ndarray:
    return np.packbits(matrix, axis=1, bitorder="little")

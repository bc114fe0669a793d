"""Quantities of the undirected graph of robots and links."""

import numpy as np

from robotteamsim import _core


def hop_count(adjacency: np.ndarray) -> np.ndarray:
    """Return the smallest number of hops between all pairs of robots.

    The values of C of eq. (18-20) [dissertation], by breadth-first search.
    Args:    adjacency: bool, shape (n, n), symmetric, zero diagonal: A of eq. (17).
    Returns: int32, shape (n, n); 0 on the diagonal, -1 if no path exists.
    Raises:  ValueError: not square, not symmetric, or not zero on the diagonal.
    """
    return _core.network.hop_count(_matrix(adjacency))


def next_hop(hops: np.ndarray, rssi_dbm: np.ndarray, holder: int, receiver: int) -> int:
    """Return the next hop of a message on a shortest path; -1 if no path exists.

    Among equally short paths, the one over the strongest link, then over the lowest id.
    Args: hops: int32, shape (n, n), from `hop_count`.  rssi_dbm: float64, shape (n, n).
    """
    if hops[holder, receiver] < 1:
        return -1
    candidates = np.flatnonzero((hops[holder] == 1) & (hops[:, receiver] == hops[holder, receiver] - 1))
    return int(candidates[np.argmax(rssi_dbm[holder, candidates])])


def fiedler_value(adjacency: np.ndarray) -> float:
    """Return the algebraic connectivity (Fiedler value) of an undirected graph.

    Second-smallest eigenvalue of the Laplacian Lp = D - A [dissertation, eq. 33; fiedler1973], with a relative error
    below 1e-9 (1e-7 if the next eigenvalue is within 1e-5 of it); the same links give a bit-identical value.
    Args:    adjacency: bool, shape (n, n), symmetric, zero diagonal.
    Returns: > 0 if the team is connected, exactly 0 if it is split; 1 for a single robot, because the value of a
             complete graph is its number of robots.
    Raises:  ValueError: not square, not symmetric, not zero on the diagonal, or no robots.
    """
    return _core.network.fiedler_value(_matrix(adjacency))


def newly_endangered(adjacency: np.ndarray, endangered: np.ndarray, hops: np.ndarray) -> np.ndarray:
    """Return the links that become endangered in each step.

    These are links at or above the endangered threshold that are below it, or lost, in the next step. Links that are
    endangered in the first step, or when a robot arrives, also count. A robot that leaves endangers no link.

    Args:    adjacency, endangered: bool, shape (steps, n, n), symmetric.
             hops: int32, shape (steps, n, n), from `NetworkState`: -1 on the diagonal for absent robots.
    Returns: bool, shape (steps, n, n), symmetric.
    """
    is_there = np.diagonal(hops, axis1=1, axis2=2) >= 0
    both = is_there[:, :, np.newaxis] & is_there[:, np.newaxis, :]
    safe = adjacency & ~endangered
    begun = endangered.copy()
    begun[1:] = np.where(both[:-1], safe[:-1] & ~safe[1:], endangered[1:])
    return np.asarray(begun & both)


def _matrix(adjacency: np.ndarray) -> np.ndarray:
    adjacency = np.asarray(adjacency, dtype=bool)
    if adjacency.ndim != 2:
        raise ValueError(f"adjacency must have shape (n, n), got {adjacency.shape}")
    return adjacency

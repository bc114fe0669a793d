"""Hop counts by the recurrence of the dissertation, eq. (18-20), as a second method."""

import numpy as np


def connectivity_matrix(adjacency: np.ndarray) -> np.ndarray:
    """Return C of a graph, int32, shape (n, n); 0 on the diagonal and if no path exists."""
    a = np.asarray(adjacency, dtype=np.int32)
    n = len(a)
    c = a.copy()
    for k in range(2, n):
        b = np.where((c == 0) & (c @ a > 0), k, 0).astype(np.int32)  # (19)
        np.fill_diagonal(b, 0)
        c += b  # (20)
    return c

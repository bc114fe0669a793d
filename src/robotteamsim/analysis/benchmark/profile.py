"""Performance profiles [dolan2002]."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """The share of problems that one solver solves within a factor of the best solver's time.

    ratios: ascending, from 1, the factors at which the share increases; shape (n,).
    shares: from each factor on; shape (n,).
    """

    ratios: np.ndarray
    shares: np.ndarray

    def at(self, ratio: float) -> float:
        """Return the share of problems that are solved within this factor."""
        index = int(np.searchsorted(self.ratios, ratio, side="right")) - 1
        return float(self.shares[index]) if index >= 0 else 0.0


def profiles(times: Mapping[str, np.ndarray]) -> dict[str, Profile]:
    """Return the profile of each solver.

    The performance ratio of a solver on a problem is its time over the least time of all solvers; rho(tau) is the share
    of problems with a ratio of at most tau. A problem that no solver solves counts against all of them.

    Args:   times: of each solver on the same problems, in the same order, above 0; infinity: not solved.
    Raises: ValueError: lengths differ, there are no problems, or a time is not above 0.
    """
    if not times or len({len(each) for each in times.values()}) != 1:
        raise ValueError("times must be of the same problems")
    table = np.stack([np.asarray(each, dtype=float) for each in times.values()])
    if table.shape[1] == 0 or not (table > 0.0).all():
        raise ValueError("times must be above 0, of at least one problem")
    best = table.min(axis=0)
    ratios = np.where(np.isfinite(table), table / np.where(np.isfinite(best), best, 1.0), np.inf)
    return {name: _profile(row) for name, row in zip(times, ratios, strict=True)}


def _profile(ratios: np.ndarray) -> Profile:
    solved = np.sort(ratios[np.isfinite(ratios)])
    at, counts = np.unique(solved, return_counts=True)
    shares = np.cumsum(counts) / len(ratios)
    if len(at) == 0 or at[0] > 1.0:
        at, shares = np.concatenate(([1.0], at)), np.concatenate(([0.0], shares))
    return Profile(at, shares)

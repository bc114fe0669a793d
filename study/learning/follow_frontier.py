"""A policy that is not learned: it drives to the frontier that observations of `explore_unknown` show.

What it reaches, an observation is sufficient for. `python -m study.learning.tasks --task explore_unknown --controller
study.learning.follow_frontier:FollowFrontier` measures it.
"""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.learning import PolicyController
from robotteamsim.learning.tasks import FoundObserve


def follow(vector: np.ndarray) -> np.ndarray:
    """Return the action that drives along the path to the frontier; without one, it stands.

    Args: vector: an observation of `FoundObserve`, of which only the last four numbers are used.
    """
    there_is, ahead, left, _ = vector[-4:].tolist()
    if not there_is:
        return np.zeros(2, np.float32)
    bearing_rad = math.atan2(left, ahead)
    return np.array((max(math.cos(bearing_rad), 0.0) ** 2, np.clip(1.5 * bearing_rad, -1.0, 1.0)), np.float32)


class FollowFrontier(PolicyController):
    """Drives by `follow`."""

    observe = FoundObserve

    def choose(self, vector: np.ndarray) -> np.ndarray:
        """See `PolicyController`."""
        return follow(vector)

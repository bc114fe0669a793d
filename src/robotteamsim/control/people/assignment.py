"""Who goes to whom, so that the sum of all paths is as short as possible."""

from __future__ import annotations

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.extras import missing_extra

PRICE_STEP_M = 0.1
"""The total of an auction is at most this much above the shortest [m]."""


def hungarian(costs: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs (row, column) with the least total cost, by SciPy's `linear_sum_assignment` [crouse2016].

    Args:   costs: float64, shape (n, m), finite; min(n, m) pairs are assigned.
    Raises: ScenarioError: SciPy is not installed.
    """
    try:
        from scipy.optimize import linear_sum_assignment
    except ImportError as error:
        text = missing_extra(error) or str(error)
        raise ScenarioError(f"firefighters.dispatch.method: hungarian: {text}; or choose auction") from None
    rows, columns = linear_sum_assignment(costs)
    return list(zip(rows.tolist(), columns.tolist(), strict=True))


def auction(costs: np.ndarray) -> list[tuple[int, int]]:
    """Return pairs (row, column) whose total is at most PRICE_STEP_M above the least, by an auction [bertsekas1988].

    Each bidder without an object raises the price of the object that is best for them until it is only just so. The
    smaller side bids. Args: as `hungarian`.
    """
    if costs.shape[0] > costs.shape[1]:
        return sorted((row, column) for column, row in auction(costs.T))
    num_bidders, num_objects = costs.shape
    if num_bidders == 0:
        return []
    step_m = PRICE_STEP_M / num_bidders
    prices = np.zeros(num_objects)
    owner = np.full(num_objects, -1)
    waiting = list(range(num_bidders))[::-1]
    while waiting:
        bidder = waiting.pop()
        values = -costs[bidder] - prices
        best = int(np.argmax(values))
        second = np.max(np.delete(values, best)) if num_objects > 1 else values[best]
        prices[best] += values[best] - second + step_m
        if owner[best] >= 0:
            waiting.append(int(owner[best]))
        owner[best] = bidder
    return sorted((int(bidder), column) for column, bidder in enumerate(owner.tolist()) if bidder >= 0)


METHODS = {"hungarian": hungarian, "auction": auction}
"""By the name in `firefighters.dispatch.method`."""

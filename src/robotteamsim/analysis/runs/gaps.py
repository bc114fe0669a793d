"""Steps that a bag lacks: a recorder that is too slow drops messages, and totals computed without them are wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.runs.tracks import Absence

_ON_GRID = 0.05
"""Largest distance of an interval from a multiple of the step, as a share of the step, where stamps are simulated."""
_MOST_ON_GRID = 0.95
"""Share of the intervals that are such multiples."""
_SHORT = 0.1
"""Quantile of the intervals that is one step, if the stamps are simulated: it holds up to 9 of 10 lost messages."""


@dataclass(frozen=True, slots=True)
class Gap:
    """The steps in which a topic has no message.

    robot:   whose topic it is; "" if it is of the team.
    missing: number of such steps, by the stamps.  expected: of all steps from the topic's first message on.
    totals:  names of the totals that depend on the topic, as in `RobotTotals`, `NetworkTotals` and `RunTotals`.
    """

    topic: str
    robot: str
    missing: int
    expected: int
    totals: tuple[str, ...]


def missing_steps(stamps_ns: np.ndarray, absences: Sequence[Absence] = (), end_ns: int | None = None) -> int:
    """Return the number of steps that a topic with one message per step lacks, from its first message on.

    The step is the shortest usual interval if the intervals are its multiples, as in a simulation. Otherwise, as with
    the clocks of real robots, it is the median, and an interval of more than one and a half lacks a message.
    Args:
        stamps_ns: ascending, each once, shape (n,).
        absences:  of the robot; intervals with one lack nothing.
        end_ns:    stamp of the last step of the mission; None: the topic ends with its last message.
    """
    if len(stamps_ns) < 3:
        return 0
    step_ns = _step_ns(np.diff(stamps_ns))
    edges_ns = stamps_ns if end_ns is None else np.append(stamps_ns, max(end_ns, stamps_ns[-1]) + step_ns)
    steps = np.rint(np.diff(edges_ns) / step_ns).astype(np.int64) - 1
    for gone_ns, came_ns in absences:
        steps[(edges_ns[1:] > gone_ns) & (edges_ns[:-1] < came_ns)] = 0
    return int(steps[steps > 0].sum())


def _step_ns(intervals_ns: np.ndarray) -> float:
    shortest = float(np.quantile(intervals_ns, _SHORT))
    multiples = intervals_ns / shortest
    on_grid = np.abs(multiples - np.rint(multiples)) < _ON_GRID
    return shortest if on_grid.mean() >= _MOST_ON_GRID else float(np.median(intervals_ns))

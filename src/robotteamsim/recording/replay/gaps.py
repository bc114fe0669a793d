"""Steps that a bag lacks: a recorder that is too slow drops messages, and totals computed without them are wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.recording.replay.tracks import Absence

_ON_GRID = 0.05
"""Largest distance of an interval from a multiple of the step, as a share of the step, where stamps are simulated."""
_MOST_ON_GRID = 0.95
"""Share of the intervals that are such multiples."""
_SHORT, _LONG = 0.1, 0.9
"""Quantiles of the intervals. The short one is one step, if the stamps are simulated, also where 8 of 10 messages are
lost at random; the long one is 11 steps then."""
_LEAST_OF_LONG = 0.04
"""A step is at least this share of the long interval; shorter intervals are those within bursts of messages."""


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


def missing_steps(
    stamps_ns: np.ndarray, absences: Sequence[Absence] = (), end_ns: int | None = None, step_ns: float | None = None
) -> int:
    """Return the number of steps that a topic with one message per step lacks, from its first message on.

    Args:
        stamps_ns: ascending, each once, shape (n,).
        absences:  of the robot; intervals with one lack nothing.
        end_ns:    stamp of the last step of the mission; None: the topic ends with its last message.
        step_ns:   of the topic, see `usual_step_ns`; None if it is not known: the topic lacks nothing.
    """
    if len(stamps_ns) == 0 or step_ns is None:
        return 0
    edges_ns = stamps_ns if end_ns is None else np.append(stamps_ns, max(end_ns, stamps_ns[-1]) + step_ns)
    steps = np.rint(np.diff(edges_ns) / step_ns).astype(np.int64) - 1
    for gone_ns, came_ns in absences:
        steps[(edges_ns[1:] > gone_ns) & (edges_ns[:-1] < came_ns)] = 0
    return int(steps[steps > 0].sum())


def usual_step_ns(stamps_ns: np.ndarray) -> float | None:
    """Return the step of a topic with one message per step; None for fewer than three messages, which do not show it.

    It is the shortest usual interval if the intervals are its multiples, as in a simulation. Otherwise, as with the
    clocks of real robots, it is the median, and an interval of more than one and a half lacks a message. Of messages in
    bursts, it is a long interval: nobody knows the step within them.
    Args: stamps_ns: ascending, each once, shape (n,).
    """
    if len(stamps_ns) < 3:
        return None
    intervals_ns = np.diff(stamps_ns)
    shortest, median, longest = np.quantile(intervals_ns, (_SHORT, 0.5, _LONG))
    multiples = intervals_ns / shortest
    on_grid = np.abs(multiples - np.rint(multiples)) < _ON_GRID
    if shortest >= _LEAST_OF_LONG * longest and on_grid.mean() >= _MOST_ON_GRID:
        return float(shortest)
    return float(median if median >= _LEAST_OF_LONG * longest else longest)

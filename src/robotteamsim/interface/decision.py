"""What a controller returns in each step."""

from __future__ import annotations

from typing import NamedTuple

from robotteamsim.geometry import Twist
from robotteamsim.network.messages import Message

OUTSIDE = -1
"""In place of its swarm: the robot is socially excluded."""


class Decision(NamedTuple):
    """What a controller decides in one step.

    twist:        command in `base_link`.
    outbox:       messages to send, delivered in the next step where a path of links exists.
    excluded:     whether the robot is socially excluded.
    goal_m:       where it drives to, in `map` [m]; None when it has no goal.
    local_best:   value of its local best (larger is better), for display.
    search_counter: SC of its swarm, for display.
    swarm:        number of the swarm that it belongs to, OUTSIDE where excluded; 0 where there are no swarms.
    fault:        why its controller was given up, in one line; "": it works. The robot then stands still.
    """

    twist: Twist = Twist()
    outbox: tuple[Message, ...] = ()
    excluded: bool = False
    goal_m: tuple[float, float] | None = None
    local_best: float = 0.0
    search_counter: int = 0
    swarm: int = 0
    fault: str = ""

"""What a controller returns in each step."""

import msgspec

from robotteamsim.geometry import Twist
from robotteamsim.network.messages import Message

OUTSIDE = -1
"""`Decision.swarm` of a robot that is socially excluded."""


class Decision(msgspec.Struct, frozen=True, gc=False):
    """All that one controller returns in one step.

    twist:        velocity command in `base_link`.
    outbox:       messages to send, delivered in the next step where a path of links exists.
    excluded:     whether the robot is socially excluded.
    goal_m:       where it drives to, in `map` [m]; None when it has no goal.
    local_best:   value of its local best (larger is better), for display.
    search_counter: SC of its swarm, for display.
    swarm:        number of its swarm; OUTSIDE when excluded, 0 where there are no swarms.
    fault:        why its controller was stopped, in one line; "" while it works. A stopped robot stands still.
    """

    twist: Twist = Twist()
    outbox: tuple[Message, ...] = ()
    excluded: bool = False
    goal_m: tuple[float, float] | None = None
    local_best: float = 0.0
    search_counter: int = 0
    swarm: int = 0
    fault: str = ""

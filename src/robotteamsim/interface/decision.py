"""The output of a controller in each step."""

import msgspec

from robotteamsim.geometry import Twist
from robotteamsim.network.messages import Message

OUTSIDE = -1
"""`Decision.swarm` of a robot that is socially excluded."""


class Decision(msgspec.Struct, frozen=True, gc=False):
    """The complete output of one controller in one step.

    twist:        velocity command in `base_link`.
    outbox:       messages to send, delivered in the next step if a path of links exists.
    excluded:     whether the robot is socially excluded.
    goal_m:       position it drives to, in `map` [m]; None if it has no goal.
    local_best:   value of its local best (larger is better), for display.
    search_counter: SC of its swarm, for display.
    swarm:        number of its swarm; OUTSIDE if excluded, 0 if there are no swarms.
    fault:        one line: why its controller was stopped; "" if it is running. A stopped robot stands still.
    """

    twist: Twist = Twist()
    outbox: tuple[Message, ...] = ()
    excluded: bool = False
    goal_m: tuple[float, float] | None = None
    local_best: float = 0.0
    search_counter: int = 0
    swarm: int = 0
    fault: str = ""

"""The output of a controller in each step."""

import msgspec

from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface.localisation import Localisation
from robotteamsim.network.messages import Message
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.plan import OccupancyGrid

OUTSIDE = -1
"""`Decision.swarm` of a robot that is socially excluded."""


class SwarmContext(msgspec.Struct, frozen=True):
    """The context that a robot measured, and the coefficients that follow from it [dissertation, 5.2.2].

    activity: A_s (28).  socialisation: S_n (29).  avoidance: O_n (30).  proximity: P_n (31, 32).
    connectivity: C_s (34); all within [0, 1].
    alpha, c1, c2, c3, c4: coefficients of (22) and (25), with c1 + c2 + c3 + c4 = 2 (26).
    """

    activity: float
    socialisation: float
    avoidance: float
    proximity: float
    connectivity: float
    alpha: float
    c1: float
    c2: float
    c3: float
    c4: float


class Decision(msgspec.Struct, frozen=True):
    """The complete output of one controller in one step.

    twist:        velocity command in `base_link`.
    outbox:       messages to send, delivered in the next step if a path of links exists.
    excluded:     whether the robot is socially excluded.
    goal_m:       position it drives to, in `map` [m]; None if it has no goal.
    local_best:   value of its local best (larger is better), for display.
    local_best_m: place of its local best, in `map` [m], for display; None if it has none.
    search_counter: SC of its swarm, for display.
    swarm:        number of its swarm; OUTSIDE if excluded, 0 if there are no swarms.
    context:      its measured context and adapted coefficients; None without adaptation.
    fault:        one line: why its controller was stopped; "" if it is running. A stopped robot stands still.
    area:         index of the area that it has chosen, with `mission.area_order`; -1: the area of the mission.
    done:         one line: why the robot has nothing left to do; "" while it has. The mission ends when all are done.
    belief:       for display, where it expects victims: per cell 0 to 100 % of what it expected at first; None in most
                  steps, and from controllers without a belief.
    localisation: where it believes that it is; None: it uses its true pose, or that of tf.
    found:        for display, what it and its team have found of a building that they do not know: the cells around all
                  that are known; None in most steps.
    particles:    for display, where it may be, if it follows its pose with particles: poses in `map`, each as likely as
                  any other; None in most steps.
    """

    twist: Twist = Twist()
    outbox: tuple[Message, ...] = ()
    excluded: bool = False
    goal_m: tuple[float, float] | None = None
    local_best: float = 0.0
    search_counter: int = 0
    swarm: int = 0
    fault: str = ""
    context: SwarmContext | None = None
    done: str = ""
    belief: FieldMap | None = None
    local_best_m: tuple[float, float] | None = None
    area: int = -1
    localisation: Localisation | None = None
    found: OccupancyGrid | None = None
    particles: tuple[Pose, ...] | None = None

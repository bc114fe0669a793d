"""What every controller is: observation and messages in, twist and messages out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np

from robotteamsim import rng
from robotteamsim.geometry import Twist
from robotteamsim.network.messages import Message
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import Observation

OUTSIDE = -1
"""In place of its swarm: the robot is socially excluded."""


class Discovery(NamedTuple):
    """An area explored or a victim reached.

    position_m: of her, or of the area's centre, in `map` [m].  time_s: when, on the mission's clock [s].
    """

    kind: Literal["area", "victim"]
    name: str
    robot_id: int
    position_m: tuple[float, float]
    time_s: float


@dataclass(frozen=True, slots=True)
class Task:
    """What the mission asks of the team, as of the end of the last step.

    running:       False while the mission waits, is paused or has ended: robots stand still.
    epoch:         grows whenever the voice map or the target area changes; bests are reset then [5.3].
    area_center_m: the area to explore, in `map` [m]; None if there is none (left).
    area_radius_m: its radius [m].
    unreported:    what the robots have found and the base, `mission.base`, has not heard of; empty without a base. A
                   robot learns by it what it has found itself, and by the base's messages what that has heard of.
    """

    running: bool = False
    epoch: int = 0
    area_center_m: tuple[float, float] | None = None
    area_radius_m: float = 0.0
    unreported: tuple[Discovery, ...] = ()


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


class Controller(Protocol):
    """One robot's controller, built once per trial and whenever its robot comes again, stepped once per loop step."""

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Take in what the robot perceives, the messages that arrived, and the mission's task."""

    def decide(self) -> Decision:
        """Return command and messages for this step."""


def own_stream(scenario: Scenario, purpose: str, robot_id: int, arrival: int) -> np.random.Generator:
    """Return the generator of one robot's controller for a purpose; what the team draws alike is no affair of it.

    Args: arrival: how often the robot has come, its start included: the second time it draws other numbers.
    """
    again = (arrival,) if arrival > 1 else ()
    return rng.stream(scenario.run.seed, purpose, robot_id, *again)

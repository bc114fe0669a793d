"""The task that the mission gives the team."""

import msgspec

from robotteamsim.interface.discovery import Discovery
from robotteamsim.interface.payload import Index


class Assistance(msgspec.Struct, frozen=True):
    """A firefighter who helps a victim.

    moving:    whether both are on their way; before, the victim is picked up.
    collapsed: whether the victim has collapsed, and is carried even if they could walk before.
    """

    robot_id: Index
    victim: str
    moving: bool
    collapsed: bool = False


class Task(msgspec.Struct, frozen=True):
    """The task of the team, as of the end of the last step.

    running:       False while the mission waits, is paused or has ended: robots stand still.
    epoch:         increases when the voice map or the target area changes; bests are then reset [5.3]. Steps of
                   a victim who walks do not increase it.
    area_center_m: the area to explore, in `map` [m]; None if no area is left, or if robots choose theirs and this one
                   has not, such as a relay.
    area_radius_m: its radius [m].
    undelivered:   discoveries that have not been delivered to the base or command centre; empty without one. A robot
                   learns of its own discoveries here, and of deliveries from the base's messages.
    explored_by:   with another `mission.area_order` than given: per area the id of the robot that explored it, -1 if
                   none has. A robot learns of its own areas here, and of others from the messages of its team.
    areas_left:    with such an order: indices of the areas that the robot believes to be left, in the order in which it
                   plans to explore them; None: areas are explored in the given order.
    rivals:        with such an order: ids of the teammates that have announced the same area as their next one.
    assistance:    the firefighters who help somebody; each learns of their own victim here.
    """

    running: bool = False
    epoch: int = 0
    area_center_m: tuple[float, float] | None = None
    area_radius_m: float = 0.0
    undelivered: tuple[Discovery, ...] = ()
    assistance: tuple[Assistance, ...] = ()
    explored_by: tuple[int, ...] = ()
    areas_left: tuple[int, ...] | None = None
    rivals: tuple[int, ...] = ()

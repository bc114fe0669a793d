"""The message of robots that cover a floor, sent once per iteration."""

import msgspec

from robotteamsim.interface.discovery import Discovery
from robotteamsim.interface.payload import Index, Point, Update, update_reader


class CoverUpdate(Update, frozen=True, tag="cover"):
    """Position and goal of a robot, in `map` [m], the cells that it knows to be covered, and its known victims.

    discoveries: of victims, without names; `time_s` is simulated time. The mission reads them, too.
    hot:         blocks of hot places that the robot sees, sorted; left out by a robot that sees none.
    """

    robot_id: Index
    position: Point
    goal: Point | None
    covered: str
    discoveries: tuple[Discovery, ...]
    hot: tuple[tuple[Index, Index], ...] | msgspec.UnsetType = msgspec.UNSET


parse_cover_update = update_reader(CoverUpdate, kept=1024)
"""Return the update in a message; None if it is another message."""

"""What robots that cover a floor send each other, once per iteration."""

from robotteamsim.interface.discovery import Discovery
from robotteamsim.interface.payload import Index, Point, Update, update_reader


class CoverUpdate(Update, frozen=True, gc=False, tag="cover"):
    """Where a robot is and goes, in `map` [m], what it knows to be covered, and all victims that it knows of.

    discoveries: of victims, without names; `time_s` is simulated time. The mission reads them, too.
    """

    robot_id: Index
    position: Point
    goal: Point | None
    covered: str
    discoveries: tuple[Discovery, ...]


parse_cover_update = update_reader(CoverUpdate, kept=1024)
"""Return the update that a message carries; None where it carries something else."""

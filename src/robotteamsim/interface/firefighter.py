"""What a firefighter reports, from which the mission learns who was not found."""

from robotteamsim.interface.payload import Index, Point, Time, Update, update_reader


class FirefighterUpdate(Update, frozen=True, tag="firefighter"):
    """What a firefighter does.

    victim:  whom they go to or help; "" for nobody.
    helping: whether they have reached the victim.
    safe:    names of the victims whom they have brought to safety.
    missing: name and time of the news of victims whom they did not find.
    """

    robot_id: Index
    position: Point
    victim: str
    helping: bool
    safe: tuple[str, ...] = ()
    missing: tuple[tuple[str, Time], ...] = ()


parse_firefighter_update = update_reader(FirefighterUpdate, kept=256)

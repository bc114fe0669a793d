"""What a team finds: areas explored and victims reached."""

from __future__ import annotations

from typing import Literal, NamedTuple


class Discovery(NamedTuple):
    """An area explored or a victim reached.

    position_m: of her, or of the area's centre, in `map` [m].  time_s: when, on the mission's clock [s].
    """

    kind: Literal["area", "victim"]
    name: str
    robot_id: int
    position_m: tuple[float, float]
    time_s: float

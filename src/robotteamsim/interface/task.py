"""What the mission asks of the team."""

from __future__ import annotations

from dataclasses import dataclass

from robotteamsim.interface.discovery import Discovery


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

"""The exits of a mission: whoever is in one is safe, with or without robots and firefighters."""

from __future__ import annotations

import math
from collections.abc import Iterator

from robotteamsim.mission.events import NOBODY, VictimSafe
from robotteamsim.mission.status import NOT_ALONE
from robotteamsim.mission.victims import VictimNews, Victims
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.rescue import Exit


def exit_at(exits: tuple[Exit, ...], place_m: Point) -> str | None:
    """Return the name of the first exit in which a place lies, in `map` [m]; None if there is none."""
    return next((way_out.name for way_out in exits if math.dist(place_m, way_out.center) <= way_out.radius_m), None)


class Exits:
    """Judges who has left by themselves. Those whom a firefighter has reached leave with them, see `Rescue`."""

    def __init__(self, exits: tuple[Exit, ...]) -> None:
        self._exits = exits
        self._judged = -1
        """Version of the victims."""

    def left(self, victims: Victims) -> Iterator[VictimNews]:
        """Yield who is in an exit now. The caller applies each change of the victims before it takes the next one."""
        if not self._exits or victims.version == self._judged:
            return
        self._judged = victims.version
        for index, victim in enumerate(victims.all):
            if victims.states[index] in NOT_ALONE:
                continue
            name = exit_at(self._exits, victim.position)
            if name is not None:
                yield VictimNews(index, "safe", VictimSafe(victim.name, name, robot_id=NOBODY))

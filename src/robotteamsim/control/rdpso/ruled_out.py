"""Places where no victim can be, though a voice is heard there."""

from __future__ import annotations

from collections.abc import Callable

from robotteamsim import _core
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector


class RuledOut:
    """What the team has learnt of where victims are not since the voice map last changed.

    Within the local-best radius of a robot, a victim can only be at the loudest cell that it hears; and not even
    there once a robot was next to it, for she would be saved, and silent [5.3]. Without this a voice from behind a
    wall, loudest at that wall, holds the swarm there until all robots are excluded.
    """

    def __init__(self, scenario: Scenario) -> None:
        cell_m = scenario.voice.map_resolution_m
        # The victim may be anywhere in her cell of the voice map.
        save_m = scenario.mission.save_distance_m
        next_to_m = max(0.5 * save_m, save_m - cell_m)
        core = _core.control.RuledOut(radius_m=scenario.voice.local_best_radius_m, cell_m=cell_m, next_to_m=next_to_m)
        # Not wrapped: every robot asks several times in every iteration.
        self.clear: Callable[[], None] = core.clear
        """Forgets everything: the voice map is another."""
        self.add: Callable[[Vector, Vector | None], None] = core.add
        """Notes the loudest cell that a robot hears from where it is; none if it hears nothing.

        Robots that heard the same within 0.25 m of each other are one: the first counts.
        """
        self.add_all: Callable[[_core.control.HeardNotes], None] = core.add_all
        """Notes what several robots hear: of each, in an order, where it is and the loudest cell."""
        self.covers: Callable[[Vector], bool] = core.covers
        """Whether the victim whose voice is heard at a cell cannot be there."""

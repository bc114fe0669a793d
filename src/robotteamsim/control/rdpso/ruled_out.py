"""Places where no victim can be, though a voice is heard there."""

from __future__ import annotations

from robotteamsim import _core
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector


class RuledOut:
    """What the team has learnt of where victims are not since the voice map last changed.

    Within the local-best radius of a robot, a victim can only be at the loudest cell that it hears; and not even
    there once a robot was next to it, because the victim would have been saved, and silent [5.3]. Without this a voice
    from behind a wall, loudest at that wall, holds the swarm there until all robots are excluded. With
    `control.rule_out_places: false` nothing is ruled out.
    """

    def __init__(self, scenario: Scenario) -> None:
        cell_m = scenario.voice.map_resolution_m
        # A victim may be anywhere in their cell of the voice map.
        save_m = scenario.mission.save_distance_m
        next_to_m = max(0.5 * save_m, save_m - cell_m)
        radius_m = scenario.voice.local_best_radius_m
        self._is_on = scenario.control.rule_out_places
        self._core = _core.control.RuledOut(radius_m=radius_m, cell_m=cell_m, next_to_m=next_to_m)

    def clear(self) -> None:
        """Forget everything: the voice map has changed."""
        self._core.clear()

    def add(self, position: Vector, loudest: Vector | None) -> None:
        """Note the loudest cell that a robot hears from where it is; None if it hears nothing.

        Robots that heard the same within 0.25 m of each other count as one: the first.
        """
        self._core.add(position, loudest)

    def add_all(self, heard: _core.control.HeardNotes) -> None:
        """Note what several robots hear, in their order."""
        self._core.add_all(heard)

    def covers(self, place: Vector) -> bool:
        """Whether the victim whose voice is heard at a cell cannot be there."""
        return self._is_on and self._core.covers(place)

"""Places where no victim can be, although a voice is heard there."""

from __future__ import annotations

from robotteamsim import _core
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector


class RuledOut:
    """The places that the team has ruled out since the voice map last changed.

    Within the local-best radius of a robot, a victim can only be at the loudest cell that it hears, and not even there
    once a robot was next to it, because the victim would then be saved and silent [5.3]. Otherwise a voice behind a
    wall, loudest at that wall, would hold the swarm there until all robots are excluded.
    """

    def __init__(self, scenario: Scenario) -> None:
        cell_m = scenario.voice.map_resolution_m
        # A victim may be anywhere in a cell of the voice map.
        save_m = scenario.mission.save_distance_m
        next_to_m = max(0.5 * save_m, save_m - cell_m)
        radius_m = scenario.voice.local_best_radius_m
        self._core = _core.control.RuledOut(radius_m=radius_m, cell_m=cell_m, next_to_m=next_to_m)

    def clear(self) -> None:
        """Discard everything, because the voice map has changed."""
        self._core.clear()

    def add(self, position: Vector, loudest: Vector | None) -> None:
        """Note the loudest cell that a robot hears at its position; None if it hears nothing.

        Of robots that hear the same within 0.25 m of each other, only the first counts.
        """
        self._core.add(position, loudest)

    def add_all(self, heard: _core.control.HeardNotes) -> None:
        """Note the loudest cells of several robots, in their order."""
        self._core.add_all(heard)

    def covers(self, place: Vector) -> bool:
        """Whether no victim can be at a cell, although a voice is heard there."""
        return self._core.covers(place)

"""Places where no victim can be, although a voice is heard there."""

from robotteamsim import _core
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector


class RuledOut(_core.control.RuledOut):
    """The places that the team has ruled out since the voice map last changed.

    Within the local-best radius of a robot, a victim can only be at the loudest cell that it hears, and not even there
    once a robot was next to it, because the victim would then be saved and silent [5.3]. Otherwise a voice behind a
    wall, loudest at that wall, would hold the swarm there until all robots are excluded.

    `add` notes the loudest cell that a robot hears at its position, or None; of robots that hear the same within 0.25 m
    of each other, only the first counts. `covers` is whether no victim can be at a cell, although a voice is heard
    there; never with `control.rule_out_places: false`. `clear` discards everything, because the voice map has changed.
    """

    def __init__(self, scenario: Scenario, is_on: bool = True) -> None:
        """Args: is_on: `control.rule_out_places`."""
        cell_m = scenario.voice.map_resolution_m
        # A victim may be anywhere in a cell of the voice map.
        save_m = scenario.mission.save_distance_m
        next_to_m = max(0.5 * save_m, save_m - cell_m)
        super().__init__(radius_m=scenario.voice.local_best_radius_m, cell_m=cell_m, next_to_m=next_to_m)
        self._is_on = is_on

    def covers(self, place: Vector) -> bool:
        """Whether no victim can be at a cell, although a voice is heard there."""
        return self._is_on and super().covers(place)

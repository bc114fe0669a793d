"""Places where no victim can be, though a voice is heard there."""

from robotteamsim import _core
from robotteamsim.scenario.scenario import Scenario


class RuledOut(_core.control.RuledOut):
    """What the team has learnt of where victims are not since the voice map last changed.

    Within the local-best radius of a robot, a victim can only be at the loudest cell that it hears; and not even
    there once a robot was next to it, because the victim would have been saved, and silent [5.3]. Without this a voice
    from behind a wall, loudest at that wall, holds the swarm there until all robots are excluded.

    `add` notes the loudest cell that a robot hears from where it is, or None; robots that heard the same within 0.25 m
    of each other count as one. `covers` is whether the victim whose voice is heard at a cell cannot be there. `clear`
    forgets everything: the voice map has changed.
    """

    def __init__(self, scenario: Scenario) -> None:
        cell_m = scenario.voice.map_resolution_m
        # A victim may be anywhere in their cell of the voice map.
        save_m = scenario.mission.save_distance_m
        next_to_m = max(0.5 * save_m, save_m - cell_m)
        super().__init__(radius_m=scenario.voice.local_best_radius_m, cell_m=cell_m, next_to_m=next_to_m)

"""The best place that one robot perceives around it [dissertation, 5.3]."""

import math

from robotteamsim.control.driving.known_map import KnownMap
from robotteamsim.control.rdpso.ruled_out import RuledOut
from robotteamsim.control.rdpso.update import Best
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.swarm import Vector


class LocalBestFinder:
    """Finds the best place around a robot."""

    def __init__(self, scenario: Scenario) -> None:
        self._radius_m = scenario.voice.local_best_radius_m
        self._by_path = scenario.control.navigation == "path"

    def find(
        self, known_map: KnownMap, ruled_out: RuledOut, voice: VoiceReading, area: Vector | None, position: Vector
    ) -> Best | None:
        """Return the loudest cell nearby; if no voice is heard, the cell with the shortest path to the area [5.3].

        A voice that is ruled out is ignored. None if there is neither a voice nor an area. Places in `map` [m].
        """
        if voice.heard and not ruled_out.covers(voice.local_best_m):
            return Best(voice.local_best_level_db, voice.local_best_m)
        if area is None:
            return None
        if not self._by_path:
            cell = known_map.nearest_by_sight(area, position, self._radius_m)
            return Best(-math.dist(area, cell), cell)
        cell, length_m = known_map.nearest_by_path(area, position, self._radius_m)
        return Best(-length_m, cell)

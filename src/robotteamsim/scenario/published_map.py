"""The occupancy grid on /map."""

from __future__ import annotations

from pathlib import Path

from robotteamsim.scenario.plan import OccupancyGrid, occupancy_grid
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.yaml_text import read_mapping

RESOLUTION_M = 0.05
"""Of the map of a plan that is not an image."""


def published_map(scenario: Scenario) -> OccupancyGrid:
    """Return the grid that map_server publishes if the plan is a map_server yaml, else the plan in cells of 5 cm.

    A plan with changed keys is not the image any more, so it is drawn.

    Raises: ScenarioError: the yaml or its image cannot be read any more.
    """
    if scenario.plan_file is not None:
        path = Path(scenario.plan_file)
        if "image" in read_mapping(path, scenario.plan_file, "a floor plan"):
            # Imported late: OpenCV takes longer to load than most scenarios.
            from robotteamsim.scenario.map_file import read_map

            return read_map(path).occupancy_grid()
    return occupancy_grid(scenario.plan, RESOLUTION_M)

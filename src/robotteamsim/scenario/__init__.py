"""The typed scenario and floor plan: YAML and map_server images in, clear errors out."""

from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.loading import dump, from_mapping, load, load_floor_plan, write_floor_plan
from robotteamsim.scenario.plan import OccupancyGrid, Solid, door_corners, occupancy_grid, solids, wall_corners
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.schema import json_schema
from robotteamsim.scenario.shipped import map_names, scenario_names

__all__ = [
    "Block",
    "Bounds",
    "Door",
    "FloorPlan",
    "OccupancyGrid",
    "Scenario",
    "Solid",
    "Wall",
    "door_corners",
    "dump",
    "from_mapping",
    "json_schema",
    "load",
    "load_floor_plan",
    "map_names",
    "occupancy_grid",
    "scenario_names",
    "solids",
    "wall_corners",
    "write_floor_plan",
]

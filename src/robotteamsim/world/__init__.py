"""The true state of a trial: walls, doors, robots, objects, contacts and simulated time."""

from robotteamsim.world.placement import check_places, placed_robots
from robotteamsim.world.world import World

__all__ = ["World", "check_places", "placed_robots"]

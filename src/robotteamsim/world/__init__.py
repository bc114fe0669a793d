"""What is true: walls, doors, robots and what they do to each other; simulated time."""

from robotteamsim.world.placement import check_places, placed_robots
from robotteamsim.world.world import World

__all__ = ["World", "check_places", "placed_robots"]

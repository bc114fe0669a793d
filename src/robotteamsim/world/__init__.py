"""The true state of a trial: walls, doors, robots, objects, contacts and simulated time."""

from robotteamsim.world.world import World

__all__ = ["World"]

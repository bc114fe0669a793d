"""Names in the worlds that this package writes, for its own plugins and its own import."""

import re

FLOOR, WALLS, BLOCKS, PILLARS = (
    "robotteamsim_floor",
    "robotteamsim_walls",
    "robotteamsim_blocks",
    "robotteamsim_pillars",
)
"""Models of the floor plan; each wall, block or pillar is a link of one of them."""

DOOR, OBJECT, ROBOT = "door_", "object_", "robot_"
"""Prefixes of the models of doors, objects and robots."""

ROBOT_PLUGIN, WORLD_PLUGIN = "librobotteamsim_gazebo.so", "librobotteamsim_gazebo_world.so"

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_RESERVED = re.compile("__.*__")


class UniqueNames:
    """Gives each name once; further ones get a number."""

    def __init__(self) -> None:
        self._given: dict[str, int] = {}
        """The last number of each name."""

    def unused(self, wanted: str) -> str:
        """Return the wanted name if it is unused, or else with the next number."""
        name = wanted
        while name in self._given:
            self._given[wanted] += 1
            name = f"{wanted}_{self._given[wanted]}"
        self._given[name] = 1
        return name


class Names(UniqueNames):
    """Gives each name once, in the form that SDF allows."""

    def unused(self, wanted: str) -> str:
        """Return a name for an element of SDF: the wanted one, if it is allowed and unused, or one like it."""
        # SDF separates nested names by "::" and reserves __names__.
        base = _NOT_IN_XML.sub("_", wanted).replace("::", "_").strip() or "unnamed"
        if _RESERVED.fullmatch(base):
            base = base.strip("_") or "unnamed"
        return super().unused(base)

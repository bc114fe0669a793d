"""Names in the worlds that this package writes."""

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


class Names:
    """Gives each name once, in the form that SDF allows; further ones get a number."""

    def __init__(self) -> None:
        self._given: dict[str, int] = {}
        """The last number of each name."""

    def unused(self, wanted: str) -> str:
        """Return a name for an element of SDF: the wanted one if it is allowed and unused, or one like it."""
        # SDF separates nested names by "::" and reserves __names__.
        base = _NOT_IN_XML.sub("_", wanted).replace("::", "_").strip() or "unnamed"
        if _RESERVED.fullmatch(base):
            base = base.strip("_") or "unnamed"
        name = base
        while name in self._given:
            self._given[base] += 1
            name = f"{base}_{self._given[base]}"
        self._given[name] = 1
        return name

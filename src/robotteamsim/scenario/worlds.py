"""The worlds that `run.world` can name: ours, and those of users' packages."""

from typing import TYPE_CHECKING, Literal

from robotteamsim.own_parts import own_parts

ENTRY_POINTS = "robotteamsim.worlds"
"""The group of entry points with which other packages register worlds: `flat = my_package:FlatWorld`."""

OURS = {"box2d": "robotteamsim.world.world:World", "mujoco": "robotteamsim.world.mujoco.world:MujocoWorld"}
"""Our worlds, by the places of their classes."""

WORLDS = {**OURS, **{name: point.value for name, point in own_parts(ENTRY_POINTS).items() if name not in OURS}}
"""The places of all worlds, ours first; no package takes a name of ours."""

if TYPE_CHECKING:
    WorldName = str
else:
    WorldName = Literal[tuple(WORLDS)]
    """The name of a world."""

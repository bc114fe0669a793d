"""What walls are made of: layers of substances, from which their losses of radio and voices follow."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from robotteamsim.scenario.base import SMALLEST, Many, Model, Name

Substance = Literal[
    "air",
    "concrete",
    "brick",
    "plasterboard",
    "wood",
    "glass",
    "ceiling_board",
    "chipboard",
    "plywood",
    "marble",
    "metal",
]
"""Those of Table 3 of ITU-R P.2040-3 that buildings are made of, and air."""


class Layer(Model):
    """A layer of a wall, from one face to the other."""

    of: Substance = Field(description="a substance of ITU-R P.2040-3; studs and insulation count as air")
    thickness_m: float = Field(ge=SMALLEST, le=2.0, description="of the layer [m]")


class Material(Model):
    """How walls are built. The thickness of its layers need not be that of the wall, which is what robots meet."""

    name: Name = Field(description="for `material` of walls and blocks")
    layers: Many[Layer] = Field(min_length=1, max_length=20, description="from one face to the other, in either order")


GLASS = Material(name="glass", layers=(Layer(of="glass", thickness_m=0.006),))
"""That of windows, in buildings whose files do not say what their panes are."""

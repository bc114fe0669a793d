"""Slopes and platforms that robots drive on."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import shapely

from robotteamsim.palette import DARK_FLOOR
from robotteamsim.scenario.body import Body
from robotteamsim.scenario.mujoco import Ramp
from robotteamsim.world.mujoco.shapes import FLOOR_GROUP, GROUND, rgba
from robotteamsim.world.mujoco.wheels import CASTOR

_SPRING_S, _SPRING_YIELDS = 0.1, 0.5
"""Springs of castors, as the time and the impedance of MuJoCo's contacts: about 800 N/m for a robot of 5 kg. At the
foot of a ramp rigid castors would lift the driven wheels off the ground."""


def add_ramps(spec: mujoco.MjSpec, ramps: Sequence[Ramp]) -> None:
    """Add ramps to a spec with all its robots, whose castors get springs."""
    for index, ramp in enumerate(ramps):
        tops_m = (ramp.from_height_m, ramp.height_m, ramp.height_m, ramp.from_height_m)
        points = [(x, y, 0.0) for x, y in ramp.corners]
        points += [(x, y, top_m) for (x, y), top_m in zip(ramp.corners, tops_m, strict=True)]
        name = f"ramp {index}"
        spec.add_mesh(name=name, uservert=[value for point in points for value in point])
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=name,
            contype=GROUND,
            conaffinity=0,
            group=FLOOR_GROUP,
            rgba=rgba(DARK_FLOOR),
        )
    for geom in spec.geoms if ramps else ():
        if CASTOR in geom.name:
            geom.solref[0], geom.solimp[:2] = _SPRING_S, _SPRING_YIELDS


def ground_m(ramps: Sequence[Ramp], body: Body) -> float:
    """Return the height of the highest point of floor and ramps under a body [m]."""
    outline, heights_m = body.core.buffer(body.margin_m), [0.0]
    for ramp in ramps:
        covered = outline.intersection(shapely.Polygon(ramp.corners))
        heights_m += [ramp.top_m((x, y)) for x, y in shapely.get_coordinates(covered).tolist()]
    return max(heights_m)

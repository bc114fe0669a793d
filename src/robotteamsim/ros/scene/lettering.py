"""Texts of the 3D scene: their sizes, and places where they cover neither walls nor each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import shapely
from visualization_msgs.msg import Marker

from robotteamsim.analysis import labels
from robotteamsim.analysis.labels import Point
from robotteamsim.ros.scene import figures, view
from robotteamsim.ros.scene.shapes import Colour, label
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.plan import solids
from robotteamsim.world.placement import placed_robots

WIDTH_PER_LETTER, DEPTH = 0.48, 1.2
"""Of a text on the screen, per height of a capital letter; the depth includes descenders and the tilt of the view."""

LIFT_M = 0.05
"""Between the highest solid and the lower edges of texts."""


@dataclass(frozen=True, slots=True)
class Name:
    """A text to place beside what it names, at a distance; before: its side so far, see `labels.Text`."""

    words: str
    anchor_m: Point
    clear_m: float
    height_m: float
    before: int | None = None


@dataclass(frozen=True, slots=True)
class Written:
    """A text in its place.

    middle_m: as the default view sees it on the floor.
    side:     of its anchor, as an index of `labels.SIDES`.
    """

    words: str
    middle_m: Point
    height_m: float
    side: int | None = None
    on_floor: bool = False
    """Just above the floor, because nothing solid is near; seen from straight above, it is then where it belongs."""

    @property
    def box(self) -> shapely.Polygon:
        """The part of the floor that the text covers in the default view."""
        return labels.Spot(self.middle_m, _half_m(self.words, self.height_m), 0).box


@dataclass(frozen=True)
class Lettering:
    """Writes texts above all solids, where the default view sees them at their places on the floor."""

    unit: float
    """Factor of all sizes of the scene; see `view.unit`."""
    eye_m: tuple[float, float, float]
    highest_m: float
    walls: shapely.Geometry = field(default_factory=shapely.MultiPolygon)
    """The parts of the floor that walls cover in the default view."""
    inside: shapely.Geometry = field(default_factory=lambda: shapely.box(-1e6, -1e6, 1e6, 1e6))

    @classmethod
    def of(cls, scenario: Scenario, wall_height_m: float) -> Lettering:
        """Return the lettering of a scenario whose walls are cut at a height."""
        plan = scenario.plan
        heights_m = [min(solid.element.height_m, wall_height_m) for solid in solids(plan)]
        heights_m += [thing.height_m for thing in scenario.objects]
        heights_m += [robot.height_m for robot in placed_robots(scenario)]
        heights_m += [figures.HIGHEST_M] if scenario.moves_people else []
        eye_m = view.eye_m(plan.bounds)
        walls = [view.covered(eye_m, solid.polygon, h) for solid, h in zip(solids(plan), heights_m, strict=False)]
        inside = shapely.box(*plan.bounds.min, *plan.bounds.max)
        return cls(view.unit(plan.bounds), eye_m, max(heights_m), shapely.union_all(walls), inside)

    def label(self, namespace: str, marker_id: int, text: Written, tint: Colour) -> Marker:
        """Return a text, above all solids or low, on the line from its place to the camera of the default view."""
        z_m = (0.0 if text.on_floor else self.highest_m) + LIFT_M + 0.5 * text.height_m
        share = z_m / self.eye_m[2]
        x, y = (at + share * (eye - at) for at, eye in zip(text.middle_m, self.eye_m, strict=False))
        return label(namespace, marker_id, text.words, tint, (x, y, z_m), text.height_m)

    def place(self, names: Sequence[Name], taken: Sequence[shapely.Geometry] = ()) -> list[Written]:
        """Return a place for each name, in order: within the building, off walls, other names and what is taken."""
        texts = [
            labels.Text(name.anchor_m, _half_m(name.words, name.height_m), name.clear_m, name.before) for name in names
        ]
        spots = labels.place(texts, [self.walls, *taken], self.inside)
        return [
            Written(name.words, spot.middle_m, name.height_m, spot.side)
            for name, spot in zip(names, spots, strict=True)
        ]


def _half_m(words: str, height_m: float) -> Point:
    """Return half the width and depth that a text covers on the floor."""
    return (0.5 * WIDTH_PER_LETTER * height_m * max(len(words), 1), 0.5 * DEPTH * height_m)

"""The legend of the 3D scene: one row below the building, with everything that the scenario can show."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.ros.scene.lettering import WIDTH_PER_LETTER
from robotteamsim.ros.scene.shapes import Mesh, Position, colour, faded, label, lines
from robotteamsim.ros.scene.view import unit
from robotteamsim.scenario import Scenario
from robotteamsim.world.placement import placed_robots

LETTER_M, SYMBOL_M, GAP_M = 1.1, 1.0, 1.8
"""Height of letters, radius of symbols with the space after them, and space between entries, for 60 x 40 m."""
SOUTH_M = 2.4
"""Distance from the building."""
DASHES = 6

Shape = Literal["ring", "dashed ring", "disc", "line", "dashed line", "square"]


@dataclass(frozen=True, slots=True)
class Entry:
    """A symbol and its meaning."""

    shape: Shape
    code: str
    words: str

    @property
    def width_m(self) -> float:
        """Width in a building of 60 x 40 m, with the space after it."""
        return 2.0 * SYMBOL_M + WIDTH_PER_LETTER * LETTER_M * len(self.words) + GAP_M


def entries(scenario: Scenario) -> list[Entry]:
    """Return what the scene of a scenario can show."""
    found = []
    if scenario.mission.victims:
        shapes: dict[str, Shape] = {"waiting": "dashed ring", "saved": "disc", "safe": "disc"}
        is_rescue = scenario.mission.saved_by == "firefighter"
        states = palette.RESCUED if is_rescue else palette.VICTIMS
        word = "" if is_rescue else "victim "  # a rescue has many entries
        found += [Entry(shapes.get(state, "ring"), code, f"{word}{state}") for state, code in states.items()]
        if any(victim.flees for victim in scenario.mission.victims):
            found.append(Entry("disc", palette.FLEEING, "fleeing"))
        if scenario.fire is not None:
            found.append(Entry("ring", palette.CASUALTY, "collapsed or dead"))
    if scenario.firefighters is not None:
        found.append(Entry("disc", palette.HELMET, "firefighter"))
    if scenario.fire is not None:
        found += [Entry("disc", palette.FLAME, "fire"), Entry("disc", palette.SMOKE, "smoke")]
    if scenario.mission.areas:
        found.append(Entry("ring", palette.TARGET_AREA, "target area"))
        found.append(Entry("disc", palette.EXPLORED_AREA, "explored"))
    if len(placed_robots(scenario)) > 1:
        found.append(Entry("line", palette.STRONG_LINK, "strong link"))
        found.append(Entry("line", palette.WEAK_LINK, "weak"))
        found.append(Entry("line", palette.ENDANGERED_LINK, "endangered"))
        found.append(Entry("dashed line", palette.RELAYED, "relayed"))
    if scenario.base is not None:
        found.append(Entry("square", palette.WHITE, "base" if scenario.command_centre is None else "centre"))
    return found


def legend_markers(scenario: Scenario) -> list[Marker]:
    """Return the legend, centred south of the building and no wider than it."""
    shown = entries(scenario)
    if not shown:
        return []
    bounds = scenario.plan.bounds
    size = unit(bounds)
    (min_x, min_y), (max_x, _) = bounds.min, bounds.max
    total_m = size * (sum(entry.width_m for entry in shown) - GAP_M)
    size *= min(1.0, max(max_x - min_x, 40.0 * size) / total_m)
    x = 0.5 * (min_x + max_x) - 0.5 * min(total_m, size / unit(bounds) * total_m)
    y = min_y - SOUTH_M * unit(bounds)
    markers = []
    for number, entry in enumerate(shown):
        markers += list(_markers(number, entry, (x + 0.8 * SYMBOL_M * size, y), size))
        words_m = WIDTH_PER_LETTER * LETTER_M * len(entry.words) * size
        at = (x + 2.0 * SYMBOL_M * size + 0.5 * words_m, y, 0.5 * LETTER_M * size)
        markers.append(label("legend_words", number, entry.words, colour(entry.code), at, LETTER_M * size))
        x += entry.width_m * size
    return markers


def _markers(number: int, entry: Entry, middle_m: tuple[float, float], size: float) -> Iterator[Marker]:
    tint, radius_m = colour(entry.code), 0.65 * size
    x, y = middle_m
    if entry.shape in ("line", "dashed line"):
        parts = 3 if entry.shape == "dashed line" else 1
        step_m = 1.8 * size / (2 * parts - 1)
        starts_m = [x - 0.9 * size + 2 * part * step_m for part in range(parts)]
        yield lines("legend", number, [((s, y, 0.1), (s + step_m, y, 0.1), tint) for s in starts_m], 0.2 * size)
        return
    if entry.shape == "square":
        corners: list[Position] = [(x + a * radius_m, y + b * radius_m, 0.1) for a, b in _SIGNS]
        yield lines("legend", number, [(a, b, tint) for a, b in itertools.pairwise(corners)], 0.16 * size)
        return
    ring = Mesh()
    ring.ring(middle_m, 0.72 * radius_m, radius_m, 0.1, tint, DASHES if entry.shape == "dashed ring" else 0)
    if entry.shape == "disc":
        ring.ring(middle_m, 0.0, 0.72 * radius_m, 0.1, faded(tint, 0.55))
    yield ring.marker("legend", number)


_SIGNS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0))
"""The corners of a square, closed."""

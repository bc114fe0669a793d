"""What drawings of buildings have in common: gaps that may be doors and windows, and doubts about the result."""

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from robotteamsim.arguments import number
from robotteamsim.formats.importer import Imported
from robotteamsim.formats.options import Options
from robotteamsim.map_import.paper import MOST_TURN_DEG
from robotteamsim.scenario.door_places import without_misplaced_doors
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.map_image import OPEN_M, DrawingRules, MapImage, open_places
from robotteamsim.wording import counted
from robotteamsim.world.floor_parts import floor_parts, unreached_texts

DOOR_WIDTHS_M = (0.6, 1.6)
"""Of gaps that may be doors, unless the user says others."""

_MOST_PLACES = 10
_MOST_GREY = 0.1
"""Of the pixels, the largest share that is usual in photos and scans of drawings."""
_UPRIGHT = 0.02
"""Of a wall along an axis, the largest slope."""
_ROBOT_M = 0.2
"""Radius of the robot for which parts of the floor count as connected."""


def numbers(text: str, count: int, form: str) -> list[float]:
    """Return comma-separated numbers. Raises: ArgumentTypeError."""
    parts = text.split(",")
    if len(parts) != count:
        raise argparse.ArgumentTypeError(f"'{text}' is not {form}")
    return [number(part) for part in parts]


def _widths(text: str) -> tuple[float, float]:
    """Return the least and greatest width of a door. Raises: ArgumentTypeError."""
    low, high = numbers(text, 2, "LOW,HIGH")
    if not 0.0 < low <= high:
        raise argparse.ArgumentTypeError(f"'{text}': expected widths above 0, the smaller one first")
    return low, high


OPENINGS: Options = {
    "--doors": {
        "type": _widths,
        "nargs": "?",
        "const": DOOR_WIDTHS_M,
        "metavar": "LOW,HIGH",
        "help": "gaps of these widths [m] in walls along the axes become open doors; default "
        + ",".join(f"{width_m:g}" for width_m in DOOR_WIDTHS_M),
    },
    "--windows": {
        "type": _widths,
        "metavar": "LOW,HIGH",
        "help": "gaps of these widths [m] in outer walls, empty or with thin lines, become walls of material glass",
    },
}


def drawn(
    found: FloorPlan,
    rules: DrawingRules,
    notes: tuple[str, ...] = (),
    *,
    image: MapImage | None = None,
    files: tuple[Path, ...] = (),
) -> Imported:
    """Return the import of a drawing: the plan without doors that cannot turn, and doubts about it.

    Args: image: what was drawn, and files: those that it was read from; a map in two files knows no outside.
    """
    plan = without_misplaced_doors(found)
    parts = floor_parts(plan, _ROBOT_M)
    is_map = bool(files)
    if image is not None:  # what the image does not know is no floor
        parts = tuple(part for part in parts if image.is_free_at(part.place))
    doubts = [*notes, *_doubts(plan, rules, image)]
    if num_left_out := len(found.doors) - len(plan.doors):
        gaps = f"{counted(num_left_out, 'gap')} found next to which a leaf cannot turn"
        doubts.append(f"{gaps}: left open, without a door")
    doubts += unreached_texts(plan, parts)
    if not is_map:
        hint = "" if rules.windows_m else "; --windows LOW,HIGH makes glass of gaps, --doors makes doors"
        doubts += open_wall_texts(plan, hint)
    summary = _summary(plan, rules, None if is_map else image)
    shown = None if image is None else (image, rules)
    return Imported(plan, tuple(doubts), summary=summary, files=files, parts=parts, image=shown)


def _summary(plan: FloorPlan, rules: DrawingRules, image: MapImage | None) -> str:
    """Return size and number of elements of an imported plan, and what was measured or changed in its source."""
    (x0, y0), (x1, y1) = plan.bounds.min, plan.bounds.max
    num_windows = sum(wall.material == "glass" for wall in plan.walls)
    parts = [f"{x1 - x0:g} x {y1 - y0:g} m", counted(len(plan.walls) - num_windows, "wall")]
    parts += [counted(len(plan.blocks), "block")]
    parts += [counted(len(plan.doors), "door")] if rules.doors_m else []
    parts += [counted(num_windows, "window")] if rules.windows_m or num_windows else []
    notes = [", ".join(parts)]
    if plan.drawing_offset_m is not None:
        notes.append("[0, 0] is [{:.10g}, {:.10g}] m in the drawing".format(*plan.drawing_offset_m))
    if image is not None:
        notes.append(f"{100.0 * image.grey_share:.1f} % of the pixels were neither black nor white")
        notes += [f"turned by {-image.turn_deg:.1f} degrees"] if image.turn_deg else []
    return "; ".join(notes)


def _doubts(plan: FloorPlan, rules: DrawingRules, image: MapImage | None) -> Iterator[str]:
    """Yield why what was imported may not be what was drawn."""
    if image is not None and abs(image.turn_deg) > MOST_TURN_DEG - 0.05:
        yield f"the paper is turned by {MOST_TURN_DEG:g} degrees or more, and only so much is undone; turn the picture"
    if image is not None and image.grey_share > _MOST_GREY:
        yield f"{100.0 * image.grey_share:.0f} % of the pixels are neither black nor white: walls may be wrong"
    spans_m = [np.abs(np.subtract(wall.end, wall.start)) for wall in plan.walls]
    slanted = [float(np.hypot(*span)) for span in spans_m if span.min() > _UPRIGHT * span.max()]
    if rules.doors_m and not plan.doors and sum(slanted) > 0.5 * sum(float(np.hypot(*span)) for span in spans_m):
        yield "no doors: their gaps are only looked for in walls along the axes, and most walls are turned from these"


def num_doors(plan: FloorPlan) -> int:
    """Return the number of doors of an imported building, of which a double one is two leaves."""
    return len({door.name.removesuffix("_left").removesuffix("_right") for door in plan.doors})


def open_wall_texts(plan: FloorPlan, hint: str = "") -> list[str]:
    """Return where the outer wall is open if all doors are closed, in one line. Args: hint: how to close it."""
    found = open_places(plan)
    if found is None:
        return [f"the walls enclose no floor: the outer wall is open on more than {OPEN_M:g} m"]
    places = [f"[{x:g}, {y:g}]" for x, y in found]
    more = [counted(len(places) - _MOST_PLACES, "other place")] if len(places) > _MOST_PLACES else []
    return [f"the outer wall is open at {', '.join([*places[:_MOST_PLACES], *more])}{hint}"] if places else []

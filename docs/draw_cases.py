"""Draw the loss of a straight line in each case of docs/propagation.md: docs/images/propagation_cases.png.

Every number in the picture is computed by the library. Run by `make pictures`; needs no display.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from robotteamsim import palette
from robotteamsim.analysis.plan_picture import draw_floor_plan
from robotteamsim.propagation import RadioField
from robotteamsim.propagation.faces import MM_PER_M, radio_faces
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.sections import Radio

PATH = Path(__file__).parent / "images" / "propagation_cases.png"
BOUNDS = Bounds(max=(4.0, 3.0))
RADIO = Radio()
UNITS_PER_DB = 20
MOVED_MM = (1e-3, 1e-6)
"""Faces are moved by (eps, eps^2) to decide ties at corners and along faces."""

INK, ROBOT = palette.INK, palette.BLUE
PAID = palette.VERMILLION
HALO = (withStroke(linewidth=2.6, foreground=palette.PAPER),)

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Note:
    """Text at a point [m]."""

    text: str
    at: Point


@dataclass(frozen=True, slots=True)
class Case:
    """A floor plan, rays through it (a, b, position of the sum [m]), and notes about the losses of its solids."""

    title: str
    plan: FloorPlan
    rays: tuple[tuple[Point, Point, Point], ...]
    notes: tuple[Note, ...]


def plan(**elements: tuple[Wall | Block | Door, ...]) -> FloorPlan:
    """Return the floor plan of one panel."""
    return FloorPlan.model_validate({"name": "case", "bounds": BOUNDS, **elements})


def class_text(element: Wall | Block) -> str:
    """Return the thickness and the loss of a solid, from the library."""
    alone = plan(walls=(element,)) if isinstance(element, Wall) else plan(blocks=(element,))
    loss_db = 2.0 * float(radio_faces(alone, RADIO).weights.max()) / UNITS_PER_DB
    width_m = element.thickness_m or float(np.min(np.ptp(element.polygon, axis=0)))
    kind = element.kind if isinstance(element, Block) else "wall"
    return f"{kind} of {100.0 * width_m:g} cm: {loss_db:g} dB"


def cases() -> tuple[Case, ...]:
    """Return the six cases."""
    return (oblique_wall(), corner(), along_a_wall(), pillar(), end_inside_a_wall(), doors())


def oblique_wall() -> Case:
    """Case 1."""
    thin = Wall(name="thin", start=(2.0, 0.0), end=(2.0, 3.0))
    return Case(
        "1  oblique wall",
        plan(walls=(thin,)),
        (((0.4, 2.4), (3.6, 2.4), (3.0, 2.5)), ((1.0, 0.4), (3.0, 1.9), (2.75, 1.35))),
        (Note(class_text(thin), (2.2, 0.15)),),
    )


def corner() -> Case:
    """Case 2."""
    level = Wall(name="level", start=(0.0, 2.2), end=(2.7, 2.2), thickness_m=0.4)
    upright = Wall(name="upright", start=(2.5, 2.4), end=(2.5, 0.0), thickness_m=0.4)
    return Case(
        "2  corner of two walls",
        plan(walls=(level, upright)),
        (((1.5, 2.8), (3.5, 1.2), (3.1, 2.15)), ((0.5, 0.45), (3.6, 0.45), (3.1, 0.6))),
        (Note(class_text(level), (0.1, 1.75)),),
    )


def along_a_wall() -> Case:
    """Case 3."""
    long = Wall(name="long", start=(0.9, 1.5), end=(3.1, 1.5), thickness_m=0.8)
    return Case(
        "3  along a wall",
        plan(walls=(long,)),
        tuple(((0.35, y), (3.65, y), (1.75, above)) for y, above in ((1.9, 2.0), (1.5, 1.6), (1.1, 0.85))),
        (Note(class_text(long), (0.9, 0.45)),),
    )


def pillar() -> Case:
    """Case 4."""
    block = Block(name="pillar", kind="pillar", polygon=((1.7, 1.2), (2.3, 1.2), (2.3, 1.8), (1.7, 1.8)))
    wall = Wall(name="wall", start=(2.4, 0.0), end=(2.4, 3.0))
    return Case(
        "4  pillar that touches a wall",
        plan(walls=(wall,), blocks=(block,)),
        (((0.4, 1.5), (3.6, 1.5), (3.05, 1.65)),),
        (Note(class_text(block), (0.2, 0.4)), Note(class_text(wall), (2.6, 0.4))),
    )


def end_inside_a_wall() -> Case:
    """Case 5."""
    around = Wall(name="around", start=(2.0, 0.0), end=(2.0, 3.0), thickness_m=0.4)
    return Case(
        "5  end inside a wall",
        plan(walls=(around,)),
        (((2.0, 2.2), (3.6, 2.2), (2.8, 2.3)), ((0.4, 1.2), (2.05, 0.9), (0.55, 0.75))),
        (Note(class_text(around), (2.3, 0.3)),),
    )


def doors() -> Case:
    """Case 6."""
    parts = tuple(
        Wall(name=f"part_{i}", start=(2.0, low), end=(2.0, high))
        for i, (low, high) in enumerate([(0.0, 0.35), (1.25, 1.75), (2.65, 3.0)])
    )
    two_doors = (
        Door(name="closed", start=(2.0, 0.35), end=(2.0, 1.25), closed=True),
        Door(name="open", start=(2.0, 2.65), end=(2.0, 1.75)),
    )
    return Case(
        "6  door open and closed",
        plan(walls=parts, doors=two_doors),
        (((0.4, 2.1), (3.6, 2.1), (3.1, 2.2)), ((0.4, 0.8), (3.6, 0.8), (3.1, 0.9))),
        (Note(class_text(parts[0]), (2.2, 0.1)),),
    )


def crossings(case: Case, a: Point, b: Point) -> list[tuple[Point, float]]:
    """Return where a ray from a to b crosses faces and closed doors, and the loss at each [dB]."""
    faces = radio_faces(case.plan, RADIO)
    ray = shapely.LineString([a, b])
    found = []
    for index, (ends_mm, weight) in enumerate(zip(faces.ends_mm.reshape(-1, 2, 2), faces.weights, strict=True)):
        door = index - (len(faces.weights) - len(faces.doors))
        if door >= 0 and not list(faces.doors.values())[door]:
            continue
        meeting = ray.intersection(shapely.LineString((ends_mm + MOVED_MM) / MM_PER_M))
        if not meeting.is_empty:
            found.append(((meeting.x, meeting.y), weight / UNITS_PER_DB))
    return sorted(found, key=lambda crossing: float(np.hypot(*np.subtract(crossing[0], a))))


def checked_sum_db(case: Case, a: Point, b: Point, losses_db: list[float]) -> float:
    """Return the loss of walls and doors on a ray from the library, which must equal the sum of the crossings [dB]."""
    free_db = RadioField(plan(), RADIO).path_loss_db(a, b)
    total_db = RadioField(case.plan, RADIO).path_loss_db(a, b) - free_db
    if abs(total_db - sum(losses_db)) > 1e-9:
        sys.exit(f"draw_cases: {case.title}: the library has {total_db:g} dB, the crossings drawn {losses_db}")
    return abs(total_db)


def write_next_to(axes: Axes, text: str, point: Point, offset_points: np.ndarray, colour: str) -> None:
    """Write a text next to a point."""
    axes.annotate(
        text,
        point,
        xytext=tuple(offset_points),
        textcoords="offset points",
        ha="center",
        va="center",
        color=colour,
        fontsize=9,
        zorder=8,
        path_effects=HALO,
    )


def draw(axes: Axes, case: Case) -> None:
    """Draw one case."""
    draw_floor_plan(axes, case.plan)
    for a, b, text_at in case.rays:
        found = crossings(case, a, b)
        total_db = checked_sum_db(case, a, b, [loss_db for _, loss_db in found])
        axes.plot(*zip(a, b, strict=True), "-", color=ROBOT, linewidth=1.6, zorder=5, path_effects=HALO)
        ahead = np.subtract(b, a) / np.hypot(*np.subtract(b, a))
        for name, end, outward in (("a", a, -ahead), ("b", b, ahead)):
            axes.plot(*end, "o", color=ROBOT, markersize=6, markeredgecolor=palette.PAPER, zorder=6)
            write_next_to(axes, name, end, 10.0 * outward, ROBOT)
        points = list(dict.fromkeys(point for point, _ in found))
        for i, point in enumerate(points):
            axes.plot(*point, "o", color=PAID, markersize=7, markeredgecolor=palette.PAPER, zorder=7)
            here = " + ".join(f"{loss_db:g}" for there, loss_db in found if there == point)
            side = 1.0 if i == len(points) - 1 else -1.0 if i == 0 else 0.0
            below = -1.0 if side * ahead[1] >= 0.0 else 1.0
            write_next_to(axes, here, point, np.array([side * 17.0, below * (9.0 if side else 34.0)]), PAID)
        text = f"{total_db:g} dB"
        axes.text(*text_at, text, color=PAID, fontsize=11, weight="bold", zorder=8, path_effects=HALO)
    for note in case.notes:
        axes.text(*note.at, note.text, color=INK, fontsize=9, zorder=8, path_effects=HALO)
    axes.set(xlim=(0.0, 4.0), ylim=(0.0, 3.0), xticks=[], yticks=[])
    axes.set_title(case.title, loc="left", fontsize=11)


def main() -> None:
    """Write the picture."""
    figure = Figure(figsize=(12.0, 6.6), dpi=120, layout="constrained")
    figure.get_layout_engine().set(h_pad=0.1)
    for axes, case in zip(figure.subplots(2, 3).flat, cases(), strict=True):
        draw(axes, case)
    PATH.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(PATH)
    print(f"docs/images/{PATH.name}: {PATH.stat().st_size // 1024} kB")


if __name__ == "__main__":
    main()

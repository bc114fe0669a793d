"""Draws a floor plan, and the areas, victims, objects and robots of a scenario."""

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Patch, Polygon

from robotteamsim import palette
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.scenario import Door, FloorPlan, Scenario, solids
from robotteamsim.scenario.base import PlanarPose
from robotteamsim.scenario.body import corners_at
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import bay_lines, floors, level_marks
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.setup import Setup

VICTIM_SHAPES = {"waiting": "X", "heard": "^", "saved": "s", "safe": "s", "dead": "P"}
"""Markers by state; colour alone does not suffice for everybody."""

_PLAN_INCHES = 11.0


def draw_plan(plan: FloorPlan, setup: Setup | None = None) -> Figure:
    """Return a floor plan to scale, with the areas, victims, objects and robots of a scenario if one is given."""
    (min_x, min_y), (max_x, max_y) = plan.bounds.min, plan.bounds.max
    width_m, height_m = max_x - min_x, max_y - min_y
    scale = _PLAN_INCHES / max(width_m, height_m)
    figure = PlainFigure(figsize=(width_m * scale + 1.0, height_m * scale + 1.4), dpi=120, layout="constrained")
    axes = figure.subplots()
    draw_floor_plan(axes, plan)
    if setup is not None:
        _draw_mission(axes, setup.scenario, unit_m=max(width_m, height_m) / 60.0)
        _draw_objects(axes, setup.scenario)
        _draw_robots(axes, setup.robots)
        figure.legend(loc="outside lower center", ncols=5, frameon=False, fontsize=9)
    margin_m = 0.01 * max(width_m, height_m)
    axes.set_xlim(min_x - margin_m, max_x + margin_m)
    axes.set_ylim(min_y - margin_m, max_y + margin_m)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    scenario = plan.name if setup is None else setup.scenario.name
    name = plan.name if scenario == plan.name else f"{scenario} in {plan.name}"
    axes.set_title(f"{name}, {width_m:g} x {height_m:g} m", fontsize=11)
    return figure


def draw_floor_plan(axes: Axes, plan: FloorPlan, *, floor: bool = True) -> None:
    """Draw the floor, its levels, bays, passages, walls, blocks, pillars and doors to scale in axes of its size [m].

    Closed leaves are drawn in their gaps, and open ones swung out, with their arc, or slid aside.

    Args: floor: whether to draw floor and bays; not if the axes show a map of the floor.
    """
    (min_x, min_y), (max_x, max_y) = plan.bounds.min, plan.bounds.max
    if floor:
        for bounds in floors(plan):
            (x0, y0), (x1, y1) = bounds.min, bounds.max
            axes.fill([x0, x1, x1, x0], [y0, y0, y1, y1], color=palette.FLOOR, zorder=0)
        axes.add_collection(LineCollection(bay_lines(plan), colors=palette.BAY, linewidths=0.8, zorder=1))
    for solid in solids(plan.model_copy(update={"doors": ()})):
        colour = palette.SOLIDS[solid.kind]
        # The thin edge hides the gaps that anti-aliasing leaves between adjacent polygons.
        axes.add_patch(Polygon(solid.corners, facecolor=colour, edgecolor=colour, linewidth=0.4, zorder=3))

    for door in plan.doors:
        _draw_door(axes, door)
    for name, corner in level_marks(plan):
        axes.annotate(name, corner, (3, 3), textcoords="offset points", color=palette.SOFT_INK, fontsize=9, zorder=5)
    for passage in plan.passages:
        for stop in passage.stops:
            axes.add_patch(Circle(stop, passage.radius_m, fill=False, edgecolor=palette.SOFT_INK, zorder=3))
            axes.text(*stop, passage.name, color=palette.SOFT_INK, fontsize=7, ha="center", va="center", zorder=5)
    axes.set(xlim=(min_x, max_x), ylim=(min_y, max_y), aspect="equal")
    axes.spines[:].set_visible(False)


def _draw_door(axes: Axes, door: Door) -> None:
    (x0, y0), (x1, y1) = door.start, door.end
    colour = palette.DOORS[door.kind]
    if door.closed:
        axes.plot([x0, x1], [y0, y1], color=colour, linewidth=3.0, solid_capstyle="butt", zorder=4)
        return
    if door.motion == "slide":
        axes.plot([x0, 2 * x0 - x1], [y0, 2 * y0 - y1], color=colour, linewidth=2.0, zorder=4)
        axes.plot([x0, x1], [y0, y1], color=colour, linewidth=0.7, linestyle=":", zorder=4)
        return
    length_m, heading_deg = math.dist(door.start, door.end), math.degrees(math.atan2(y1 - y0, x1 - x0))
    # An instant door has no leaf when open, but is drawn like other doors.
    turn_rad = door.leaf_angle_rad or 0.5 * math.pi
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    leaf_x, leaf_y = cos * (x1 - x0) - sin * (y1 - y0), sin * (x1 - x0) + cos * (y1 - y0)
    axes.plot([x0, x0 + leaf_x], [y0, y0 + leaf_y], color=colour, linewidth=2.0, zorder=4)
    first_deg, last_deg = sorted((heading_deg, heading_deg + math.degrees(turn_rad)))
    sweep = Arc(door.start, 2 * length_m, 2 * length_m, theta1=first_deg, theta2=last_deg)
    sweep.set(color=colour, linewidth=0.7, linestyle=":", zorder=4)
    axes.add_patch(sweep)


def _draw_mission(axes: Axes, scenario: Scenario, unit_m: float) -> None:
    """Draw areas as circles numbered in their order, victims as named crosses."""
    areas, victims = scenario.mission.areas, scenario.mission.victims
    for number, area in enumerate(areas, 1):
        circle = Circle(
            area.center,
            area.radius_m,
            facecolor=palette.EXPLORED_AREA,
            edgecolor=palette.EXPLORED_AREA,
            alpha=0.25,
            zorder=2,
        )
        axes.add_patch(circle)
        axes.text(
            *area.center, str(number), color=palette.EXPLORED_AREA, ha="center", va="center", weight="bold", zorder=5
        )
    if areas:
        axes.plot([], [], "o", color=palette.EXPLORED_AREA, alpha=0.4, markersize=9, label="area, in this order")
    for i, victim in enumerate(victims):
        axes.plot(*victim.position, "X", color=palette.WAITING, markersize=9, label=None if i else "victim", zorder=6)
        x, y = victim.position
        axes.text(
            x, y + 0.5 * unit_m, victim.name, color=palette.WAITING, fontsize=8, ha="center", va="bottom", zorder=6
        )


def _draw_robots(axes: Axes, robots: Sequence[PlacedRobot]) -> None:
    bodies = [_outline(robot, robot.start_pose) for robot in robots]
    axes.add_collection(
        PatchCollection(bodies, facecolor=palette.BLUE, edgecolor=palette.PAPER, linewidth=0.4, zorder=6)
    )
    headings = []
    for robot in robots:
        x, y, yaw = robot.start_pose
        reach_m = 2.0 * robot.reach_m
        headings.append([(x, y), (x + reach_m * math.cos(yaw), y + reach_m * math.sin(yaw))])
    axes.add_collection(LineCollection(headings, colors=palette.BLUE, linewidths=1.0, zorder=6))
    count = f"{len(robots)} robots" if len(robots) > 1 else "robot"
    axes.plot([], [], "o", color=palette.BLUE, markersize=6, label=f"{count} at the start")


def _draw_objects(axes: Axes, scenario: Scenario) -> None:
    """Draw objects to scale where they stand at the start."""
    shapes = [_outline(obj, obj.pose) for obj in scenario.objects]
    if shapes:
        axes.add_collection(
            PatchCollection(shapes, facecolor=palette.OBJECT, edgecolor=palette.PAPER, linewidth=0.4, zorder=5)
        )
        axes.plot([], [], "s", color=palette.OBJECT, markersize=6, label="object that robots push")


def _outline(thing: PlacedRobot | MovableObject, pose: PlanarPose) -> Patch:
    return Polygon(corners_at(thing.corners_m, pose)) if thing.corners_m else Circle(pose[:2], thing.reach_m)

"""Draws recorded runs on the floor plan: floor, areas, victims, paths, robots, and the entries of legends."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb, to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke

from robotteamsim import palette
from robotteamsim.analysis.plan_picture import VICTIM_SHAPES, draw_floor_plan
from robotteamsim.analysis.runs.totals import endangered_links, onsets
from robotteamsim.recording.replay.recorded_run import RecordedRobot, RecordedRun
from robotteamsim.recording.topics.mission import PublishedArea, PublishedVictim
from robotteamsim.recording.topics.world import BURNING_VALUE, BURNT_OUT_VALUE
from robotteamsim.scenario import FloorPlan
from robotteamsim.scenario.plan import OCCUPIED, UNKNOWN, OccupancyGrid

MAX_NAMED_ROBOTS = 14

_FIREFIGHTER_DASHES = (0, (4.0, 1.6))
_FIREFIGHTER_STYLE: dict[str, Any] = {"marker": "^", "markersize": 9, "markeredgecolor": palette.HELMET}
_FIREFIGHTER_STYLE |= {"markeredgewidth": 1.8}
_CENTRE_STYLE: dict[str, Any] = {"color": palette.PAPER, "marker": "s", "markersize": 9, "linestyle": ""}
_CENTRE_STYLE |= {"markeredgecolor": palette.INK, "markeredgewidth": 1.8}
_DENSEST_SMOKE = 0.75
"""Opacity where one sees nothing."""
_FIRE = (
    ("burnt out", BURNT_OUT_VALUE, palette.CHAR, 0.55),
    ("burning", BURNING_VALUE, palette.FLAME, 0.85),
)
"""Label, value of cells, colour and opacity."""
_MARGIN = 0.03
_MIN_SIZE_M = 4.0


def colour_of(index: int, robot: RecordedRobot) -> str:
    """Return the colour of a robot by its number, as in rviz, or by its index if it has no number."""
    return palette.robot_colour(index if robot.robot_id is None else robot.robot_id)


def drawn_robots(run: RecordedRun) -> list[tuple[int, RecordedRobot]]:
    """Return the drawn robots with their indices: those with a path in `map`, or all robots if there are none."""
    indexed = list(enumerate(run.robots))
    return [(i, robot) for i, robot in indexed if robot.track.is_on_map] or indexed


def is_on_map(run: RecordedRun) -> bool:
    """Whether the drawing is in `map`; otherwise each path is in the frame of its own odometry."""
    return any(robot.track.is_on_map for robot in run.robots) or not run.robots


def extent_m(run: RecordedRun, plan: FloorPlan | None) -> tuple[float, float, float, float]:
    """Return min x, max x, min y, max y to draw [m]."""
    corners = [
        np.vstack((r.track.poses[:, :2].min(axis=0), r.track.poses[:, :2].max(axis=0))) for _, r in drawn_robots(run)
    ]
    if is_on_map(run):
        for area in run.areas:
            corners.append(np.add(area.center_m, ((-area.radius_m,) * 2, (area.radius_m,) * 2)))
        if plan:
            corners.append(np.array([plan.bounds.min, plan.bounds.max]))
        elif run.grid is not None:
            corners.append(_known_corners(run.grid))
    if not corners:
        return 0.0, _MIN_SIZE_M, 0.0, _MIN_SIZE_M
    low, high = np.min([pair[0] for pair in corners], axis=0), np.max([pair[1] for pair in corners], axis=0)
    middle, half = (low + high) / 2.0, np.maximum((high - low) / 2.0, _MIN_SIZE_M / 2.0)
    half = half + _MARGIN * half.max()
    (x0, y0), (x1, y1) = (middle - half).tolist(), (middle + half).tolist()
    return x0, x1, y0, y1


def _known_corners(grid: OccupancyGrid) -> np.ndarray:
    """Return the corners of the known part of a map, or of the whole map if nothing is known, shape (2, 2) [m]."""
    rows, columns = (np.flatnonzero((grid.cells != UNKNOWN).any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        rows, columns = (np.arange(size) for size in grid.cells.shape)
    cells = np.array([[columns[0], rows[0]], [columns[-1] + 1, rows[-1] + 1]])
    return np.asarray(grid.origin_m + cells * grid.resolution_m)


def draw_floor(axes: Axes, run: RecordedRun, plan: FloorPlan | None) -> None:
    """Draw the walls of a floor plan if one is given, else those of the bag's /map; set up the axes [m]."""
    x0, x1, y0, y1 = extent_m(run, plan)
    if is_on_map(run) and plan:
        draw_floor_plan(axes, plan)
    elif is_on_map(run) and run.grid is not None:
        _draw_grid(axes, run.grid)
    else:
        axes.grid(color=palette.GRID, linewidth=0.6)
        axes.set_axisbelow(True)
    if not (run.robots or run.areas or run.grid or plan):
        axes.set(xticks=[], yticks=[])
        axes.text(
            0.5,
            0.5,
            "no paths and no floor plan in this bag",
            ha="center",
            color=palette.FAINT_INK,
            transform=axes.transAxes,
        )
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    where = "" if is_on_map(run) else ", each robot in the frame of its own odometry"
    axes.set_xlabel(f"x [m]{where}", fontsize=8)
    axes.set_ylabel("y [m]", fontsize=8)
    axes.tick_params(labelsize=7, length=2)
    axes.spines[:].set_visible(False)


def _draw_grid(axes: Axes, grid: OccupancyGrid) -> None:
    levels = np.clip(np.arange(256) / OCCUPIED, 0.0, 1.0)[:, None]
    colours = (1.0 - levels) * to_rgb(palette.FLOOR) + levels * to_rgb(palette.SOLIDS["wall"])
    colours[np.uint8(UNKNOWN & 0xFF)] = to_rgb(palette.UNSEEN)
    image = np.round(255.0 * colours).astype(np.uint8)[grid.cells.view(np.uint8)]
    # Where cells are smaller than pixels, colours are averaged and not classes, so thin walls do not vanish.
    axes.imshow(image, origin="lower", extent=_extent(grid), interpolation="antialiased", zorder=0)


def _extent(grid: OccupancyGrid) -> tuple[float, float, float, float]:
    """Return min x, max x, min y, max y [m]."""
    (x, y), (rows, columns) = grid.origin_m, grid.cells.shape
    return x, x + columns * grid.resolution_m, y, y + rows * grid.resolution_m


def draw_hazards(axes: Axes, run: RecordedRun) -> None:
    """Draw the last smoke and fire of a run over the floor."""
    if run.smoke is not None:
        cells = run.smoke.cells.clip(0, 100)
        _draw_cells(axes, run.smoke, palette.SMOKE, _DENSEST_SMOKE * cells / 100.0)
    if run.fire is not None:
        for _, value, colour, alpha in _FIRE:
            _draw_cells(axes, run.fire, colour, np.where(run.fire.cells == value, alpha, 0.0))


def _draw_cells(axes: Axes, grid: OccupancyGrid, colour: str, alpha: np.ndarray) -> None:
    image = np.zeros((*grid.cells.shape, 4))
    image[..., :3], image[..., 3] = to_rgb(colour), alpha
    axes.imshow(image, origin="lower", extent=_extent(grid), interpolation="nearest", zorder=1)


def hazard_entries(runs: Sequence[RecordedRun]) -> list[Line2D]:
    """Return the entries of smoke and fire that are drawn."""
    entries = []
    if any(run.smoke is not None and run.smoke.cells.max() > 0 for run in runs):
        entries.append(mark("s", palette.SMOKE, "smoke", alpha=_DENSEST_SMOKE))
    for label, value, colour, alpha in _FIRE:
        if any(run.fire is not None and (run.fire.cells == value).any() for run in runs):
            entries.append(mark("s", colour, label, alpha=alpha))
    return entries


def draw_areas(axes: Axes, areas: tuple[PublishedArea, ...], explored: tuple[bool, ...]) -> list[Circle]:
    """Draw areas as circles with their number, filled if explored; return the circles."""
    circles = []
    for number, area in enumerate(areas, 1):
        is_explored = number <= len(explored) and explored[number - 1]
        colour = to_rgba(palette.EXPLORED_AREA, 0.28 if is_explored else 0.05)
        style = "-" if is_explored else ":"
        circle = Circle(
            area.center_m, area.radius_m, facecolor=colour, edgecolor=palette.EXPLORED_AREA, linestyle=style, zorder=2
        )
        axes.add_patch(circle)
        circles.append(circle)
        name = axes.text(
            *area.center_m, str(number), color=palette.EXPLORED_AREA, ha="center", va="center", weight="bold", zorder=6
        )
        name.set_path_effects([withStroke(linewidth=2.5, foreground=palette.PAPER)])
    return circles


def victim_style(state: str) -> dict[str, Any]:
    """Return Matplotlib's properties of the marker of a victim."""
    colour, shape = palette.VICTIM_STATES.get(state, palette.INK), VICTIM_SHAPES.get(state, "o")
    return {"color": colour, "marker": shape, "markersize": 10, "linestyle": "", "markeredgecolor": palette.INK}


def draw_victims(axes: Axes, victims: tuple[PublishedVictim, ...]) -> None:
    """Draw victims in the colour and the shape of their state."""
    for victim in victims:
        axes.plot(*victim.position_m, **victim_style(victim.state), zorder=7)


def draw_paths(axes: Axes, run: RecordedRun) -> None:
    """Draw every path, with a ring at its start and a dot at its end, and both at each absence of the robot.

    Firefighters have dashed paths that end in a red triangle; a command centre is a square.
    """
    for index, robot in drawn_robots(run):
        colour, places = colour_of(index, robot), robot.track.poses[:, :2]
        begins = np.array([0, *robot.track.breaks])
        ends = np.array([*robot.track.breaks, len(places)]) - 1
        halo = [withStroke(linewidth=3.4, foreground=palette.PAPER, alpha=0.7)]
        if robot.role == "command_centre":
            axes.plot(*places[-1], **_CENTRE_STYLE, zorder=8)
            continue
        is_person = robot.role == "firefighter"
        axes.plot(
            *robot.track.line(0, len(places)).T,
            color=colour,
            linewidth=1.9,
            linestyle=_FIREFIGHTER_DASHES if is_person else "-",
            zorder=4,
            path_effects=halo,
        )
        axes.plot(*places[begins].T, "o", color=palette.PAPER, markeredgecolor=colour, markersize=5, zorder=5)
        if is_person:
            axes.plot(*places[ends].T, color=colour, **_FIREFIGHTER_STYLE, zorder=8)
        else:
            axes.plot(*places[ends].T, "o", color=colour, markeredgecolor=palette.PAPER, markersize=8, zorder=8)


def draw_collisions(axes: Axes, run: RecordedRun) -> None:
    """Draw a star at each place where a robot began to touch something."""
    for _, robot in drawn_robots(run):
        if robot.contact is not None:
            for stamp_ns in robot.contact.stamps_ns[onsets(robot.contact.values)].tolist():
                place = robot.track.poses[robot.track.index_at(stamp_ns), :2]
                axes.plot(*place, "*", color=palette.COLLISION, markersize=9, markeredgecolor=palette.PAPER, zorder=8)


def robot_entries(run: RecordedRun) -> list[Line2D]:
    """Return one line for each of the first drawn members of the team."""
    return [_entry(index, robot) for index, robot in drawn_robots(run)[:MAX_NAMED_ROBOTS]]


def _entry(index: int, robot: RecordedRobot) -> Line2D:
    if robot.role == "command_centre":
        return Line2D([], [], label="command centre", **_CENTRE_STYLE)
    colour = colour_of(index, robot)
    if robot.role == "firefighter":
        entry = line(colour, f"firefighter {robot.robot_id}")
        entry.set(linestyle=_FIREFIGHTER_DASHES, **_FIREFIGHTER_STYLE)
        return entry
    return line(colour, robot.name)


def victim_entries(states: set[str]) -> list[Line2D]:
    """Return one mark for each state of victims, in the order of a mission."""
    return [
        Line2D([], [], label=f"victim {state}", **victim_style(state))
        for state in palette.VICTIM_STATES
        if state in states
    ]


def states_at_end(runs: Sequence[RecordedRun]) -> set[str]:
    """Return the last states of all victims."""
    return {victim.state for run in runs if run.victims for victim in run.victims[-1][1]}


def area_entries(runs: Sequence[RecordedRun]) -> list[Line2D]:
    """Return the entry of areas, if there are any."""
    if not any(run.areas for run in runs):
        return []
    return [mark("o", palette.EXPLORED_AREA, "area, filled when explored", alpha=0.35)]


def film_entries(run: RecordedRun) -> list[Line2D]:
    """Return everything that is drawn on the plan of a film."""
    states = {victim.state for _, victims in run.victims for victim in victims}
    entries = [*robot_entries(run), *victim_entries(states), *area_entries([run])]
    if run.network is not None and len(run.robots) > 1:
        entries.append(line(palette.STRONG_LINK, "link"))
        if endangered_links(run.network).any():
            entries.append(line(palette.ENDANGERED_LINK, "endangered link", dashed=True))
    return entries


def line(colour: str, label: str, dashed: bool = False) -> Line2D:
    """Return the entry of a line."""
    return Line2D([], [], color=colour, linewidth=2.4, linestyle="--" if dashed else "-", label=label)


def mark(shape: str, colour: str, label: str, edge: str = palette.PAPER, alpha: float = 1.0) -> Line2D:
    """Return the entry of a marker."""
    entry = Line2D([], [], color=colour, marker=shape, linestyle="", markersize=8, markeredgecolor=edge, label=label)
    entry.set_alpha(alpha)
    return entry

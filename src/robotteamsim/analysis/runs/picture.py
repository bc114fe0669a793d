"""Pictures of recorded runs: paths on the floor plan and curves over time, of one run or several side by side."""

import itertools
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from robotteamsim import palette
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.runs.curves import curves, draw_column, draw_speeds
from robotteamsim.analysis.runs.plan_panel import (
    MAX_NAMED_ROBOTS,
    area_entries,
    draw_areas,
    draw_collisions,
    draw_floor,
    draw_hazards,
    draw_paths,
    draw_victims,
    drawn_robots,
    extent_m,
    hazard_entries,
    is_on_map,
    mark,
    robot_entries,
    states_at_end,
    victim_entries,
)
from robotteamsim.analysis.runs.totals import RunTotals
from robotteamsim.mission.status import END_TEXTS
from robotteamsim.recording.replay.recorded_run import RecordedRun
from robotteamsim.scenario import FloorPlan

_SLIDE_INCHES = (13.3, 7.0)
_MAX_OMITTED = 5
_LEGEND_COLUMNS = 7


def draw_runs(runs: Sequence[RecordedRun], all_totals: Sequence[RunTotals], plan: FloorPlan | None = None) -> Figure:
    """Return one run on a slide, or several runs in columns with the same scales.

    Args: plan: drawn instead of the /map of the bags.
    """
    if len(runs) == 1:
        return _draw_one(runs[0], all_totals[0], plan)
    return _draw_columns(runs, all_totals, plan)


def outcome(totals: RunTotals) -> str:
    """Return the outcome of the mission in one line, or "" if there was no mission."""
    mission = totals.mission
    if mission is None:
        return ""
    end = END_TEXTS.get(mission.end, "end not in this bag")
    counts = [f"{mission.areas_explored}/{mission.num_areas} areas"] if mission.num_areas else []
    counts += [f"{mission.victims_saved}/{mission.num_victims} victims"] if mission.num_victims else []
    return f"{', '.join(counts)} in {mission.time_s:.1f} s: {end}".lstrip()


def _draw_one(run: RecordedRun, totals: RunTotals, plan: FloorPlan | None) -> Figure:
    figure = PlainFigure(figsize=_SLIDE_INCHES, dpi=120, layout="constrained")
    x0, x1, y0, y1 = extent_m(run, plan)
    is_tall = (y1 - y0) > 1.2 * (x1 - x0)
    grid = figure.add_gridspec(1, 2, width_ratios=(0.9, 1.0) if is_tall else (1.75, 1.0))
    floor = figure.add_subplot(grid[0])
    _draw_plan(floor, run, plan)
    draw_column(figure, grid[1], curves(run), run)
    figure.suptitle(totals.title, x=0.01, ha="left", fontsize=13, weight="bold", color=palette.INK)
    floor.set_title(outcome(totals), loc="left", fontsize=10)
    _add_legend(figure, [run], [totals], with_totals=True)
    # The layout of axes with equal scales converges only after some passes; before, texts may overlap.
    for _ in range(2):
        figure.draw_without_rendering()
    return figure


def _draw_columns(runs: Sequence[RecordedRun], all_totals: Sequence[RunTotals], plan: FloorPlan | None) -> Figure:
    # Every curve of any run, in the order of the run with most curves.
    in_order = sorted(map(curves, runs), key=len, reverse=True)
    rows = [draw for draw in dict.fromkeys(itertools.chain.from_iterable(in_order)) if draw is not draw_speeds]
    height = 2.6 + 1.25 * len(rows) + 0.9
    figure = PlainFigure(figsize=(max(4.4 * len(runs), 8.8), height), dpi=120, layout="constrained")
    all_axes = figure.subplots(1 + len(rows), len(runs), squeeze=False, height_ratios=[2.6, *(1.0 for _ in rows)])
    for column, (run, totals) in enumerate(zip(runs, all_totals, strict=True)):
        _draw_plan(all_axes[0, column], run, plan)
        all_axes[0, column].set_title(f"{totals.title}\n{outcome(totals)}", loc="left", fontsize=8)
        known = curves(run)
        for row, draw in enumerate(rows, 1):
            axes = all_axes[row, column]
            if draw in known:
                draw(axes, run)
                if column > 0 and axes.get_legend():
                    axes.get_legend().remove()
            else:
                axes.set_axis_off()
                axes.text(0.5, 0.5, "not in this bag", ha="center", va="center", color=palette.FAINT_INK, fontsize=8)
        all_axes[-1, column].set_xlabel("time [s]", fontsize=8)
    for row in range(1, 1 + len(rows)):
        _share(all_axes[row])
    _add_legend(figure, runs, all_totals, with_totals=False)
    return figure


def _share(row: Sequence[Axes]) -> None:
    """Give the axes of one row the same limits."""
    drawn = [axes for axes in row if axes.axison]
    for axes in drawn[1:]:
        axes.sharex(drawn[0])
        axes.sharey(drawn[0])
    for axes in drawn:
        axes.autoscale(axis="x")
    highest = max((axes.get_ylim()[1] for axes in drawn), default=1.0)
    if drawn:
        drawn[0].set_ylim(0.0, highest)


def _draw_plan(axes: Axes, run: RecordedRun, plan: FloorPlan | None) -> None:
    draw_floor(axes, run, plan)
    if is_on_map(run):
        draw_hazards(axes, run)
        draw_areas(axes, run.areas, run.statuses[-1][1].explored if run.statuses else ())
        if run.victims:
            draw_victims(axes, run.victims[-1][1])
    draw_paths(axes, run)
    draw_collisions(axes, run)


def _add_legend(
    figure: Figure, runs: Sequence[RecordedRun], all_totals: Sequence[RunTotals], with_totals: bool
) -> None:
    most = max(runs, key=lambda run: len(run.robots))
    handles = _entries_with_totals(runs[0], all_totals[0]) if with_totals else robot_entries(most)
    if any(run.robots for run in runs):
        handles.append(mark("o", palette.PAPER, "start", edge=palette.SOFT_INK))
        handles.append(mark("o", palette.SOFT_INK, "end"))
    handles += [*victim_entries(states_at_end(runs)), *area_entries(runs), *hazard_entries(runs)]
    if any(totals.collisions for totals in all_totals):
        handles.append(mark("*", palette.COLLISION, "collision"))
    legend = figure.legend(
        handles=handles, loc="outside lower left", ncols=_LEGEND_COLUMNS, frameon=False, fontsize=8, alignment="left"
    )
    if lines := _omitted(all_totals):
        legend.set_title("\n".join(lines))
        legend.get_title().set(fontsize=7, color=palette.FAINT_INK)


def _omitted(all_totals: Sequence[RunTotals]) -> list[str]:
    lines = [
        f"{totals.bag}: {line}" if len(all_totals) > 1 else line for totals in all_totals for line in totals.omitted
    ]
    shown = lines if len(lines) <= _MAX_OMITTED else [*lines[:_MAX_OMITTED], f"and {len(lines) - _MAX_OMITTED} more"]
    rows = ["; ".join(shown[row : row + 2]) for row in range(0, len(shown), 2)]
    return [f"omitted: {row}" for row in rows]


def _entries_with_totals(run: RecordedRun, totals: RunTotals) -> list[Line2D]:
    entries = robot_entries(run)
    for (index, robot_of_run), entry in zip(drawn_robots(run)[:MAX_NAMED_ROBOTS], entries, strict=True):
        robot = totals.robots[index]
        if robot_of_run.role == "command_centre":
            continue
        speed = "" if robot.mean_speed_mps is None else f", {robot.mean_speed_mps:.2f} m/s"
        entry.set_label(f"{entry.get_label()}: {robot.distance_m:.0f} m{speed}")
    return entries

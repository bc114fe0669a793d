"""Curves of recorded runs over time: progress, network, distances."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import Normal, withStroke
from matplotlib.ticker import MaxNLocator

from robotteamsim import palette
from robotteamsim.analysis.runs.plan_panel import colour_of
from robotteamsim.analysis.runs.totals import endangered_links, is_split, links, max_hops, onsets, speeds_mps
from robotteamsim.recording.replay.recorded_run import RecordedRun

Curve = Callable[[Axes, RecordedRun], None]

_SMOOTH_S = 10


def curves(run: RecordedRun) -> list[Curve]:
    """Return the curves that can be drawn for a run, from top to bottom."""
    found: list[Curve] = []
    if run.statuses:
        found.append(draw_progress)
    if run.egress is not None and run.egress.has_ways_out:
        found.append(draw_people_out)
    if run.network is not None and run.network.num_robots:
        found += [draw_links, draw_hops, draw_fiedler]
    if run.robots:
        found += [draw_speeds, draw_distances]
    return found


def draw_column(figure: Figure, place: Any, shown: Sequence[Curve], run: RecordedRun) -> list[Axes]:
    """Draw curves one below the other over the same time; return their axes. Args: place: a cell of a GridSpec."""
    column = place.subgridspec(max(len(shown), 1), 1)
    all_axes: list[Axes] = []
    for row, draw in enumerate(shown):
        all_axes.append(figure.add_subplot(column[row], sharex=all_axes[0] if all_axes else None))
        draw(all_axes[-1], run)
    for axes in all_axes[:-1]:
        axes.tick_params(labelbottom=False)
    if all_axes:
        all_axes[-1].set_xlabel("time [s]", fontsize=8)
    return all_axes


def draw_progress(axes: Axes, run: RecordedRun) -> None:
    """Areas explored, victims heard and saved."""
    times_s = run.time_s(np.array([stamp_ns for stamp_ns, _ in run.statuses]))
    saved = [status.num_saved for _, status in run.statuses]
    heard = [status.num_heard for _, status in run.statuses]
    explored = [sum(status.explored) for _, status in run.statuses]
    # Lines that coincide stay visible, because each lies within the one before.
    dashed: dict[str, Any] = {"color": palette.INK, "linewidth": 1.3, "linestyle": (0, (4, 2))}
    _, last = run.statuses[-1]
    if last.explored:
        axes.step(times_s, explored, where="post", color=palette.EXPLORED_AREA, linewidth=4.0, label="areas explored")
    if last.victims:
        outline = [withStroke(linewidth=3.2, foreground=palette.INK), Normal()]
        edge: dict[str, Any] = {"path_effects": outline, "linewidth": 2.2}
        axes.step(times_s, heard, where="post", color=palette.HEARD, label="victims heard", **edge)
        axes.step(times_s, saved, where="post", label="victims saved", **dashed)
    _whole(axes, max(len(last.explored), len(last.victims), 1))
    _finish(axes, "mission")


def draw_people_out(axes: Axes, run: RecordedRun) -> None:
    """People who are safe, by exit."""
    assert run.egress is not None
    end_s = float(run.time_s(np.array(run.end_ns)))
    for index, name in enumerate(run.egress.num_out):
        out_s = sorted(person.out_s for person in run.egress.people if person.out_s is not None and person.exit == name)
        times_s, counts = [0.0, *out_s, end_s], [*range(len(out_s) + 1), len(out_s)]
        axes.step(times_s, counts, where="post", color=palette.robot_colour(index), linewidth=1.8, label=name)
    _whole(axes, max(run.egress.num_out.values(), default=1) or 1)
    _finish(axes, "people out")


def draw_links(axes: Axes, run: RecordedRun) -> None:
    """Links, and endangered links."""
    assert run.network is not None
    times_s, count, endangered = run.time_s(run.network.stamps_ns), links(run.network), endangered_links(run.network)
    fill: dict[str, Any] = {"color": palette.ENDANGERED_LINK, "alpha": 0.45, "linewidth": 0}
    axes.fill_between(times_s, endangered, step="post", label="endangered links", **fill)
    axes.step(times_s, count, where="post", color=palette.STRONG_LINK, linewidth=1.6, label="links")
    _whole(axes, int(max(count.max(), 1)))
    _finish(axes, "links")


def draw_hops(axes: Axes, run: RecordedRun) -> None:
    """The longest shortest path between two robots in hops."""
    assert run.network is not None
    hops = max_hops(run.network)
    axes.step(run.time_s(run.network.stamps_ns), hops, where="post", color=palette.HOPS, linewidth=1.6)
    _whole(axes, int(max(hops.max(), 1)))
    _finish(axes, "longest path\n[hops]")


def draw_fiedler(axes: Axes, run: RecordedRun) -> None:
    """The Fiedler value, and the times when the team was split."""
    assert run.network is not None
    times_s, values, split = run.time_s(run.network.stamps_ns), run.network.fiedler_value, is_split(run.network)
    axes.plot(times_s, values, color=palette.FIEDLER, linewidth=1.2)
    axes.set_ylim(0.0, max(1.1 * float(values.max()), 1.0))
    if split.any():
        axes.fill_between(
            times_s,
            0,
            1,
            where=split,
            transform=axes.get_xaxis_transform(),
            color=palette.ENDANGERED_LINK,
            alpha=0.25,
            linewidth=0,
        )
        axes.fill_between([], [], color=palette.ENDANGERED_LINK, alpha=0.25, linewidth=0, label="team split")
    _finish(axes, "Fiedler value")


def draw_speeds(axes: Axes, run: RecordedRun) -> None:
    """The speed of each robot, smoothed over ten seconds unless the run is shorter."""
    label = "speed [m/s]"
    for index, robot in enumerate(run.robots):
        middles_ns, speeds = speeds_mps(robot)
        if len(speeds) >= _SMOOTH_S:
            smooth = np.convolve(speeds, np.full(_SMOOTH_S, 1.0 / _SMOOTH_S), "valid")
            begin = (_SMOOTH_S - 1) // 2
            times_s = run.time_s(middles_ns)[begin : begin + len(smooth)]
            axes.plot(times_s, smooth, color=colour_of(index, robot), linewidth=1.0)
            label = f"speed,\nmean of {_SMOOTH_S} s [m/s]"
        elif len(speeds):
            axes.plot(run.time_s(middles_ns), speeds, color=colour_of(index, robot), linewidth=1.0)
    axes.set_ylim(bottom=0.0)
    _finish(axes, label)


def draw_distances(axes: Axes, run: RecordedRun) -> None:
    """The distance that each robot has driven, with a star at each collision."""
    for index, robot in enumerate(run.robots):
        times_s = run.time_s(robot.track.stamps_ns)
        axes.plot(times_s, robot.track.driven_m, color=colour_of(index, robot), linewidth=1.3)
        if robot.contact is not None:
            hit_ns = robot.contact.stamps_ns[onsets(robot.contact.values)]
            driven_m = np.interp(hit_ns, robot.track.stamps_ns, robot.track.driven_m)
            axes.plot(run.time_s(hit_ns), driven_m, "*", color=palette.COLLISION, markersize=6, markeredgewidth=0)
    axes.set_ylim(bottom=0.0)
    _finish(axes, "driven [m]")


def _whole(axes: Axes, highest: int) -> None:
    axes.set_ylim(0.0, 1.12 * highest)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=5))


def _finish(axes: Axes, name: str) -> None:
    axes.set_ylabel(name, fontsize=8)
    axes.tick_params(labelsize=7, length=2)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(palette.AXIS)
    axes.grid(axis="y", color=palette.GRID, linewidth=0.6)
    axes.margins(x=0.01)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=7, frameon=False, borderaxespad=0.1)

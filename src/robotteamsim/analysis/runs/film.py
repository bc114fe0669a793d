"""Films of recorded runs, frame by frame: robots, links, victims and areas on the floor plan, and growing curves."""

from collections.abc import Iterator
from typing import Any, Protocol

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.image import AxesImage
from matplotlib.patches import Rectangle

from robotteamsim import palette
from robotteamsim.analysis.plain_figure import PlainFigure
from robotteamsim.analysis.runs.curves import Curve, curves, draw_column, draw_speeds
from robotteamsim.analysis.runs.plan_panel import (
    colour_of,
    draw_areas,
    draw_floor,
    drawn_robots,
    film_entries,
    is_on_map,
    victim_style,
)
from robotteamsim.analysis.runs.totals import RunTotals
from robotteamsim.recording.replay.recorded_run import RecordedNetwork, RecordedRobot, RecordedRun
from robotteamsim.scenario import FloorPlan

_INCHES = (12.8, 7.2)
_TAIL_S = 30.0
"""Length of the bright part of a trail [s of the run]."""

_EVENT_S = 12.0
"""Time for which an event is shown in the caption [s of the run]."""

_LEGEND_COLUMNS = 9
_HIDDEN = (-1e9, -1e9)
_HOLD = 0.08
"""Share of the film that shows the last moment."""


class View(Protocol):
    """What a robot's camera sees in the course of a run."""

    title: str

    def image(self, stamp_ns: int) -> np.ndarray:
        """Return the image of one moment [ns]: uint8, shape (height, width, 3), RGB."""


class RunFilm:
    """Draws the frames of one run."""

    def __init__(
        self, run: RecordedRun, totals: RunTotals, plan: FloorPlan | None, width_px: int, view: View | None = None
    ) -> None:
        """Lay out the film.

        Args:
            plan:     drawn instead of the bag's /map.
            width_px: the height is 9/16 of it.
            view:     of a robot's camera, above the curves.
        """
        self._run, self._view = run, view
        self.figure = PlainFigure(figsize=_INCHES, dpi=width_px / _INCHES[0], layout="constrained")
        self._canvas = FigureCanvasAgg(self.figure)
        shown = [curve for curve in curves(run) if curve is not draw_speeds]
        grid = self.figure.add_gridspec(1, 2, width_ratios=(2.0, 1.0))
        floor = self.figure.add_subplot(grid[0])
        draw_floor(floor, run, plan)
        self._moving: list[Artist] = []
        self._add_places(floor)
        self._add_team(floor)
        self._picture: AxesImage | None = None
        self._covers = self._add_curves(grid[1] if view is None else self._add_view(grid[1], view), shown)
        self.figure.suptitle(totals.title, x=0.01, ha="left", fontsize=13, weight="bold", color=palette.INK)
        entries = film_entries(run)
        self.figure.legend(handles=entries, loc="outside lower left", ncols=_LEGEND_COLUMNS, frameon=False, fontsize=8)
        self._clock = self._text(floor, (0.0, 1.015), "left", 12)
        self._caption = self._text(floor, (1.0, 1.015), "right", 11)
        for artist in self._moving:
            artist.set_animated(True)
        self._canvas.draw()
        self.figure.set_layout_engine("none")
        self._background: Any = self._canvas.copy_from_bbox(self.figure.bbox)

    def frames(self, count: int) -> Iterator[np.ndarray]:
        """Yield `count` frames from the start to the end of the run: uint8, shape (height, width, 3), RGB."""
        moving = max(round((1.0 - _HOLD) * count), 1)
        begin_ns = min((robot.track.stamps_ns[0] for robot in self._run.robots), default=self._run.start_ns)
        stamps_ns = np.linspace(max(begin_ns, self._run.start_ns), self._run.end_ns, moving).astype(np.int64).tolist()
        for stamp_ns in [*stamps_ns, *[self._run.end_ns] * (count - moving)]:
            yield self.frame(stamp_ns)

    def frame(self, stamp_ns: int) -> np.ndarray:
        """Return the frame of one moment [ns]: uint8, shape (height, width, 3), RGB."""
        self._show_team(stamp_ns)
        self._show_links(stamp_ns)
        self._show_places(stamp_ns)
        self._show_time(stamp_ns)
        if self._picture is not None and self._view is not None:
            self._picture.set_data(self._view.image(stamp_ns))
        self._canvas.restore_region(self._background)
        for artist in self._moving:
            self.figure.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()

    def _text(self, axes: Axes, place: tuple[float, float], side: str, size: int) -> Any:
        text = axes.text(*place, " ", ha=side, va="bottom", fontsize=size, color=palette.INK, transform=axes.transAxes)
        self._moving.append(text)
        return text

    def _add_places(self, axes: Axes) -> None:
        is_shown = is_on_map(self._run)
        areas = self._run.areas if is_shown else ()
        self._areas = draw_areas(axes, areas, ())
        most = max((len(victims) for _, victims in self._run.victims), default=0) if is_shown else 0
        self._victims = [axes.plot(*_HIDDEN, zorder=7)[0] for _ in range(most)]
        self._moving += [*self._areas, *self._victims]

    def _add_team(self, axes: Axes) -> None:
        self._links = LineCollection([], linewidths=1.6, zorder=5)
        axes.add_collection(self._links)
        self._trails, self._tails, self._dots, self._noses, self._names = [], [], [], [], []
        for index, robot in drawn_robots(self._run):
            colour = colour_of(index, robot)
            self._trails.append(axes.plot([], [], color=colour, linewidth=1.0, alpha=0.35, zorder=3)[0])
            self._tails.append(axes.plot([], [], color=colour, linewidth=2.2, alpha=0.9, zorder=4)[0])
            self._noses.append(axes.plot([], [], color=colour, linewidth=3.0, zorder=8)[0])
            dot = {"color": colour, "markersize": 13, "markeredgecolor": palette.PAPER, "zorder": 9}
            self._dots.append(axes.plot(*_HIDDEN, "o", **dot)[0])  # type: ignore[arg-type]
            name = str(index if robot.robot_id is None else robot.robot_id)
            style = {"ha": "center", "va": "center", "weight": "bold", "clip_on": True}
            self._names.append(axes.text(*_HIDDEN, name, color=palette.text_on(colour), fontsize=8, zorder=10, **style))  # type: ignore[arg-type]
        team = (self._trails, self._tails, [self._links], self._noses, self._dots, self._names)
        self._moving += [artist for artists in team for artist in artists]
        low, high = axes.get_xlim()
        self._nose_m = 0.018 * (high - low)

    def _add_view(self, place: Any, view: View) -> Any:
        """Add the picture of the camera; return the place below it."""
        rows = place.subgridspec(2, 1, height_ratios=(1.0, 1.4))
        axes = self.figure.add_subplot(rows[0])
        axes.set_axis_off()
        axes.set_title(view.title, loc="left", fontsize=9, color=palette.INK)
        self._picture = axes.imshow(view.image(self._run.start_ns))
        self._moving.append(self._picture)
        return rows[1]

    def _add_curves(self, place: Any, shown: list[Curve]) -> list[Rectangle]:
        """Draw the complete curves; a white cover hides the part after the current time."""
        covers = []
        for axes in draw_column(self.figure, place, shown, self._run):
            axes.set_xlim(0.0, max((self._run.end_ns - self._run.start_ns) / 1e9, 1e-3))
            cover = Rectangle(
                (0.0, 0.0), 1.0, 1.0, transform=axes.get_xaxis_transform(), color=palette.PAPER, alpha=0.82
            )
            cover.set(linewidth=0, zorder=20)
            axes.add_patch(cover)
            covers.append(cover)
        self._moving += covers
        return covers

    def _show_team(self, stamp_ns: int) -> None:
        for k, (_, robot) in enumerate(drawn_robots(self._run)):
            track = robot.track
            now, tail = track.index_at(stamp_ns), track.index_at(stamp_ns - round(_TAIL_S * 1e9))
            self._trails[k].set_data(*track.line(0, tail + 1).T)
            self._tails[k].set_data(*track.line(tail, now + 1).T)
            for artist in (self._noses[k], self._dots[k], self._names[k]):
                artist.set_visible(track.is_present(stamp_ns))
            x, y, yaw_rad = track.poses[now].tolist()
            nose = x + self._nose_m * np.cos(yaw_rad), y + self._nose_m * np.sin(yaw_rad)
            self._noses[k].set_data([x, nose[0]], [y, nose[1]])
            self._dots[k].set_data([x], [y])
            self._names[k].set_position((x, y))

    def _show_links(self, stamp_ns: int) -> None:
        network = self._run.network
        if network is None or not is_on_map(self._run) or stamp_ns < network.stamps_ns[0]:
            return
        segments, colours = link_segments(network, [robot for _, robot in drawn_robots(self._run)], stamp_ns)
        styles = ["--" if colour == palette.ENDANGERED_LINK else "-" for colour in colours]
        self._links.set(segments=segments, color=colours, linestyle=styles or "-")

    def _show_places(self, stamp_ns: int) -> None:
        status = self._run.statuses.at(stamp_ns, None)
        for patch, explored in zip(self._areas, status.explored if status else (), strict=False):
            patch.set(
                facecolor=to_rgba(palette.EXPLORED_AREA, 0.28 if explored else 0.05), linestyle="-" if explored else ":"
            )
        victims = self._run.victims.at(stamp_ns, ())
        for mark, victim in zip(self._victims, victims, strict=False):
            mark.set_data([victim.position_m[0]], [victim.position_m[1]])
            mark.set(**victim_style(victim.state))

    def _show_time(self, stamp_ns: int) -> None:
        now_s = (stamp_ns - self._run.start_ns) / 1e9
        self._clock.set_text(f"{now_s:.0f} s")
        past = [(stamp, event) for stamp, event in self._run.events if stamp <= stamp_ns]
        recent = [event.detail for stamp, event in past if stamp_ns - stamp <= _EVENT_S * 1e9]
        self._caption.set_text(recent[-1] if recent else "")
        for cover in self._covers:
            cover.set_x(now_s)
            cover.set_width(max((self._run.end_ns - stamp_ns) / 1e9, 0.0))


def link_segments(
    network: RecordedNetwork, robots: list[RecordedRobot], stamp_ns: int
) -> tuple[list[np.ndarray], list[str]]:
    """Return the links between robots named robot_<number> at a time: segments, shape (2, 2) [m], and their colours."""
    index = int(np.searchsorted(network.stamps_ns, stamp_ns, side="right")) - 1
    adjacency, endangered = network.adjacency[index], network.endangered[index]
    places = {
        robot.robot_id: robot.track.poses[robot.track.index_at(stamp_ns), :2]
        for robot in robots
        if robot.robot_id is not None and robot.robot_id < len(adjacency)
    }
    segments, colours = [], []
    for i, j in np.argwhere(np.triu(adjacency, 1)).tolist():
        if i in places and j in places:
            segments.append(np.array([places[i], places[j]]))
            colours.append(palette.ENDANGERED_LINK if endangered[i, j] else palette.STRONG_LINK)
    return segments, colours

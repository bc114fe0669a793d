"""Legends of pictures and films of recorded runs: one entry for each kind of thing that is drawn."""

from collections.abc import Sequence

from matplotlib.lines import Line2D

from robotteamsim import palette
from robotteamsim.analysis.runs.plan_panel import colour_of, drawn_robots, victim_style
from robotteamsim.analysis.runs.recorded_run import RecordedRun
from robotteamsim.analysis.runs.totals import endangered_links

MAX_NAMED_ROBOTS = 10


def robot_entries(run: RecordedRun) -> list[Line2D]:
    """Return one line for each of the first ten drawn robots."""
    return [line(colour_of(index, robot), robot.name) for index, robot in drawn_robots(run)[:MAX_NAMED_ROBOTS]]


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

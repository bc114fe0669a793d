"""Tables 6 to 9 of the dissertation as text, with our values next to the dissertation's."""

import dataclasses
import statistics
from collections.abc import Callable, Mapping, Sequence

from robotteamsim.campaign import StoredCampaign
from robotteamsim.campaign.design import NOISE_KEY
from robotteamsim.campaign.summary import UNLIMITED
from robotteamsim.errors import CampaignError
from robotteamsim.wording import column_groups
from study.dissertation.reference import MissionValues, dissertation_missions

Missions = Mapping[float, Sequence[MissionValues | None]]
"""Missions by background noise [dB], in order; None for one that failed or was not run."""

_SHOWN_TRIALS = 30
_NAME_WIDTH = 6
_Column = tuple[str, int, Callable[[MissionValues], float], int]
_VICTIMS: _Column = ("victims saved", 7, lambda values: values.victims_saved, 1)
_TIME: _Column = ("time [s]", 7, lambda values: round(values.time_s), 1)
_AREAS: _Column = ("waypoints", 6, lambda values: values.areas_explored, 2)
_ENDANGERED: _Column = ("endangered", 6, lambda values: values.endangered_links, 2)
_STATISTICS: dict[str, Callable[[list[float]], float]] = {
    "Mean": statistics.fmean,
    "Median": statistics.median,
    "Mode": lambda values: min(statistics.multimode(values)),  # of ties the smallest, as in Table 8: 348 s, not 350 s
}


def missions_by_noise(stored: StoredCampaign, place: str) -> Missions:
    """Return our missions in the form of the dissertation.

    Raises: CampaignError: the campaign is not of the garage, or varies other settings than the noise.
    """
    settings = stored.settings
    if settings["scenario"]["name"] != "garage_sar" or settings["keys"] != [NOISE_KEY]:
        raise CampaignError(f"{place}: expected a campaign of garage_sar in which only {NOISE_KEY} varies")
    missions: dict[float, list[MissionValues | None]] = {
        noise_db: [None] * settings["trials"] for (noise_db,) in settings["cells"]
    }
    for outcome in stored.outcomes:
        if not outcome.failed:
            values = MissionValues(*(getattr(outcome, field.name) for field in dataclasses.fields(MissionValues)))
            (noise_db,) = settings["cells"][outcome.cell]
            missions[noise_db][outcome.number - 1] = values
    return missions


def dissertation_tables(ours: Missions, width: int = UNLIMITED) -> str:
    """Return Tables 6 to 9 for our noise levels, each value next to the dissertation's if it has that level.

    Times are whole seconds, as in the dissertation. Noise levels that do not fit into the width come below.
    """
    theirs = dissertation_missions()
    levels = sorted(ours)
    columns = [sum(2 * column for _, column, _, _ in (_VICTIMS, _TIME)) + 2] * len(levels)
    blocks = []
    for group in column_groups(columns, _NAME_WIDTH, width + 2):
        some = {levels[index]: ours[levels[index]] for index in group}
        blocks.append(
            [
                _raw_table("Table 6: victims saved and duration of each mission", some, theirs, _VICTIMS, _TIME),
                _raw_table(
                    "Table 7: waypoints explored, times a connection was endangered", some, theirs, _AREAS, _ENDANGERED
                ),
                _statistics_table("Table 8: mean, median and mode of Table 6", some, theirs, _VICTIMS, _TIME),
                _statistics_table("Table 9: mean, median and mode of Table 7", some, theirs, _AREAS, _ENDANGERED),
            ]
        )
    return "\n\n".join(table for tables in zip(*blocks, strict=True) for table in tables)


def _raw_table(title: str, ours: Missions, theirs: Missions, *columns: _Column) -> str:
    """One line per mission."""
    num_ours = max(len(missions) for missions in ours.values())
    num_lines = min(_SHOWN_TRIALS, max(num_ours, _SHOWN_TRIALS if set(ours) & set(theirs) else 0))
    lines = []
    for index in range(num_lines):
        cells = [str(index + 1)]
        for noise_db in sorted(ours):
            pair = [_item(source.get(noise_db, ()), index) for source in (ours, theirs)]
            for _, _, value, _ in columns:
                cells += ["-" if mission is None else f"{value(mission):g}" for mission in pair]
        lines.append(cells)
    table = _block(title, "Trial", sorted(ours), columns, lines)
    more = num_ours - num_lines
    return table + (f"\nand {more} more of ours in trials.csv" if more > 0 else "")


def _statistics_table(title: str, ours: Missions, theirs: Missions, *columns: _Column) -> str:
    """One line each for mean, median and mode."""
    lines = []
    for name, statistic in _STATISTICS.items():
        cells = [name]
        for noise_db in sorted(ours):
            for _, _, value, digits in columns:
                for source in (ours, theirs):
                    values = [float(value(mission)) for mission in source.get(noise_db, ()) if mission is not None]
                    cells.append(f"{statistic(values):.{digits}f}".rstrip("0").rstrip(".") if values else "-")
        lines.append(cells)
    return _block(title, "", sorted(ours), columns, lines)


def _block(
    title: str, corner: str, noises_db: Sequence[float], columns: Sequence[_Column], lines: Sequence[Sequence[str]]
) -> str:
    """Format a table with each column twice under each noise: ours, and the dissertation's as "diss."."""
    widths = [width for _, width, _, _ in columns for _ in ("ours", "diss.")]
    heads = [
        [f"{noise_db:g} dB".center(sum(widths)) for noise_db in noises_db],
        ["".join(f"{name:>{2 * width}}" for name, width, _, _ in columns)] * len(noises_db),
        [_row(("ours", "diss.") * len(columns), widths)] * len(noises_db),
    ]
    rows = [
        [_row(cells[start : start + len(widths)], widths) for start in range(1, len(cells), len(widths))]
        for cells in lines
    ]
    names = [corner, "", "", *(cells[0] for cells in lines)]
    table = [f"{name:{_NAME_WIDTH}}" + "  ".join(levels) for name, levels in zip(names, [*heads, *rows], strict=True)]
    return "\n".join([title, *(line.rstrip() for line in table)])


def _row(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "".join(f"{cell:>{width}}" for cell, width in zip(cells, widths, strict=True))


def _item(missions: Sequence[MissionValues | None], index: int) -> MissionValues | None:
    return missions[index] if index < len(missions) else None

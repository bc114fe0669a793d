"""Draw the learning curves of curve.csv: curve.png.

Run by `make pictures`; needs no display.
"""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from robotteamsim import palette

RESULTS = Path(__file__).with_name("curve.csv")
PATH = Path(__file__).with_name("curve.png")

TRAINED = {"ppo": (palette.BLUE, "PPO"), "mappo": (palette.GREEN, "MAPPO")}
OTHERS = {
    "random_walk": palette.FAINT_INK,
    "rdpso": palette.VERMILLION,
    "greedy": palette.ORANGE,
    "search": palette.PURPLE,
}
MEASURES = (
    ("score", "score: share found, mean over 600 s", 1.0),
    ("victims", "victims saved, of 4", 4.15),
    ("end_s", "end of the mission [s]", 640.0),
)

Row = dict[str, str]


def draw(axes: Axes, rows: list[Row], measure: str, title: str, top: float) -> None:
    """Draw one measure."""
    for row in rows:
        if row["algorithm"] in OTHERS:
            colour, value = OTHERS[row["algorithm"]], float(row[measure])
            axes.axhline(value, color=colour, ls="--", lw=1.2)
            axes.annotate(
                row["algorithm"],
                (1.0, value),
                (0.0, 2.5),
                xycoords=axes.get_yaxis_transform(),
                textcoords="offset points",
                ha="right",
                color=colour,
                fontsize=8.5,
            )
    for algorithm, (colour, _) in TRAINED.items():
        by_seed: dict[str, list[tuple[float, float]]] = defaultdict(list)
        for row in rows:
            if row["algorithm"] == algorithm:
                by_seed[row["seed"]].append((float(row["minutes"]), float(row[measure])))
        if not by_seed:
            continue
        end = min(points[-1][0] for points in by_seed.values())
        minutes = np.linspace(0.0, end, 60)
        curves = np.array([np.interp(minutes, *np.array(points).T) for points in by_seed.values()])
        axes.fill_between(minutes, curves.min(0), curves.max(0), color=colour, alpha=0.18, lw=0)
        axes.plot(minutes, curves.mean(0), color=colour, lw=2.2)
        for points in by_seed.values():
            axes.plot(*np.array(points).T, ".", color=colour, ms=5)
    axes.set_title(title, fontsize=10, color=palette.INK)
    axes.set_xlabel("training [min of processor time]", color=palette.SOFT_INK)
    axes.set_ylim(0.0, top)
    axes.set_xlim(0.0, 1.25 * max(float(row["minutes"] or 0.0) for row in rows))  # room for names
    axes.grid(color=palette.GRID, lw=0.6)
    axes.tick_params(colors=palette.SOFT_INK)
    axes.spines[["top", "right"]].set_visible(False)


def main() -> None:
    """Write the picture."""
    with RESULTS.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    figure = Figure(figsize=(11.0, 4.0), dpi=120, layout="constrained")
    for axes, measure in zip(figure.subplots(1, len(MEASURES)), MEASURES, strict=True):
        draw(axes, rows, *measure)
    found = {row["algorithm"] for row in rows}
    lines = [
        Line2D([], [], color=colour, lw=2.2, label=f"{label}: mean and range of three seeds, a point per evaluation")
        for name, (colour, label) in TRAINED.items()
        if name in found
    ]
    figure.suptitle("Ten missions in the office, which no training has seen", fontsize=11, color=palette.INK)
    figure.legend(handles=lines, loc="outside lower center", ncols=4, fontsize=9, frameon=False)
    figure.savefig(PATH)


if __name__ == "__main__":
    main()

"""Draw where swarms converge, by memory and coefficients: docs/images/swarm_stability.png.

The coloured areas are where a particle with constant bests comes to rest. Run by `make pictures`; needs no display.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from robotteamsim import palette
from robotteamsim.scenario import load
from robotteamsim.swarm import EXACT_LEVELS, PUBLISHED_LEVELS, Levels, MemoryMode, memory_coefficients

PATH = Path(__file__).parent / "images" / "swarm_stability.png"
ALPHAS = np.linspace(0.0, 1.0, 41)
SUMS = np.linspace(0.1, 5.0, 50)
"""c1 + c2, half of it each."""

BOUND = 1.0 - 1e-9
"""Just below 1, because at alpha = 1 the exact memory has a radius of exactly 1."""

COLOURS = (palette.DIVERGES, palette.MEAN_CONVERGES, palette.CONVERGES)
"""Diverges; only the mean converges; mean and variance converge."""
MARK = palette.VERMILLION


def mean_radius(memory: Sequence[float], c1: float, c2: float) -> float:
    """Return the asymptotic factor per iteration of the distance between a particle's expected position and its best.

    Below 1 the mean converges. With both bests at 0 and r1, r2 uniform in [0, 1], (25) is linear in x[t+1], x[t], ...;
    this is the spectral radius of its expectation.

    Args: memory: weights of v[t], v[t-1], ..., as of `memory_coefficients`, or (w,) for an inertia.
    """
    return _radius(_mean_matrix(memory, (c1 + c2) / 2.0))


def variance_radius(memory: Sequence[float], c1: float, c2: float) -> float:
    """Return the asymptotic factor per iteration of the variance of a particle's position.

    Below 1 the particle comes to rest; if it is above 1 but `mean_radius` is below, the particle oscillates around its
    bests with a growing amplitude. It is the spectral radius of the expected Kronecker square of (25); see
    `mean_radius`. For an inertia it is below 1 if c1 + c2 < 24 (1 - w^2) / (7 - 5 w), with c1 = c2 [poli2009].
    """
    mean = _mean_matrix(memory, (c1 + c2) / 2.0)
    pull = np.zeros_like(mean)
    pull[0, 0] = 1.0
    variance = (c1 * c1 + c2 * c2) / 12.0
    return _radius(np.kron(mean, mean) + variance * np.kron(pull, pull))


def _mean_matrix(memory: Sequence[float], pull: float) -> np.ndarray:
    """Return the companion matrix that takes (x[t], x[t-1], ...) to (x[t+1], x[t], ...), with v[t] = x[t] - x[t-1]."""
    terms = len(memory)
    matrix = np.eye(terms + 1, k=-1)
    matrix[0, 0] = 1.0 - pull
    for k, coefficient in enumerate(memory):
        matrix[0, k] += coefficient
        matrix[0, k + 1] -= coefficient
    return matrix


def _radius(matrix: np.ndarray) -> float:
    return float(np.max(np.abs(np.linalg.eigvals(matrix))))


def kinds(mode: MemoryMode, terms: int) -> np.ndarray:
    """Return 0, 1 or 2 (see COLOURS) by c1 + c2 (rows) and alpha (columns)."""
    found = np.zeros((len(SUMS), len(ALPHAS)), dtype=int)
    for column, alpha in enumerate(ALPHAS.tolist()):
        memory = memory_coefficients(mode, alpha, terms)
        for row, c in enumerate((SUMS / 2.0).tolist()):
            # If the mean diverges, the variance does, too.
            if mean_radius(memory, c, c) < BOUND:
                found[row, column] = 2 if variance_radius(memory, c, c) < BOUND else 1
    return found


def draw(axes: Axes, mode: MemoryMode, terms: int, title: str, levels: Levels) -> None:
    """Draw one memory."""
    axes.pcolormesh(ALPHAS, SUMS, kinds(mode, terms), cmap=ListedColormap(COLOURS), vmin=0, vmax=2, rasterized=True)
    adapted = (levels.alpha_small, levels.alpha_nominal, levels.alpha_large)
    axes.plot(adapted, (2.0, 2.0, 2.0), "o", color=palette.INK, ms=6, label="levels of the adaptation, $c_T = 2$")
    control = load("garage_sar").control
    if mode == control.memory and terms == control.memory_terms:
        axes.plot(control.alpha, control.c1 + control.c2, "*", color=MARK, ms=13, label="garage_sar")
    if mode == "published":
        axes.axvline(0.632, color=MARK, lw=1.2, ls="--")
        axes.text(0.64, 4.7, "α = 0.632", color=MARK, fontsize=9)
    axes.set_title(title, fontsize=10, color=palette.INK)
    axes.set_xlabel("fractional order α")
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, SUMS[-1])


def main() -> None:
    """Write the picture."""
    figure = Figure(figsize=(11.0, 4.4), dpi=120, layout="constrained")
    panels = figure.subplots(1, 3, sharey=True)
    draw(panels[0], "published", 4, "published (24), 4 terms", PUBLISHED_LEVELS)
    draw(panels[1], "grunwald_letnikov", 4, "Grünwald-Letnikov (23), 4 terms", EXACT_LEVELS)
    draw(panels[2], "grunwald_letnikov", 2, "Grünwald-Letnikov (23), 2 terms", EXACT_LEVELS)
    panels[0].set_ylabel("$c_1 + c_2$, half each")
    handles, _ = panels[0].get_legend_handles_labels()
    patches = [
        Patch(facecolor=colour, edgecolor=palette.INK, lw=0.5, label=label)
        for colour, label in zip(
            reversed(COLOURS), ("converges", "mean converges, variance diverges", "diverges"), strict=True
        )
    ]
    figure.legend(handles=[*patches, *handles], loc="outside lower center", ncols=5, fontsize=9, frameon=False)
    PATH.parent.mkdir(exist_ok=True)
    figure.savefig(PATH)


if __name__ == "__main__":
    sys.exit(main())

"""Make the pictures of docs/own_building.md: draw a house as if by hand, then run the commands of the page.

Run by `make pictures`; needs no display and no ROS.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

DOCS = Path(__file__).parent
PAGE = DOCS / "own_building.md"
IMAGES = DOCS / "images"
DRAWING = IMAGES / "own_building_drawing.png"
PICTURES = ("plan", "voice", "radio", "mission")
"""Files that the page's commands write; each becomes own_building_<name>.png."""

PIXEL_M = 0.02
SIZE_M = (14.0, 10.0)
PEN_M, WOBBLE_M, WAVE_M, STROKE_STEP_M = 0.16, 0.03, 3.0, 0.02
SQUARE_M = 0.5
"""Of the paper."""
PAPER, SQUARES, PEN = 250, 226, 35
"""Greys; the squares are light enough to count as free."""

Stroke = tuple[tuple[float, float], tuple[float, float]]

OUTER: tuple[Stroke, ...] = (
    ((0.6, 0.6), (13.4, 0.6)),
    ((13.4, 0.6), (13.4, 9.4)),
    ((13.4, 9.4), (0.6, 9.4)),
    ((0.6, 9.4), (0.6, 0.6)),
)
INNER: tuple[Stroke, ...] = (
    ((0.6, 5.8), (2.4, 5.8)),
    ((3.5, 5.8), (7.0, 5.8)),
    ((8.1, 5.8), (10.9, 5.8)),
    ((12.0, 5.8), (13.4, 5.8)),
    ((0.6, 4.2), (3.0, 4.2)),
    ((4.1, 4.2), (9.0, 4.2)),
    ((10.1, 4.2), (13.4, 4.2)),
    ((5.2, 5.8), (5.2, 9.4)),
    ((9.6, 5.8), (9.6, 9.4)),
    ((6.8, 0.6), (6.8, 4.2)),
)
TABLE: tuple[Stroke, ...] = tuple(((10.9, y), (12.1, y)) for y in (1.6, 1.72, 1.84, 1.96, 2.08, 2.2))


def main() -> None:
    """Write all pictures of the page."""
    cv2.imwrite(str(DRAWING), drawing())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        prepare(folder)
        for command in commands():
            print(command)
            subprocess.run(command, shell=True, cwd=folder, check=True)
        for picture in PICTURES:
            shutil.copy(folder / f"{picture}.png", IMAGES / f"own_building_{picture}.png")


def prepare(folder: Path) -> None:
    """Put the drawing and the files that the page prints into a folder."""
    shutil.copy(DRAWING, folder / "house.png")
    for name, text in re.findall(r"`(\w+\.yaml)`:\n\n```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL):
        (folder / name).write_text(text, encoding="utf-8")


def commands() -> list[str]:
    """Return the commands of the page that need no ROS, to be run by this interpreter."""
    blocks = re.findall(r"```sh\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    program = f"{sys.executable} -m robotteamsim.cli"
    return [line.replace("robotteamsim", program, 1) for line in lines if line.startswith("robotteamsim ")]


def drawing() -> np.ndarray:
    """Return the house, drawn with a felt pen on squared paper: uint8, row 0 at the top."""
    generator = np.random.default_rng(7)
    width, height = (round(side_m / PIXEL_M) for side_m in SIZE_M)
    image = np.full((height, width), PAPER, np.uint8)
    square = round(SQUARE_M / PIXEL_M)
    image[::square] = image[:, ::square] = SQUARES
    for stroke in (*OUTER, *INNER, *TABLE):
        draw_stroke(image, stroke, generator)
    noise = generator.normal(0.0, 2.5, image.shape)
    return np.clip(cv2.GaussianBlur(image, (3, 3), 0) + noise, 0, 255).astype(np.uint8)


def draw_stroke(image: np.ndarray, stroke: Stroke, generator: np.random.Generator) -> None:
    """Draw a line that wobbles and varies in width."""
    start, end = (np.array(point) for point in stroke)
    length_m = float(np.linalg.norm(end - start))
    along = np.linspace(0.0, 1.0, round(length_m / STROKE_STEP_M))[:, None]
    normal = np.array([start[1] - end[1], end[0] - start[0]]) / length_m
    waves_m = WOBBLE_M * np.sin(2.0 * np.pi * length_m / WAVE_M * along + generator.uniform(0.0, 6.0))
    points_m = start + along * (end - start) + waves_m * normal
    widths_m = PEN_M * (1.0 + 0.1 * np.sin(generator.uniform(0.0, 6.0) + 7.0 * along[:, 0]))
    for (x_m, y_m), width_m in zip(points_m, widths_m, strict=True):
        center = round(x_m / PIXEL_M), round((SIZE_M[1] - y_m) / PIXEL_M)
        cv2.circle(image, center, round(width_m / PIXEL_M / 2.0), PEN, -1, cv2.LINE_AA)


if __name__ == "__main__":
    main()

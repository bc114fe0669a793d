"""Photos and scans of drawings: grey or unevenly lit paper becomes white, and slightly turned paper straight.

OpenCV is imported where it is used, because it belongs to an extra.
"""

import math
from typing import NamedTuple

import numpy as np

from robotteamsim.map_import.cells import FREE_THRESH, OCCUPIED_THRESH

_AROUND_M = 2.0
"""Paper is what is lightest within this distance: what is wider and dark is no wall, or in the shade."""

_COARSE_M = 0.1
"""Its light is measured in cells of this size, which average out the noise."""

_DARKEST_SHADE = 0.4
"""Of the lightest paper; what is darker over _AROUND_M is ink."""

_FLAT_SHARE = 0.8
"""If three levels of grey make up this share of an image, a program drew it: its light is even."""

_PAPER_SHARE = 0.01
"""The lightest level that so many pixels have is then its paper."""


MOST_TURN_DEG = 5.0
_TURNS_DEG = np.arange(-MOST_TURN_DEG, MOST_TURN_DEG + 0.01, 0.1)
"""Paper may be turned by these angles."""

_LEAST_TURN_DEG = 0.15

_PIXELS = 700
"""Width and height of the image in which the turn is found."""

_ROUGH_M = 0.05
"""Edges of ink are smoothed over this width, if pixels are smaller; noise makes them rough."""


FINE_M = 0.01
"""Smaller pixels become squares of them that are no smaller: finer walls are not drawn, and take long to import."""


class Paper(NamedTuple):
    """A drawing on white paper.

    pixels:     grey, uint8.
    cell_m:     edge of a pixel [m].
    grey_share: of the image's pixels, how many were neither black nor white.
    turn_deg:   how far it was turned before.
    """

    pixels: np.ndarray
    cell_m: float
    grey_share: float
    turn_deg: float


def on_white_paper(pixels: np.ndarray, cell_m: float) -> Paper:
    """Return a drawing divided by the light of its paper, turned so that its lines are along the axes, not too fine.

    Only black and white are left of a photo or a scan.

    Args: pixels: of `read_image`, as shown.  cell_m: edge of a pixel [m].
    """
    import cv2

    grey = pixels if pixels.ndim == 2 else pixels[:, :, :3].mean(axis=2).round().astype(np.uint8)
    counts = np.bincount(grey.ravel(), minlength=256)
    is_drawn = np.sort(counts)[-3:].sum() >= _FLAT_SHARE * grey.size
    light = np.flatnonzero(counts >= _PAPER_SHARE * grey.size)[-1:] if is_drawn else _light(grey, cell_m)
    seen = grey if is_drawn else cv2.GaussianBlur(grey, (3, 3), 0.0)
    even = np.clip(255.0 * (seen / np.maximum(light, 1.0)), 0.0, 255.0).round().astype(np.uint8)
    dark = 1.0 - even / 255.0
    grey_share = float(((dark >= FREE_THRESH) & (dark <= OCCUPIED_THRESH)).mean())
    limit = 128 if is_drawn else cv2.threshold(even, 0, 255, cv2.THRESH_OTSU)[0]
    angle_deg = turn_deg(even <= limit)
    if angle_deg:
        even = straightened(even, angle_deg)
    step = min(max(1, math.ceil(FINE_M / cell_m - 1e-6)), min(even.shape) // 3)
    rows, columns = (size // step * step for size in even.shape)  # from the lower left corner, the origin
    even = cv2.resize(even[-rows:, :columns], (columns // step, rows // step), interpolation=cv2.INTER_AREA)
    cell_m *= step
    if not is_drawn:
        ink = np.where(even <= limit, 0, 255).astype(np.uint8)
        even = cv2.medianBlur(ink, min(round(_ROUGH_M / cell_m), 99) | 1)
    return Paper(even, cell_m, grey_share, angle_deg)


def _light(grey: np.ndarray, cell_m: float) -> np.ndarray:
    """Return how light the paper is at each pixel, 0 .. 255, if nothing was drawn on it."""
    import cv2

    step = max(1, round(_COARSE_M / cell_m))
    coarse = cv2.resize(grey, None, fx=1.0 / step, fy=1.0 / step, interpolation=cv2.INTER_AREA)
    window = min(round(_AROUND_M / (cell_m * step)), *coarse.shape) | 1
    paper = cv2.blur(cv2.morphologyEx(coarse, cv2.MORPH_CLOSE, np.ones((window, window), np.uint8)), (window, window))
    light: np.ndarray = cv2.resize(np.maximum(paper, _DARKEST_SHADE * paper.max()), grey.shape[::-1])
    return light


def turn_deg(ink: np.ndarray) -> float:
    """Return by how much the lines of a drawing are turned from the axes, counter-clockwise, within 5 degrees.

    The angle at which columns and rows through the ink differ most: the sum of the squares of their counts is largest.
    """
    import cv2

    scale = min(1.0, _PIXELS / max(ink.shape))
    small = cv2.resize(ink.astype(np.float32), None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    y, x = np.nonzero(small > 0.5)
    places = x + 1j * y

    def contrast(angle_deg: float) -> float:
        turned = places * np.exp(1j * math.radians(angle_deg))
        axes = (np.floor(axis - axis.min(initial=0.0)).astype(int) for axis in (turned.real, turned.imag))
        return float(sum((np.bincount(axis) ** 2).sum() for axis in axes))

    best = max(_TURNS_DEG.tolist(), key=lambda angle_deg: (contrast(angle_deg), -abs(angle_deg)))
    return best if abs(best) >= _LEAST_TURN_DEG else 0.0


def straightened(grey: np.ndarray, angle_deg: float) -> np.ndarray:
    """Return a drawing turned clockwise, on white paper that holds all of it. Args: angle_deg: of `turn_deg`."""
    import cv2

    rows, columns = grey.shape
    matrix = cv2.getRotationMatrix2D((columns / 2.0, rows / 2.0), -angle_deg, 1.0)
    cos, sin = abs(matrix[0, 0]), abs(matrix[0, 1])
    width, height = round(columns * cos + rows * sin), round(columns * sin + rows * cos)
    matrix[:, 2] += (0.5 * (width - columns), 0.5 * (height - rows))
    turned: np.ndarray = cv2.warpAffine(grey, matrix, (width, height), borderValue=255)
    return turned

"""Converts an image to cells: occupied, free and solid ones."""

import warnings
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

WIDE_UNKNOWN_M = 1.0
"""An unknown region at least this wide in both directions is a void behind a wall, not a wall."""

SPECK_CELLS = 3
"""Smaller groups of occupied cells are noise of the image."""

POCKET_M2 = 0.1
"""Smaller areas enclosed by solid cells are filled, because no robot fits in."""


MAX_PIXELS = 25_000_000
"""Of an image: 5000 x 5000, which is 250 m x 250 m in pixels of 0.05 m. Each takes some 40 bytes during the import."""


def read_image(path: Path) -> np.ndarray | None:
    """Return the pixels of an image; None if it cannot be read. OpenCV's own messages are suppressed.

    Raises: ValueError: more than MAX_PIXELS pixels according to its header; no pixel has been read.
    """
    try:
        with (
            warnings.catch_warnings(action="error", category=Image.DecompressionBombWarning),
            Image.open(path) as image,
        ):
            is_too_large = image.width * image.height > MAX_PIXELS
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        is_too_large = True
    except (OSError, ValueError, SyntaxError):  # Pillow raises SyntaxError for a damaged PNG
        return None
    if is_too_large:
        raise ValueError(f"more than {MAX_PIXELS // 10**6} million pixels")
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        return cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # a header that promises billions of pixels
        return None
    finally:
        cv2.utils.logging.setLogLevel(level)


def darkness(image: np.ndarray, negate: bool) -> np.ndarray:
    """Return how dark each pixel is, 0 white .. 1 black; float64, shape (rows, cols), row 0 at the lowest y.

    Args: image: uint8 or uint16, grey or with channels, of which the first three count equally.
          negate: white counts as black.
    """
    lightness = image.astype(np.float64) / (255.0 if image.dtype == np.uint8 else 65535.0)
    if lightness.ndim == 3:
        lightness = lightness[:, :, :3].mean(axis=2)
    dark: np.ndarray = np.flipud(lightness if negate else 1.0 - lightness)
    return dark


def solid_cells(occupied: np.ndarray, free: np.ndarray, resolution_m: float) -> np.ndarray:
    """Return which cells are solid; no two solid cells touch only at a corner.

    - Occupied cells are solid; groups of fewer than three cells are removed as noise, and enclosed areas below 0.1 m^2
      are filled.
    - Unknown cells are solid if their region is narrower than 1 m; a wider region is a void with a wall of one cell
      where it touches free cells.
    - The outermost cells are solid, so that no robot leaves the map.

    Args: occupied, free: bool, shape (rows, cols); a cell that is neither is unknown.
    """
    unknown = ~(occupied | free)
    window = np.ones((max(1, round(WIDE_UNKNOWN_M / resolution_m)),) * 2, np.uint8)
    void = cv2.morphologyEx(unknown.astype(np.uint8), cv2.MORPH_OPEN, window).astype(bool)
    beside_free = cv2.dilate(free.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    solid = occupied | (unknown & ~void) | (void & beside_free)
    solid[[0, -1]] = solid[:, [0, -1]] = True
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(solid.astype(np.uint8), connectivity=8)
    solid &= statistics[labels, cv2.CC_STAT_AREA] >= SPECK_CELLS
    _, labels, statistics, _ = cv2.connectedComponentsWithStats((~solid).astype(np.uint8), connectivity=4)
    solid |= statistics[labels, cv2.CC_STAT_AREA] * resolution_m**2 < POCKET_M2
    return without_corner_contacts(solid)


def without_corner_contacts(solid: np.ndarray) -> np.ndarray:
    """Return the cells with one more where two touch only at a corner, which would be a gap in a thin wall."""
    solid = solid.copy()
    while True:
        a, b, c, d = solid[:-1, :-1], solid[:-1, 1:], solid[1:, :-1], solid[1:, 1:]
        rising, falling = ~a & b & c & ~d, a & ~b & ~c & d
        if not (rising.any() or falling.any()):
            return solid
        a |= rising
        b |= falling

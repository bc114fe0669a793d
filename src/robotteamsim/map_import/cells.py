"""Converts an image to cells: occupied, free and solid ones.

OpenCV and Pillow are imported where they are used: most scenarios have no image, and both belong to an extra.
"""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from robotteamsim.user_files import open_regular

WIDE_UNKNOWN_M = 1.0
"""An unknown region at least this wide in both directions is a void behind a wall, not a wall."""

SPECK_CELLS = 3
"""Smaller groups of occupied cells are noise of the image."""

POCKET_M2 = 0.1
"""Smaller areas enclosed by solid cells are filled, because no robot fits in."""

OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196
"""map_server's usual thresholds: of a yaml that gives none, and of bitmaps that have no yaml."""


_MOST_IN_16_BITS = 2**16 - 1

MAX_PIXELS = 25_000_000
"""Of an image: 5000 x 5000, which is 250 m x 250 m in pixels of 0.05 m. Each takes some 40 bytes during the import."""


FORMATS = ("PNG", "PPM", "BMP", "TIFF", "JPEG", "WEBP", "GIF")
"""Formats of images that map_server reads, as Pillow names them; PPM includes PGM."""


def read_image(path: Path, *, as_shown: bool = False) -> np.ndarray:
    """Return the pixels of an image: uint8, grey or with channels red, green, blue and alpha; the upper 8 of 16 bits.

    Args:   as_shown: as viewers show it: turned by its EXIF orientation, transparent pixels on white paper.

    Raises: ValueError: what is wrong, as in "cannot be read as an image"; Pillow's own warnings are suppressed. The
            header is read first, so that an image of more than MAX_PIXELS pixels does not fill the memory.
    """
    from PIL import Image

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        try:
            with open_regular(path) as file, Image.open(file, formats=FORMATS) as image:
                if image.width * image.height > MAX_PIXELS:
                    raise Image.DecompressionBombError
                pixels, file_format = _pixels(_on_paper(image) if as_shown else image), image.format
        except (Image.DecompressionBombError, Image.DecompressionBombWarning):
            raise ValueError(f"has more than {MAX_PIXELS // 10**6} million pixels") from None
        except MemoryError:
            raise ValueError("needs more memory than there is") from None
        except Exception:  # Pillow has no error class for damaged files: SyntaxError, KeyError, struct.error and others
            raise ValueError("cannot be read as an image") from None
    if pixels.dtype == np.uint8:
        return pixels
    is_wider = pixels.dtype.kind == "f" or (pixels.dtype == np.int32 and file_format not in ("PNG", "PPM"))
    if is_wider or not 0 <= pixels.min() <= pixels.max() <= _MOST_IN_16_BITS:
        raise ValueError(f"has {pixels.dtype} pixels; expected 8 or 16 bits")
    return (pixels // 256).astype(np.uint8)


def _on_paper(image: Any) -> Any:
    """Return a Pillow image turned by its EXIF orientation [ImageOps.exif_transpose], on white if it is transparent."""
    from PIL import Image, ImageOps

    upright = ImageOps.exif_transpose(image)
    if "A" not in upright.getbands() and "transparency" not in upright.info:
        return upright
    inked = upright.convert("RGBA")
    return Image.alpha_composite(Image.new("RGBA", inked.size, "white"), inked).convert("RGB")


def _pixels(image: Any) -> np.ndarray:
    """Return the pixels of a Pillow image, palettes replaced by their colours; 16 bits of PNG and PPM may be int32."""
    mode = image.mode
    if mode == "1":
        mode = "L"
    elif mode in ("LA", "PA") or (mode == "P" and "transparency" in image.info):
        mode = "RGBA"
    elif mode not in ("L", "RGB", "RGBA", "I", "F") and not mode.startswith("I;16"):
        mode = "RGB"
    return np.asarray(image if mode == image.mode else image.convert(mode))


def lightness(image: np.ndarray, *, negate: bool, with_alpha: bool) -> np.ndarray:
    """Return how light each pixel is as map_server reads it, 0 black .. 255 white; float64, row 0 at the lowest y.

    Args: image: of `read_image`.
          negate: white counts as black.
          with_alpha: a fourth channel counts like a colour, as in map_server's mode `trinary`.
    """
    light = image.astype(np.float64)
    if light.ndim == 3:
        light = (light if with_alpha else light[:, :, :3]).mean(axis=2)
    upright: np.ndarray = np.flipud(255.0 - light if negate else light)
    return upright


def darkness(light: np.ndarray) -> np.ndarray:
    """Return the share of black in each pixel, 0 .. 1, rounded as by map_server. Args: light: of `lightness`."""
    return (255.0 - light) / 255.0


def solid_cells(
    dark: np.ndarray, occupied_thresh: float, free_thresh: float, resolution_m: float, *, closed: bool
) -> np.ndarray:
    """Return which cells are solid; no two touch by a corner alone. The rule of every import (docs/propagation.md).

    - Cells darker than `occupied_thresh` are occupied, others lighter than `free_thresh` free, all others unknown.
    - Occupied cells are solid; groups of fewer than three cells are dropped as noise, and enclosed pockets below
      0.1 m^2 filled.
    - Unknown cells are solid where their region is narrower than 1 m; a wider one is a void behind a wall one cell
      thick wherever it meets free cells.
    - The outermost cells are solid if `closed`, so that no robot leaves the map.

    Args: dark: of `darkness`, shape (rows, cols).
    """
    import cv2

    occupied = dark > occupied_thresh
    free = ~occupied & (dark < free_thresh)
    unknown = ~(occupied | free)
    void = _opened(unknown, max(1, round(WIDE_UNKNOWN_M / resolution_m)))
    beside_free = cv2.dilate(free.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    solid = occupied | (unknown & ~void) | (void & beside_free)
    if closed:
        solid[[0, -1]] = solid[:, [0, -1]] = True
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(solid.astype(np.uint8), connectivity=8)
    solid &= statistics[labels, cv2.CC_STAT_AREA] >= SPECK_CELLS
    _, labels, statistics, _ = cv2.connectedComponentsWithStats((~solid).astype(np.uint8), connectivity=4)
    solid |= statistics[labels, cv2.CC_STAT_AREA] * resolution_m**2 < POCKET_M2
    return without_corner_contacts(solid)


def _opened(cells: np.ndarray, edge_cells: int) -> np.ndarray:
    """Return the cells that a square window covers wherever it fits into them."""
    import cv2

    window, middle = np.ones((edge_cells, edge_cells), np.uint8), edge_cells // 2
    fits = cv2.erode(cells.astype(np.uint8), window, anchor=(middle, middle))
    # With an even edge the window has no cell in its middle: only the mirrored anchor puts it back where it fitted.
    back = edge_cells - 1 - middle
    covered: np.ndarray = cv2.dilate(fits, window, anchor=(back, back)).astype(bool)
    return covered


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

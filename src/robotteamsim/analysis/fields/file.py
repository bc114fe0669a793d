"""Radio and voice maps as files: the numbers, and an image that map_server turns into an OccupancyGrid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.analysis.fields.picture import FieldStyle, Panel
from robotteamsim.errors import RecordingError

_UNKNOWN = 255
"""map_server takes pixels of a raw image as they are: 0..100 for a share, 255 for unknown."""


def numbers(panels: Sequence[Panel], style: FieldStyle) -> dict[str, np.ndarray]:
    """Return maps as the named arrays of an npz archive.

    values:         float64, shape (rows, cols), row 0 at the lowest y; of several maps (maps, rows, cols).
    origin_m:       lower left corner of cell (0, 0) in `map`; resolution_m: edge of a cell.
    quantity, unit: what the values are; titles: of each map.
    sources_m:      x, y of every source of every map, shape (n, 2); source_map: the index of the map of each.
    Raises: RecordingError: the maps have not all the same cells.
    """
    first = panels[0].field
    for panel in panels[1:]:
        other = panel.field
        if (other.values.shape, other.origin_m, other.resolution_m) != (
            first.values.shape,
            first.origin_m,
            first.resolution_m,
        ):
            raise RecordingError("maps with different cells do not fit into one file; write one map at a time")
    stacked = np.stack([panel.field.values for panel in panels])
    spots = [(index, *spot.position_m) for index, panel in enumerate(panels) for spot in panel.spots]
    sources = np.array(spots, dtype=np.float64).reshape(-1, 3)
    return {
        "values": stacked if len(panels) > 1 else stacked[0],
        "origin_m": np.array(first.origin_m),
        "resolution_m": np.array(first.resolution_m),
        "quantity": np.array(style.quantity),
        "unit": np.array(style.unit),
        "titles": np.array([panel.title for panel in panels]),
        "sources_m": sources[:, 1:],
        "source_map": sources[:, 0].astype(np.int64),
    }


def grid_pgm(panel: Panel, style: FieldStyle) -> bytes:
    """Return a map as a grey image (PGM, P5) of 0 at the low end of the scale to 100 at the high end, 255 if blank."""
    values = panel.field.values
    share = np.clip(np.rint(100.0 * (values - style.low) / (style.high - style.low)), 0.0, 100.0).astype(np.uint8)
    share[values < panel.silent_below] = _UNKNOWN
    rows, columns = values.shape
    return b"P5\n%d %d\n255\n" % (columns, rows) + np.flipud(share).tobytes()


def grid_yaml(panel: Panel, style: FieldStyle, image: str) -> str:
    """Return the yaml with which map_server loads the image of `grid_pgm`."""
    x, y = panel.field.origin_m
    return (
        f"# {style.quantity}: 0 is {style.low:g} {style.unit}, 100 is {style.high:g} {style.unit}"
        + (f", unknown is {style.silence}\n" if style.silence else "\n")
        + f"image: {image}\nresolution: {panel.field.resolution_m:g}\norigin: [{x:g}, {y:g}, 0.0]\n"
        "mode: raw\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )

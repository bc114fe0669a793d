"""Radio and voice maps as files: arrays, and an image that map_server loads as an OccupancyGrid."""

from collections.abc import Sequence

import numpy as np

from robotteamsim.analysis.fields.picture import FieldStyle, Panel
from robotteamsim.errors import RecordingError

_UNKNOWN = 255
"""Pixel of an unknown cell. map_server uses the pixels of a raw image unchanged: 0 to 100, or 255 for unknown."""


def map_arrays(panels: Sequence[Panel], style: FieldStyle) -> dict[str, np.ndarray]:
    """Return maps as the named arrays of an npz archive.

    values:         float64, shape (rows, cols), row 0 at the lowest y; of several maps (maps, rows, cols).
    origin_m:       lower left corner of cell (0, 0) in `map`; resolution_m: size of a cell.
    quantity, unit: what the values are; titles: titles of the maps.
    sources_m:      x, y of every source of every map, shape (n, 2); source_map: index of the map of each source.
    Raises: RecordingError: the maps have different cells.
    """
    first = panels[0].field
    if len({(panel.field.values.shape, panel.field.origin_m, panel.field.resolution_m) for panel in panels}) > 1:
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
    """Return the yaml for loading the image of `grid_pgm` with map_server."""
    x, y = panel.field.origin_m
    return (
        f"# {style.quantity}: 0 is {style.low:g} {style.unit}, 100 is {style.high:g} {style.unit}"
        + (f", unknown is {style.silence}\n" if style.silence else "\n")
        + f"image: {image}\nresolution: {panel.field.resolution_m:g}\norigin: [{x:g}, {y:g}, 0.0]\n"
        "mode: raw\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )

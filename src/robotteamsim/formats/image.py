"""Imports images of buildings: drawings, photos of them, and the maps of map_server."""

import argparse
import math
from pathlib import Path
from typing import Any, ClassVar

from robotteamsim.arguments import positive_number
from robotteamsim.errors import ScenarioError
from robotteamsim.formats.drawings import OPENINGS, drawn, numbers
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.options import Options
from robotteamsim.scenario.map_image import DrawingRules, import_image, read_drawing, read_map

_YAML = (".yaml", ".yml")


def _measured(text: str) -> float:
    """Return the metres per pixel of a measured line. Raises: ArgumentTypeError."""
    x1, y1, x2, y2, metres = numbers(text, 5, "X1,Y1,X2,Y2,M")
    pixels = math.hypot(x2 - x1, y2 - y1)
    if pixels < 1.0 or metres <= 0.0:
        raise argparse.ArgumentTypeError(f"'{text}': expected two pixels apart from each other, and metres above 0")
    return metres / pixels


class ImageImporter(Importer):
    """Imports an image, or the map_server yaml of one, see `map_image.import_image`."""

    noun = "an image or the yaml of one"
    suffixes = (
        *(".bmp", ".dib", ".gif", ".jpe", ".jpeg", ".jpg", ".pbm", ".pgm", ".png", ".pnm", ".ppm", ".tif", ".tiff"),
        ".webp",
        *_YAML,
    )
    options: ClassVar[Options] = {
        "--metres-per-pixel": {
            "type": positive_number,
            "metavar": "M",
            "help": "scale of an image without a yaml",
        },
        "--measured": {
            "type": _measured,
            "metavar": "X1,Y1,X2,Y2,M",
            "help": "the same, from two pixels and their distance",
        },
        "--thinnest-wall": {
            "type": positive_number,
            "metavar": "M",
            "help": "thinner strokes are no walls: text, dimension lines, arcs of doors; default: all are",
        },
        "--smallest-wall": {
            "type": positive_number,
            "metavar": "M",
            "help": "separate strokes smaller than this in width and height are no walls: letters; default: all are",
        },
        **OPENINGS,
    }
    examples = """\
  robotteamsim plan import house.yaml                        image, resolution, origin
  robotteamsim plan import house.png --metres-per-pixel 0.02
  robotteamsim plan import house.png --measured 120,80,820,80,14
                                     the line between these pixels is 14 m long; y counts from the top
  robotteamsim plan import house.png --metres-per-pixel 0.02 --thinnest-wall 0.08 --smallest-wall 0.5 \\
    --doors --png import.png         without text and thin lines, gaps as doors, and what became what"""

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`. Raises: ScenarioError: no scale, or two."""
        scales = [options[name] for name in ("metres_per_pixel", "measured") if name in options]
        is_yaml = path.suffix.lower() in _YAML
        if is_yaml and scales:
            raise ScenarioError(f"{path} has the resolution; --metres-per-pixel and --measured are for images")
        if not is_yaml and len(scales) != 1:
            one = "only one of --metres-per-pixel and" if scales else "its scale with --metres-per-pixel or"
            raise ScenarioError(f"{path}: give {one} --measured, or import its yaml")
        thinnest_m, smallest_m = options.get("thinnest_wall", 0.0), options.get("smallest_wall", 0.0)
        rules = DrawingRules(thinnest_m, smallest_m, options.get("doors"), options.get("windows"))
        image = read_map(path) if is_yaml else read_drawing(path, *scales)
        files = () if image.settings.image == path.name else (path.parent / image.settings.image,)
        return drawn(import_image(image, path, rules), rules, image=image, files=files)

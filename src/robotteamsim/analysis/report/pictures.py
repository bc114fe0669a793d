"""Figures as pictures of a page, and as files."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from PIL import Image

from robotteamsim.analysis.figure_files import figure_bytes
from robotteamsim.analysis.report.figures import SCREEN, Sheet

_FEW, _COLOURS = 2_000, 256
"""Pictures with fewer than _FEW colours are stored with 256, at a third of the size; maps would show bands."""

_MARGIN_INCHES = 0.08


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure of a page."""

    name: str
    title: str
    caption: str
    png: bytes
    inches: float
    """Width; text of about 11 points is legible at 61 px per inch."""
    figure: Figure
    bounds_inches: Bbox
    """What of the figure is shown."""

    @property
    def source(self) -> str:
        """The picture as the source of an image in HTML."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()

    def files(self) -> dict[str, bytes]:
        """Return it as PNG for slides, PDF and SVG for papers, by file name."""
        drawn = {kind: figure_bytes(self.figure, kind, bbox_inches=self.bounds_inches) for kind in ("pdf", "svg")}
        return {f"{self.name}.png": self.png, **{f"{self.name}.{kind}": data for kind, data in drawn.items()}}


def picture(name: str, title: str, caption: str, figure: Figure, sheet: Sheet = SCREEN) -> Picture:
    """Return a drawn figure as a picture; the same figure gives the same bytes. That of a paper has its exact width."""
    figure.draw_without_rendering()
    figure.set_layout_engine(None)  # it is laid out, once for all kinds of files
    bounds_inches = figure.get_tightbbox().padded(_MARGIN_INCHES)
    if sheet is not SCREEN:
        bounds_inches = Bbox([[0.0, bounds_inches.y0], [sheet.width_inches, bounds_inches.y1]])
    raw = figure_bytes(figure, "png", pil_kwargs={"compress_level": 0}, bbox_inches=bounds_inches)
    image = Image.open(io.BytesIO(raw)).convert("RGB")
    if image.getcolors(_FEW) is not None:
        image = image.quantize(_COLOURS, dither=Image.Dither.NONE)
    packed = io.BytesIO()
    image.save(packed, format="PNG", optimize=True)
    return Picture(name, title, caption, packed.getvalue(), image.width / figure.dpi, figure, bounds_inches)

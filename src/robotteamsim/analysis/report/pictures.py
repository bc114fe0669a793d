"""Figures as pictures of a page, and as files."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from robotteamsim.analysis.figure_files import figure_bytes
from robotteamsim.analysis.report.figures import SCREEN, Sheet

_MARGIN_INCHES = 0.08


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure of a page."""

    name: str
    title: str
    caption: str
    png: bytes
    figure: Figure
    bounds_inches: Bbox
    """What of the figure is shown."""

    @property
    def inches(self) -> float:
        """Width; text of about 11 points is legible at 61 px per inch."""
        return float(self.bounds_inches.width)

    @property
    def source(self) -> str:
        """The picture as the source of an image in HTML."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()

    def files(self, formats: Iterable[str] = ()) -> dict[str, bytes]:
        """Return it as PNG and in further formats, pdf or svg, by file name."""
        drawn = {kind: figure_bytes(self.figure, kind, bbox_inches=self.bounds_inches) for kind in formats}
        return {f"{self.name}.{kind}": data for kind, data in ({"png": self.png} | drawn).items()}


def picture(name: str, title: str, caption: str, figure: Figure, sheet: Sheet = SCREEN) -> Picture:
    """Return a drawn figure as a picture; the same figure gives the same bytes. That of a paper has its exact width."""
    figure.draw_without_rendering()
    figure.set_layout_engine(None)  # it is laid out, once for all kinds of files
    bounds_inches = figure.get_tightbbox().padded(_MARGIN_INCHES)
    if sheet is not SCREEN:
        bounds_inches = Bbox([[0.0, bounds_inches.y0], [sheet.width_inches, bounds_inches.y1]])
    png = figure_bytes(figure, "png", bbox_inches=bounds_inches)
    return Picture(name, title, caption, png, figure, bounds_inches)

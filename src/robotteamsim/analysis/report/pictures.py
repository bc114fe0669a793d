"""Figures as PNG pictures of a page."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass

from matplotlib.figure import Figure
from PIL import Image

_FEW, _COLOURS = 2_000, 256
"""Pictures with fewer than _FEW colours are stored with 256, at a third of the size; maps would show bands."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure of a page."""

    name: str
    title: str
    caption: str
    png: bytes
    inches: float
    """Width; text of about 11 points is legible at 61 px per inch."""

    @property
    def source(self) -> str:
        """The picture as the source of an image in HTML."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()


def picture(name: str, title: str, caption: str, figure: Figure) -> Picture:
    """Return a drawn figure as a picture; the same figure gives the same bytes."""
    raw = io.BytesIO()
    figure.savefig(raw, format="png", bbox_inches="tight", pad_inches=0.08, pil_kwargs={"compress_level": 0})
    image = Image.open(raw).convert("RGB")
    if image.getcolors(_FEW) is not None:
        image = image.quantize(_COLOURS, dither=Image.Dither.NONE)
    packed = io.BytesIO()
    image.save(packed, format="PNG", optimize=True)
    return Picture(name, title, caption, packed.getvalue(), image.width / figure.dpi)

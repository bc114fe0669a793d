"""A player within another page: in a notebook or a report."""

from __future__ import annotations

import html
from collections.abc import Sequence

from robotteamsim.view.html import mission_page
from robotteamsim.view.recorder import Recording

HEIGHT_PX = 600


def player_frame(recordings: Sequence[Recording], title: str, height_px: int = HEIGHT_PX) -> str:
    """Return an iframe that contains the whole player; several missions get a selector."""
    page = html.escape(mission_page(recordings, title))
    style = f"width:100%;height:{height_px}px;border:0;border-radius:8px"
    return f'<iframe srcdoc="{page}" title="{html.escape(title)}" style="{style}" loading="lazy"></iframe>'

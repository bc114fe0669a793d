"""The viewer's page: as one self-contained file, or in parts for a server."""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Sequence
from pathlib import Path
from string import Template

from robotteamsim import palette
from robotteamsim.view.columns import packed
from robotteamsim.view.recorder import Recording

PAGE = Path(__file__).parent / "page"
MODULES = tuple(sorted(path.stem for path in PAGE.glob("*.js") if path.stem != "three.min"))
"""The viewer's own JavaScript modules; one imports another as viewer/<name>."""


def mission_page(recordings: Sequence[Recording], title: str, *, compare: bool = False) -> str:
    """Return a page that plays missions without any other file or network access.

    Args: compare: show all missions side by side at the same time, instead of one at a time.
    """
    modules = {"three": _data_url(PAGE / "three.min.js")}
    modules |= {f"viewer/{name}": _data_url(PAGE / f"{name}.js") for name in MODULES}
    mode = "compare" if compare else "single"
    data = f'<script id="missions" type="text/plain" data-mode="{mode}">{packed(recordings)}</script>'
    return _page(title, modules, data)


def live_page(title: str) -> str:
    """Return the page of a live mission, whose modules the server provides under /page/."""
    modules = {"three": "/page/three.min.js"} | {f"viewer/{name}": f"/page/{name}.js" for name in MODULES}
    return _page(title, modules, "")


def _page(title: str, modules: dict[str, str], data: str) -> str:
    template = Template((PAGE / "viewer.html").read_text(encoding="utf-8"))
    return template.substitute(
        title=html.escape(title),
        light=palette.properties(palette.LIGHT_PAGE),
        dark=palette.properties(palette.DARK_PAGE),
        style=(PAGE / "style.css").read_text(encoding="utf-8"),
        imports=json.dumps({"imports": modules}),
        data=data,
    )


def _data_url(path: Path) -> str:
    return "data:text/javascript;base64," + base64.b64encode(path.read_bytes()).decode()

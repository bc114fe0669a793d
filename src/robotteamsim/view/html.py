"""The viewer's page: as one self-contained file, within another page, or in parts for a server."""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Sequence
from pathlib import Path
from string import Template

from robotteamsim import palette
from robotteamsim.errors import RecordingError
from robotteamsim.recording.files import check_replaceable, write_atomically
from robotteamsim.setup import Setup
from robotteamsim.simulation import Result
from robotteamsim.view.document import packed
from robotteamsim.view.recorder import FRAME_S, FrameRecorder, Recording

PAGE = Path(__file__).parent / "page"
MODULES = tuple(sorted(path.stem for path in PAGE.glob("*.js") if path.stem != "three.min"))
"""The viewer's own JavaScript modules; one imports another as viewer/<name>."""

HEIGHT_PX = 600

MOST_LINKS = 50_000_000
"""Of all frames of a page; each takes some 100 bytes while it is recorded."""


def mission_page(recordings: Sequence[Recording], title: str, *, compare: bool = False) -> str:
    """Return a page that plays missions without any other file or network access.

    Args: compare: show all missions side by side at the same time, instead of one at a time.
    """
    return _player(packed(recordings), title, "compare" if compare else "single")


def player_frame(missions: str, title: str, height_px: int = HEIGHT_PX) -> str:
    """Return an iframe that contains the whole player; several missions get a selector.

    Args: missions: as `document.packed` returns them.
    """
    page = html.escape(_player(missions, title, "single"))
    style = f"width:100%;height:{height_px}px;border:0;border-radius:8px"
    return f'<iframe srcdoc="{page}" title="{html.escape(title)}" style="{style}" loading="lazy"></iframe>'


def live_page(title: str) -> str:
    """Return the page of a live mission, whose modules the server provides next to it, under page/."""
    modules = {"three": "./page/three.min.js"} | {f"viewer/{name}": f"./page/{name}.js" for name in MODULES}
    return _page(title, modules, "")


def size_problem(setup: Setup, most_links: int = MOST_LINKS) -> str:
    """Return why a page of a mission would be too large, or ""."""
    robots, limit_s = len(setup.robots), setup.scenario.mission.time_limit_s
    links = robots * (robots - 1) / 2 * limit_s / FRAME_S
    if links <= most_links:
        return ""
    text = f"a page of {robots} robots for {limit_s:g} s has up to {links / 1e6:,.0f} million links in all frames"
    keys = "fewer robots (robots.count) or less time (mission.time_limit_s)"
    return f"{text}; expected at most {most_links // 10**6} million, with {keys}"


class PageWriter(FrameRecorder):
    """Records a mission, and writes the page that plays it when the mission has ended, completely or not at all."""

    def __init__(self, path: Path, setup: Setup) -> None:
        super().__init__(setup)
        self._path = path

    def begin(self, setup: Setup) -> None:
        """Raises: RecordingError: the file cannot be written, or would be too large."""
        check_replaceable(self._path)
        if problem := size_problem(setup):
            raise RecordingError(f"{self._path}: {problem}; `robotteamsim view` shows it live")

    def end(self, result: Result) -> None:
        """Write the page. Raises: RecordingError."""
        write_atomically(self._path, mission_page([self.recording], self.recording.title))


def _player(missions: str, title: str, mode: str) -> str:
    modules = {"three": _data_url(PAGE / "three.min.js")}
    modules |= {f"viewer/{name}": _data_url(PAGE / f"{name}.js") for name in MODULES}
    return _page(title, modules, f'<script id="missions" type="text/plain" data-mode="{mode}">{missions}</script>')


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

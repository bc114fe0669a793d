"""Pages of missions in a browser, for tests."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page

from robotteamsim.view.html import live_page, mission_page
from robotteamsim.view.live import LiveMission
from robotteamsim.view.recorder import Recording
from robotteamsim.view.server import ViewServer
from robotteamsim.view.shown import ShownMission, Update, Viewer

READY_MS = 120_000

_SEEK = """async (time) => {
    const slider = document.getElementById("time");
    slider.value = time;
    slider.dispatchEvent(new Event("input"));
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    return {...document.querySelector(".view").dataset};
}"""


@contextmanager
def shown(
    browser: Browser,
    folder: Path,
    recordings: Sequence[Recording],
    *,
    title: str = "mission",
    compare: bool = False,
    fragment: str = "",
    size: tuple[int, int] = (1600, 900),
) -> Iterator[Page]:
    """Write missions to a page in a folder, and open it; see `opened`."""
    path = folder / "mission.html"
    path.write_text(mission_page(recordings, title, compare=compare), encoding="utf-8")
    with opened(browser, f"file://{path}{fragment}", size=size) as page:
        yield page


@contextmanager
def opened(browser: Browser, url: str, *, size: tuple[int, int] = (1600, 900)) -> Iterator[Page]:
    """Open a page. At the end it must not have reported an error, or asked another address for anything."""
    own = (url.partition("#")[0], "data:", "blob:")
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.set_default_timeout(READY_MS)
    wrong: list[str] = []
    page.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("dialog", lambda dialog: wrong.append(dialog.message))
    page.on("request", lambda request: None if request.url.startswith(own) else wrong.append(request.url))
    try:
        page.goto(url)
        page.wait_for_selector("body[data-ready]", state="attached")
        yield page
        assert wrong == []
    finally:
        page.close()


def seek(page: Page, time_s: float) -> dict[str, Any]:
    """Move the slider to a time, and return the numbers of the first view once it is drawn."""
    found: dict[str, Any] = page.evaluate(_SEEK, time_s)
    return found


@contextmanager
def served(mission: LiveMission, host: str | None = None) -> Iterator[ViewServer]:
    """Serve the page of a live mission, which has been started."""
    with ViewServer(0, live_page("hall"), mission, host) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def taken(mission: ShownMission, viewer: Viewer) -> Update:
    """Return the next update of a viewer."""
    update = mission.take(viewer, 60.0)
    assert update is not None
    return update

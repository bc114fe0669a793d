"""Draw the viewer's pictures in docs: missions in headless Chromium with software rendering.

Usage: python docs/draw_viewer.py
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

from robotteamsim.scenario import load
from robotteamsim.view.html import mission_page
from robotteamsim.view.recorder import Recording, record_mission

IMAGES = Path(__file__).parent / "images"
_FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
_TIMEOUT_MS = 120_000


def main() -> None:
    """Simulate the missions and take the pictures."""
    quiet, loud = (_recorded(["run.seed=2", f"voice.noise_db={noise_db}"]) for noise_db in (20, 30))
    office = _recorded([], "office_manet")
    names = ("garage_rescue", "office_fire", "office_tower", "office_unknown")
    rescue, fire, tower, unknown = (_recorded(["run.seed=1"], name) for name in names)
    chromium = shutil.which("chromium-headless-shell")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=_FLAGS)
        _draw(browser, "viewer", [quiet], "#t=150&layers=voice,laser", (1600, 900))
        _draw(browser, "viewer_compare", [quiet, loud], "#t=300&layers=radio&theme=light", (1600, 720))
        _draw(browser, "viewer_office", [office], "#t=60", (1600, 900))
        _draw(browser, "garage_rescue", [rescue], "#t=190", (1600, 900))
        _draw(browser, "office_fire", [fire], "#t=50", (1600, 900))
        _draw(browser, "office_tower", [tower], "#t=120", (1600, 720))
        _draw(browser, "office_unknown", [unknown], "#t=150", (1600, 900))
        browser.close()


def _recorded(overrides: list[str], name: str = "garage_sar") -> Recording:
    return record_mission(load(name, overrides))[0]


def _draw(browser: Browser, name: str, recordings: list[Recording], fragment: str, size: tuple[int, int]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission.html"
        path.write_text(mission_page(recordings, name, compare=len(recordings) > 1), encoding="utf-8")
        page = browser.new_page(viewport={"width": size[0], "height": size[1]})
        page.goto(f"file://{path}{fragment}")
        page.wait_for_selector("body[data-ready]", state="attached", timeout=_TIMEOUT_MS)
        page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        page.screenshot(path=IMAGES / f"{name}.png", timeout=_TIMEOUT_MS)
        page.close()


if __name__ == "__main__":
    main()

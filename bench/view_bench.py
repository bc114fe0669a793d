"""Size of mission pages, and time to draw any second of them in a browser with software rendering.

Seeking is measured from the change of the slider to the end of the next frame, in headless Chromium, as the median and
the slowest of 15 times spread over the mission, forwards and backwards.
Usage: python bench/view_bench.py [--csv FILE]
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import tempfile
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, sync_playwright
from results_file import append

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation
from robotteamsim.view.html import mission_page
from robotteamsim.view.recorder import FrameRecorder

SIZE_GOALS_MB = {3: 2.0, 100: 10.0}
"""By the number of robots, for 500 s."""

SEEK_GOAL_MS = 200.0
_FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
_SEEK = """async (time) => {
    const slider = document.getElementById("time"), begin = performance.now();
    slider.value = time;
    slider.dispatchEvent(new Event("input"));
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    return performance.now() - begin;
}"""


def main() -> None:
    """Measure, print and record."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--csv", type=Path, default=Path(__file__).parent / "results" / "view.csv")
    options = parser.parse_args()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium-headless-shell"), args=_FLAGS)
        for robots, goal_mb in SIZE_GOALS_MB.items():
            page, duration_s = _page(robots)
            megabytes = len(page.encode()) / 1e6 * max(1.0, 500.0 / duration_s)
            seeks_ms = _seek_ms(browser, page, duration_s)
            median_ms, slowest_ms = statistics.median(seeks_ms), max(seeks_ms)
            print(
                f"{robots} robots, {duration_s:.0f} s: {megabytes:.2f} MB per 500 s (goal {goal_mb:g}), seek "
                f"{median_ms:.0f} ms, slowest {slowest_ms:.0f} ms (goal {SEEK_GOAL_MS:g})"
            )
            found = {"page [MB/500 s]": megabytes, "seek median [ms]": median_ms, "seek slowest [ms]": slowest_ms}
            append(options.csv, "view", robots, found)
        browser.close()


def _page(robots: int) -> tuple[str, float]:
    """Return the page of a garage mission, and the mission's duration [s]."""
    simulation = Simulation(load("garage_sar", [f"robots.count={robots}", "run.seed=1"]))
    recorder = FrameRecorder(simulation.setup)
    result = simulation.run([recorder])
    return mission_page([recorder.recording], "bench"), result.sim_time_s


def _seek_ms(browser: Browser, text: str, duration_s: float) -> list[float]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission.html"
        path.write_text(text, encoding="utf-8")
        page = browser.new_page(viewport={"width": 1600, "height": 900})
        page.goto(f"file://{path}")
        page.wait_for_selector("body[data-ready]", state="attached", timeout=120_000)
        shares = np.random.default_rng(1).permutation(np.linspace(0.0, 1.0, 15))
        found = [float(page.evaluate(_SEEK, share * duration_s)) for share in shares.tolist()]
        page.close()
    return found


if __name__ == "__main__":
    main()

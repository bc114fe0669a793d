"""Pages in a real browser: they show the mission's numbers, ask nobody, and run nothing that a name contains."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Mission, Victim
from robotteamsim.simulation import Simulation
from robotteamsim.view.html import mission_page
from robotteamsim.view.recorder import FrameRecorder, Recording

_READY_MS = 120_000


def _open(
    browser: Browser, path: Path, fragment: str = "", size: tuple[int, int] = (1600, 900)
) -> tuple[Page, list[str]]:
    """Open a page; return it and what the browser complained about or asked for besides the file."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.set_default_timeout(_READY_MS)
    wrong: list[str] = []
    page.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("dialog", lambda dialog: wrong.append(dialog.message))
    page.on("request", lambda request: _note_request(request.url, wrong))
    page.goto(f"file://{path}{fragment}")
    page.wait_for_selector("body[data-ready]", state="attached")
    return page, wrong


def _note_request(url: str, wrong: list[str]) -> None:
    if not url.startswith(("file:", "data:", "blob:")):
        wrong.append(url)


def _seek(page: Page, time_s: float) -> dict[str, Any]:
    """Move the slider to a time, and return the numbers of the first view once it is drawn."""
    page.evaluate(
        """async (time) => {
            const slider = document.getElementById("time");
            slider.value = time;
            slider.dispatchEvent(new Event("input"));
            await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
        }""",
        time_s,
    )
    found: dict[str, Any] = page.evaluate("({...document.querySelector('.view').dataset})")
    return found


def test_page_shows_the_numbers_of_the_recording_and_makes_no_request(
    browser: Browser, recording: Recording, tmp_path: Path
) -> None:
    path = tmp_path / "mission.html"
    path.write_text(mission_page([recording], recording.title), encoding="utf-8")
    page, wrong = _open(browser, path)
    for index in (0, len(recording.frames) // 2, len(recording.frames) - 1):
        frame = recording.frames[index]
        shown = _seek(page, frame.time_s + 0.01)
        assert int(shown["robots"]) == sum(pose is not None for pose in frame.poses)
        assert int(shown["links"]) == len(frame.links)
        assert int(shown["victims"]) == len(frame.victims)
        assert int(shown["saved"]) == sum(victim.state == "saved" for victim in frame.victims)
    assert wrong == []
    page.close()


def test_names_with_markup_are_shown_as_text(
    browser: Browser, hall_scenario: Callable[..., Scenario], tmp_path: Path
) -> None:
    name = "<script>alert(1)</script>"
    victims = (Victim(name=name, position=(9.0, 4.0)),)
    scenario = hall_scenario(mission=Mission(victims=victims, time_limit_s=5.0))
    simulation = Simulation(scenario)
    recorder = FrameRecorder(simulation)
    simulation.run([recorder])
    path = tmp_path / "mission.html"
    path.write_text(mission_page([recorder.recording], f"</title>{name}"), encoding="utf-8")
    page, wrong = _open(browser, path)
    _seek(page, 4.0)
    labels = page.eval_on_selector_all(".label.victim", "all => all.map((one) => one.textContent)")
    assert labels == [f"? {name}"]
    assert page.title() == f"</title>{name}"
    assert wrong == []
    page.close()


@pytest.mark.parametrize("size", [(1600, 900), (390, 844)])
def test_labels_do_not_overlap(browser: Browser, recording: Recording, tmp_path: Path, size: tuple[int, int]) -> None:
    path = tmp_path / "mission.html"
    path.write_text(mission_page([recording], recording.title), encoding="utf-8")
    page, wrong = _open(browser, path, size=size)
    for share in (0.0, 0.3, 0.8):
        _seek(page, share * recording.frames[-1].time_s)
        boxes = page.evaluate(
            """[...document.querySelectorAll(".label")].filter((one) => !one.hidden).map((one) => {
                const box = one.getBoundingClientRect();
                return [box.left, box.top, box.right, box.bottom];
            })"""
        )
        assert boxes
        for (ax0, ay0, ax1, ay1), (bx0, by0, bx1, by1) in itertools.combinations(boxes, 2):
            assert ax1 <= bx0 or bx1 <= ax0 or ay1 <= by0 or by1 <= ay0
    assert wrong == []
    page.close()


def test_compared_missions_are_shown_at_the_same_time(browser: Browser, recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "both.html"
    path.write_text(mission_page([recording, recording], "both", compare=True), encoding="utf-8")
    page, wrong = _open(browser, path, "#t=10")
    _seek(page, 10.1)
    times = page.eval_on_selector_all(".view", "all => all.map((one) => one.dataset.time)")
    assert times == ["10.1", "10.1"]
    assert wrong == []
    page.close()


def test_damaged_data_show_one_line(browser: Browser, recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "mission.html"
    whole = mission_page([recording], "damaged")
    begin = whole.index('data-mode="single">') + 200
    path.write_text(whole[:begin] + "AAAA" + whole[begin + 40 :], encoding="utf-8")
    page = browser.new_page()
    page.goto(f"file://{path}")
    page.wait_for_selector("#failure:not([hidden])", timeout=_READY_MS)
    assert "cannot be shown" in str(page.text_content("#failure"))
    page.close()

"""Pages in a real browser: they show the mission's numbers, ask nobody, and run nothing that a name contains."""

from __future__ import annotations

import io
import itertools
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest
from PIL import Image, ImageChops
from playwright.sync_api import Browser
from shown_page import READY_MS, seek, shown

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Mission, Victim
from robotteamsim.simulation import Simulation
from robotteamsim.view.frame import ShownEvent
from robotteamsim.view.html import mission_page
from robotteamsim.view.recorder import FrameRecorder, Recording

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def browser_without_webgl(browser: Browser) -> Iterator[Browser]:
    """Start the same browser, which refuses to draw in three dimensions."""
    chromium = shutil.which("chromium-headless-shell")
    flags = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"]
    with browser.browser_type.launch(executable_path=chromium, args=flags) as started:
        yield started


def test_page_shows_the_numbers_of_the_recording_and_makes_no_request(
    browser: Browser, recording: Recording, tmp_path: Path
) -> None:
    with shown(browser, tmp_path, [recording]) as page:
        for index in (0, len(recording.frames) // 2, len(recording.frames) - 1):
            _check_numbers(seek(page, recording.frames[index].time_s + 0.01), recording, index)
            captions = page.locator("#curves figcaption").all_text_contents()
            assert f"links: {len(recording.frames[index].links)}" in captions


def _check_numbers(found: dict[str, str], recording: Recording, index: int) -> None:
    frame = recording.frames[index]
    assert int(found["robots"]) == sum(pose is not None for pose in frame.poses)
    assert int(found["links"]) == len(frame.links)
    assert int(found["victims"]) == len(frame.victims)
    assert int(found["saved"]) == sum(victim.state == "saved" for victim in frame.victims)


@pytest.mark.parametrize(("play", "plays"), [("0", False), ("1", True)])
def test_address_says_whether_the_page_plays(
    browser: Browser, recording: Recording, tmp_path: Path, play: str, plays: bool
) -> None:
    with shown(browser, tmp_path, [recording], fragment=f"#t=1&play={play}") as page:
        assert ("playing" in (page.get_attribute("#play", "class") or "")) == plays


def test_names_with_markup_are_shown_as_text(
    browser: Browser, hall_scenario: Callable[..., Scenario], tmp_path: Path
) -> None:
    name = "<script>alert(1)</script>"
    victims = (Victim(name=name, position=(9.0, 4.0)),)
    scenario = hall_scenario(mission=Mission(victims=victims, time_limit_s=5.0))
    simulation = Simulation(scenario)
    recorder = FrameRecorder(simulation.setup)
    simulation.run([recorder])
    with shown(browser, tmp_path, [recorder.recording], title=f"</title>{name}") as page:
        seek(page, 4.0)
        labels = page.eval_on_selector_all(".label.victim", "all => all.map((one) => one.textContent)")
        assert labels == [f"? {name}"]
        assert page.title() == f"</title>{name}"


@pytest.mark.parametrize("size", [(1600, 900), (390, 844)])
def test_labels_do_not_overlap(browser: Browser, recording: Recording, tmp_path: Path, size: tuple[int, int]) -> None:
    with shown(browser, tmp_path, [recording], size=size) as page:
        for share in (0.0, 0.3, 0.8):
            seek(page, share * recording.frames[-1].time_s)
            boxes = page.evaluate(
                """[...document.querySelectorAll(".label")].filter((one) => !one.hidden).map((one) => {
                    const box = one.getBoundingClientRect();
                    return [box.left, box.top, box.right, box.bottom];
                })"""
            )
            assert boxes
            for (ax0, ay0, ax1, ay1), (bx0, by0, bx1, by1) in itertools.combinations(boxes, 2):
                assert ax1 <= bx0 or bx1 <= ax0 or ay1 <= by0 or by1 <= ay0


def test_compared_missions_are_shown_at_the_same_time(browser: Browser, recording: Recording, tmp_path: Path) -> None:
    with shown(browser, tmp_path, [recording, recording], compare=True, fragment="#t=10") as page:
        seek(page, 10.1)
        times = page.eval_on_selector_all(".view", "all => all.map((one) => one.dataset.time)")
        assert times == ["10.1", "10.1"]


def test_clicks_on_a_robot_and_on_an_event_show_its_name_readings_and_its_time(
    browser: Browser, recording: Recording, tmp_path: Path
) -> None:
    begin_frame, *later = recording.frames
    sensed = tuple({"sonar": f"{i + 0.25:.2f} m"} for i in range(len(begin_frame.poses)))
    frames = [msgspec.structs.replace(begin_frame, sensors=sensed), *later]
    with shown(browser, tmp_path, [replace(recording, frames=frames)]) as page:
        seek(page, recording.frames[len(recording.frames) // 2].time_s)
        label = page.locator(".label.robot:not([hidden])").first.bounding_box()
        assert label is not None
        for down in range(4, 40, 4):
            page.mouse.click(label["x"] + label["width"] / 2, label["y"] + label["height"] + down)
            page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            if page.is_visible("#robot h2"):
                break
        assert page.inner_text("#robot h2") == recording.scene.robots[0].name
        assert page.inner_text("#robot").split()[-3:] == ["sonar", "0.25", "m"]
        assert page.is_visible("#curves canvas")
        page.locator("#events li").first.click()
        begin = f"{recording.events[0].time_s:.1f}"
        page.wait_for_selector(f".view[data-time='{begin}']")


def test_events_are_filtered_by_topic_and_those_of_links_are_one_line(
    browser: Browser, recording: Recording, tmp_path: Path
) -> None:
    links = [ShownEvent(0.2, "link_endangered", f"link {pair} is endangered") for pair in ("1-2", "2-3", "1-3")]
    victim = ShownEvent(0.3, "victim_heard", "eve is heard")
    again = ShownEvent(0.4, "link_endangered", "link 1-2 is endangered")
    recording = replace(recording, events=[*links, victim, again])
    with shown(browser, tmp_path, [recording]) as page:
        listed = page.locator("#events li span")
        assert listed.all_text_contents() == ["3 links endangered", "eve is heard", "link 1-2 is endangered"]
        assert page.locator("#events label").all_text_contents() == [" link 4", " victim 1"]
        page.get_by_label("link 4").uncheck()
        assert listed.all_text_contents() == ["eve is heard"]
        page.get_by_label("link 4").check()
        page.get_by_label("victim 1").uncheck()
        assert listed.all_text_contents() == ["4 links endangered"]


def test_curves_of_a_long_mission_end_with_its_last_frame(
    browser: Browser, recording: Recording, tmp_path: Path
) -> None:
    first = recording.frames[0]
    frames = [msgspec.structs.replace(first, time_s=0.1 * index) for index in range(1300)]
    frames.append(msgspec.structs.replace(first, time_s=130.0, links=()))
    assert first.links
    with shown(browser, tmp_path, [replace(recording, frames=frames)]) as page:
        seek(page, 130.0)
        assert "links: 0" in page.locator("#curves figcaption").all_text_contents()


_PASSAGE = """async () => {
    const { Mission } = await import("viewer/mission"), mission = new Mission();
    const places = [[1, 0, 0], [2, 0, 0], [20, 0, 0], [21, 0, 0], null, [22, 0, 0]];
    const frames = places.map((pose, index) => ({ time_s: 0.2 * index, poses: [pose], links: [] }));
    mission.begin({});
    mission.add({ events: [], layers: {}, frames });
    const shown = [0.1, 0.3, 0.5].map((time) => mission.at(time).poses[0][0]);
    return { shown, trails: mission.trails(0, 0, 1).map((piece) => piece.map(([x]) => x)) };
}"""


def test_robot_that_goes_to_another_level_is_at_no_place_between(
    browser: Browser, recording: Recording, tmp_path: Path
) -> None:
    with shown(browser, tmp_path, [recording]) as page:
        found = page.evaluate(_PASSAGE)
    assert found["shown"] == pytest.approx([1.5, 2.0, 20.5])
    assert found["trails"] == [[1, 2], [20, 21], [22]]


@pytest.mark.parametrize("size", [(1600, 900), (1000, 1000), (600, 1200)])
def test_building_fills_the_picture(
    browser: Browser, recording: Recording, tmp_path: Path, size: tuple[int, int]
) -> None:
    with shown(browser, tmp_path, [recording], size=size) as page:
        page.click("#camera")
        seek(page, 0.0)
        page.add_style_tag(content=".view > :not(canvas) { visibility: hidden }")
        picture = Image.open(io.BytesIO(page.locator(".view canvas").screenshot())).convert("RGB")
    background = Image.new("RGB", picture.size, picture.getpixel((0, 0)))
    left, top, right, bottom = ImageChops.difference(picture, background).getbbox()
    assert max((right - left) / picture.width, (bottom - top) / picture.height) > 0.9
    assert left + right == pytest.approx(picture.width, abs=0.05 * picture.width)
    assert top + bottom == pytest.approx(picture.height, abs=0.05 * picture.height)


def test_without_webgl_one_line_says_what_the_page_needs(
    browser_without_webgl: Browser, recording: Recording, tmp_path: Path
) -> None:
    path = tmp_path / "mission.html"
    path.write_text(mission_page([recording], "mission"), encoding="utf-8")
    page = browser_without_webgl.new_page()
    page.goto(f"file://{path}")
    page.wait_for_selector("#failure:not([hidden])", timeout=READY_MS)
    assert page.inner_text("#failure") == (
        "This page needs WebGL 2, which this browser does not offer: "
        "turn on hardware acceleration, or use another browser."
    )
    page.close()


def test_damaged_data_show_one_line(browser: Browser, recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "mission.html"
    whole = mission_page([recording], "damaged")
    begin = whole.index('data-mode="single">') + 200
    path.write_text(whole[:begin] + "AAAA" + whole[begin + 40 :], encoding="utf-8")
    page = browser.new_page()
    page.goto(f"file://{path}")
    page.wait_for_selector("#failure:not([hidden])", timeout=READY_MS)
    assert "cannot be shown" in str(page.text_content("#failure"))
    page.close()

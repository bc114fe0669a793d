"""What users do on the page of a live mission: drive robots, add people and robots, save what they see."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Page
from shown_page import READY_MS, opened, served, shown, taken

from robotteamsim.errors import PlacementError, SensorError
from robotteamsim.geometry import Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Mission, PlacedRobot, Run
from robotteamsim.scenario.sensors import Sonar
from robotteamsim.simulation import Simulation
from robotteamsim.view.frame import Frame
from robotteamsim.view.html import mission_page
from robotteamsim.view.live import (
    AnyCommand,
    Drive,
    LiveMission,
    Play,
    Release,
    Restart,
    SetGoal,
    SetVictim,
    SpawnRobot,
    Step,
)
from robotteamsim.view.recorder import Recording, record_mission
from robotteamsim.view.server import ViewServer

_SMALL = (900, 560)
_ROBOTS = (
    PlacedRobot(start_pose=(3.0, 4.0, 0.0)),
    PlacedRobot(start_pose=(3.0, 6.0, 0.0)),
    PlacedRobot(start_pose=(3.0, 2.0, 0.5), present=False),
)


@pytest.fixture
def scenario(hall_scenario: Callable[..., Scenario]) -> Scenario:
    """The hall, with a third robot in reserve."""
    return hall_scenario(robots=_ROBOTS)


@pytest.fixture
def mission(scenario: Scenario) -> Iterator[LiveMission]:
    """A mission that waits for its first step."""
    started = LiveMission(lambda _: scenario, speed=1000.0, playing=False)
    started.start()
    yield started
    started.close()


def test_error_in_the_words_of_a_sensor_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Sonar, "text", lambda *_: 1 / 0)
    scenario = load("tutorial_arena", ["robots.sensors=[{kind: sonar, name: front}]"])
    with pytest.raises(SensorError, match=r"^robot 0, sensor front \(kind sonar\): ZeroDivisionError: "):
        LiveMission(lambda _: scenario, speed=1.0, playing=False)


def _frame(mission: LiveMission, *commands: AnyCommand) -> Frame:
    """Execute commands, and return what a new viewer then sees."""
    for command in commands:
        mission.execute(command)
    viewer = mission.subscribe()
    frame = taken(mission, viewer).frames[-1]
    mission.unsubscribe(viewer)
    return frame


def _distance_m(frame: Frame, robot_id: int, place: tuple[float, float]) -> float:
    pose = frame.poses[robot_id]
    assert pose is not None
    return math.dist(pose[:2], place)


def test_robot_driven_by_shares_moves_as_one_that_is_commanded(mission: LiveMission, scenario: Scenario) -> None:
    frame = _frame(mission, Drive(0, -0.5, 1.0), *[Step()] * 20)
    alone, drive = Simulation(scenario), _ROBOTS[0].drive
    alone.mission.start()
    alone.step()
    for _ in range(20):
        alone.command({0: Twist(-0.5 * drive.max_speed_mps, 0.0, drive.max_turn_radps)})
        record = alone.step()
    expected = [(pose.x_m, pose.y_m, pose.yaw_rad) for pose in (record.readings[i].true_pose for i in range(2))]
    assert list(frame.poses[:2]) == expected


def test_robot_drives_to_its_goal_and_waits_there_until_it_is_released(mission: LiveMission) -> None:
    goal = (6.0, 8.0)
    mission.execute(SetGoal(0, goal))
    assert _distance_m(_frame(mission), 0, goal) > 3.0
    arrived = _frame(mission, *[Step()] * 150)
    assert _distance_m(arrived, 0, goal) < 0.3
    assert _distance_m(_frame(mission, *[Step()] * 50), 0, goal) < 0.3
    assert _distance_m(_frame(mission, Release(0), *[Step()] * 50), 0, goal) > 0.5
    mission.execute(SetGoal(0, goal))
    mission.execute(Restart(1))
    viewer = mission.subscribe()
    assert taken(mission, viewer).status["driven"] == {}


def test_robot_in_reserve_is_shown_before_the_next_step_and_the_mission_goes_on_with_it(mission: LiveMission) -> None:
    assert _frame(mission).poses[2] is None
    assert _frame(mission, SpawnRobot(2, (6.0, 3.0))).poses[2] == (6.0, 3.0, 0.0)
    assert _frame(mission, Step()).poses[2] is not None
    with pytest.raises(ValueError, match="robot_2 is already present"):
        mission.execute(SpawnRobot(2))
    mission.execute(Restart(1))
    with pytest.raises(PlacementError):
        mission.execute(SpawnRobot(2, (3.0, 4.0)))
    assert _frame(mission, SpawnRobot(2)).poses[2] == (3.0, 2.0, 0.5)


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (Drive(9, 1.0, 0.0), "there is no robot 9, only 0 to 2"),
        (Drive(-1, 1.0, 0.0), "there is no robot -1"),
        (Drive(2, 1.0, 0.0), "robot 2 is absent"),
        (SetGoal(0, (100.0, 4.0)), r"set_goal: position_m: \(100, 4\): no floor for robot 0 within 1 m"),
        (Release(9), "there is no robot 9"),
        (SpawnRobot(9), "robot_id must be in 0..2, got 9"),
    ],
)
def test_what_is_not_possible_changes_nothing(mission: LiveMission, command: AnyCommand, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        mission.execute(command)
    viewer = mission.subscribe()
    assert taken(mission, viewer).status["driven"] == {}


def test_goal_that_is_refused_leaves_a_robot_to_whoever_drives_it(mission: LiveMission) -> None:
    mission.execute(Drive(0, 1.0, 0.0))
    with pytest.raises(ValueError, match="no floor"):
        mission.execute(SetGoal(0, (100.0, 4.0)))
    assert taken(mission, mission.subscribe()).status["driven"] == {0: None}
    before = _frame(mission).poses[0]
    mission.execute(Release(1))  # nobody drives it, so nothing changes
    assert _frame(mission, Step()).poses[0] != before


def _ended(scenario: Scenario, *commands: AnyCommand) -> LiveMission:
    """Return a mission that has ended, which was changed by commands after its first step."""
    mission = LiveMission(lambda _: scenario, speed=1000.0, playing=False)
    mission.start()
    for command in (*commands, *[Step()] * 60):
        mission.execute(command)
    assert _frame(mission).state == "ended"
    return mission


def _short(hall_scenario: Callable[..., Scenario]) -> Scenario:
    return hall_scenario(robots=_ROBOTS, mission=Mission(time_limit_s=5.0), run=Run(seed=3))


def test_page_of_a_mission_that_nobody_touched_is_that_of_run_html(hall_scenario: Callable[..., Scenario]) -> None:
    scenario = _short(hall_scenario)
    recording, _ = record_mission(scenario)
    expected = mission_page([recording], recording.title)
    for commands, is_same in (((), True), ((Drive(0, 1.0, 0.0),), False)):
        mission = _ended(scenario, *commands)
        assert (mission.page() == expected) == is_same
        mission.close()


def test_page_of_a_team_whose_links_would_fill_the_memory_is_refused(hall_scenario: Callable[..., Scenario]) -> None:
    robots = tuple(PlacedRobot(start_pose=(3.0, 4.0, 0.0), present=i == 0) for i in range(150))
    scenario = hall_scenario(robots=robots, mission=Mission(time_limit_s=1000.0))
    mission = LiveMission(lambda _: scenario, speed=1.0, playing=False)
    with pytest.raises(ValueError, match=r"^a page of 150 robots for 1000 s has up to 56 million links"):
        mission.page()
    mission.start()
    mission.close()


@pytest.mark.slow
def test_enter_sets_a_field(browser: Browser, server: ViewServer) -> None:
    with opened(browser, server.url, size=_SMALL) as page:
        page.fill("#live-noise", "42")
        page.press("#live-noise", "Enter")
        page.wait_for_function("document.getElementById('state').textContent.includes('42 dB')")
        page.fill("#live-seed", "7")
        page.press("#live-seed", "Enter")
        page.wait_for_function("document.getElementById('live-noise').value !== '42'")
        page.fill("#live-name", "eve")
        page.press("#live-name", "Enter")
        assert page.locator("#live p", has_text="Click on the floor to place eve.").is_visible()


def _place_of(page: Page, label: str) -> tuple[float, float]:
    """Return the place of a robot in the window, from above, near which its label is."""
    box = page.locator(".label.robot:not([hidden])", has_text=label).first.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] + 9  # NEAR_PX of labels.js


def _settled(page: Page) -> None:
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


@pytest.mark.slow
def test_robot_is_driven_by_keys_and_by_a_dragged_goal(
    browser: Browser, server: ViewServer, mission: LiveMission
) -> None:
    with opened(browser, server.url, size=_SMALL) as page:
        page.click("#above")
        _settled(page)
        before = _frame(mission)
        x, y = _place_of(page, "0")
        page.mouse.click(x, y)
        page.keyboard.down("w")
        page.keyboard.down("ArrowLeft")
        page.wait_for_selector("#live >> text=release robot_0")
        page.keyboard.up("w")
        page.keyboard.up("ArrowLeft")
        page.keyboard.down("w")
        page.locator("#step").click()
        page.wait_for_function("Number(document.querySelector('.view').dataset.time) > 0.05")
        ahead = _frame(mission, *[Step()] * 10)
        assert ahead.poses[0][0] - before.poses[0][0] > 0.3
        assert ahead.poses[0][1] == pytest.approx(before.poses[0][1], abs=1e-6)
        page.keyboard.up("w")
        page.evaluate("document.querySelector('#live').textContent")
        page.click("#live >> text=release robot_0")
        page.wait_for_selector("#live >> text=release robot_0", state="detached")
        page.click("#above")
        _settled(page)
        x, y = _place_of(page, "1")
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 100, y - 20, steps=3)
        page.mouse.up()
        page.wait_for_selector("#live >> text=release robot_1")
        viewer = mission.subscribe()
        goal = taken(mission, viewer).status["driven"][1]
        assert goal is not None
        (rx, ry, _) = ahead.poses[1]
        assert goal[0] > rx + 1.0
        assert ry < goal[1] < ry + 0.5 * (goal[0] - rx)


@pytest.mark.slow
def test_victim_and_robot_in_reserve_are_added_while_the_mission_runs(
    browser: Browser, server: ViewServer, mission: LiveMission
) -> None:
    with opened(browser, server.url, size=_SMALL) as page:
        page.click("#above")
        _settled(page)
        assert page.input_value("#live-name") == "victim 3"
        page.click("#live form:has(#live-name) button")
        box = page.locator(".view").bounding_box()
        assert box is not None
        page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.4 * box["height"])
        page.wait_for_selector('.view[data-victims="3"]')
        assert _frame(mission).victims[-1].name == "victim 3"
        assert page.input_value("#live-name") == "victim 4"
        page.click("#live >> text=at start")
        page.wait_for_selector('.view[data-robots="3"]')
        assert page.is_hidden("#live-absent")


def _picture_of(page: Page, folder: Path) -> Image.Image:
    with page.expect_download() as download:
        page.click("#picture")
    assert download.value.suggested_filename.endswith(" s.png")
    path = folder / "picture.png"
    download.value.save_as(path)
    return Image.open(path).convert("RGB")


@pytest.mark.slow
@pytest.mark.parametrize("compare", [False, True])
def test_picture_shows_what_the_views_show(
    browser: Browser, recording: Recording, tmp_path: Path, compare: bool
) -> None:
    recordings = [recording] * (1 + compare)
    with shown(browser, tmp_path, recordings, compare=compare, size=_SMALL) as page:
        assert page.is_hidden("#save")
        page.click("#layer-voice")
        _settled(page)
        window, box = Image.open(io.BytesIO(page.screenshot())).convert("RGB"), page.locator("#views").bounding_box()
        found = _picture_of(page, tmp_path)
    assert box is not None
    assert found.size == (int(box["width"]), int(box["height"]))
    left, top = round(box["x"]), round(box["y"])
    expected = window.crop((left, top, left + found.width, top + found.height))
    wrong = np.abs(np.asarray(found, dtype=int) - np.asarray(expected, dtype=int)).max(axis=2) > 60
    assert np.mean(wrong) < 0.01


@pytest.mark.slow
def test_saved_page_plays_the_mission_so_far(
    browser: Browser, server: ViewServer, mission: LiveMission, tmp_path: Path
) -> None:
    _frame(mission, SetVictim("eve", (10.0, 5.0)), *[Step()] * 20)
    path = tmp_path / "saved.html"
    with opened(browser, server.url, size=_SMALL) as page:
        with page.expect_download() as download:
            page.click("#save")
        assert download.value.suggested_filename == "hall, seed 1.html"
        download.value.save_as(path)
    with opened(browser, f"file://{path}#t=100", size=_SMALL) as page:
        assert page.get_attribute(".view", "data-time") == "2.0"
        assert page.get_attribute(".view", "data-victims") == "3"


@pytest.mark.slow
def test_play_at_the_end_of_a_recording_begins_again(browser: Browser, recording: Recording, tmp_path: Path) -> None:
    end_s = recording.frames[-1].time_s + 0.037  # which is not a multiple of a step of the slider
    frames = [*recording.frames, msgspec.structs.replace(recording.frames[-1], time_s=end_s)]
    with shown(browser, tmp_path, [replace(recording, frames=frames)], size=_SMALL) as page:
        page.focus("#time")
        page.keyboard.press("End")
        page.click("#play")
        page.wait_for_function("Number(document.querySelector('.view').dataset.time) < 20")
        assert "playing" in (page.get_attribute("#play", "class") or "")


@pytest.mark.slow
def test_play_after_the_end_of_a_live_mission_shows_it_again(
    browser: Browser, hall_scenario: Callable[..., Scenario]
) -> None:
    mission = _ended(_short(hall_scenario))
    mission.execute(Play())
    with served(mission) as server, opened(browser, server.url, size=_SMALL) as page:
        end = page.get_attribute(".view", "data-time")
        assert (end, page.get_attribute("#play", "class") or "") == ("5.0", "")
        page.select_option("#speed", "0.5")
        page.click("#play")
        page.wait_for_function("Number(document.querySelector('.view').dataset.time) < 4")
        assert "playing" in (page.get_attribute("#play", "class") or "")
        page.click("#layer-voice")  # an answer of the server leaves it as it is
        page.wait_for_function("document.querySelector('.view').dataset.time === '5.0'")
        page.wait_for_selector("#play:not(.playing)")
    mission.close()


@pytest.mark.slow
def test_finger_next_to_a_robot_selects_it(browser: Browser, recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "mission.html"
    path.write_text(mission_page([recording], "mission"), encoding="utf-8")
    with browser.new_context(viewport={"width": 600, "height": 600}, has_touch=True) as context:
        page = context.new_page()
        page.goto(f"file://{path}")
        page.wait_for_selector("body[data-ready]", state="attached", timeout=READY_MS)
        x, y = _place_of(page, "1")
        page.mouse.click(x, y - 17)
        _settled(page)
        assert page.is_hidden("#robot")
        page.touchscreen.tap(x, y - 17)
        _settled(page)
        assert page.inner_text("#robot h2") == "robot_1"

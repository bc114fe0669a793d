"""A rescue in the browser: fire, smoke and people are those of the simulation, live and in a file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page
from rosbags.rosbag1 import Reader, Writer
from shown_page import opened, seek, served, shown, taken

from robotteamsim.errors import RecordingError
from robotteamsim.hazards import BURNING
from robotteamsim.recording import BagWriter
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.topics.world import FIRE, SMOKE, smoke_cells
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, Simulation, StepRecord
from robotteamsim.view.from_bag import recording_of
from robotteamsim.view.live import LiveMission, SetLayers, Step
from robotteamsim.view.recorder import FrameRecorder, Recording
from robotteamsim.view.server import ViewServer

pytestmark = pytest.mark.slow

_LIMIT_S = 40.0


def _scenario(seed: int | None = None) -> Scenario:
    """A hall with a fire; one victim is hurt, one can walk, one flees, and one lies in the flames."""
    walls = {
        "south": [[0, 0], [24, 0]],
        "north": [[0, 10], [24, 10]],
        "west": [[0, 0], [0, 10]],
        "east": [[24, 0], [24, 10]],
    }
    return from_mapping(
        {
            "name": "hall",
            "plan": {
                "name": "hall",
                "bounds": {"min": [-0.5, -0.5], "max": [24.5, 10.5]},
                "walls": [{"name": name, "from": a, "to": b, "thickness_m": 0.2} for name, (a, b) in walls.items()],
            },
            "robots": {"count": 2, "start": [4.0, 2.0, 0.0]},
            "command_centre": [1.5, 5.0],
            "firefighters": {"count": 1, "start": [3.0, 5.0, 0.0]},
            "control": {"algorithm": "cover"},
            "mission": {
                "saved_by": "firefighter",
                "exits": [{"name": "gate", "center": [12.0, 1.0]}],
                "victims": [
                    {"name": "ann", "position": [6.0, 6.0]},
                    {"name": "bob", "position": [10.0, 8.0], "can_walk": True},
                    {"name": "eve", "position": [18.0, 2.0], "flees": True, "flees_after_s": 3.0, "speed_mps": 1.0},
                    {"name": "tom", "position": [21.0, 7.0], "calling": False},
                ],
                "time_limit_s": _LIMIT_S,
            },
            "fire": {
                "fuel": [{"name": "store", "polygon": [[18, 4], [23, 4], [23, 9], [18, 9]], "growth": "ultra_fast"}],
                "ignitions": [{"at_s": 0.0, "position": [20.5, 6.5]}],
            },
            "run": {"seed": 1 if seed is None else seed},
        },
        "hall.yaml",
    )


class _Truth:
    """Keeps what the page has to show, by time on the mission's clock [s]."""

    def __init__(self) -> None:
        self.burning: list[tuple[float, int]] = []
        self.states: list[tuple[float, tuple[str, ...]]] = []

    def begin(self, scenario: Scenario) -> None:
        pass

    def step(self, record: StepRecord) -> None:
        if record.hazards is not None:
            self.burning.append((record.mission.time_s, int(np.count_nonzero(record.hazards.states == BURNING))))
        self.states.append((record.mission.time_s, record.mission.victims))

    def end(self, result: Result) -> None:
        pass

    def abandon(self) -> None:
        pass


def _rows(page: Page, section: str) -> list[list[str]]:
    """Return the texts of the cells of a section's table, row by row."""
    found: list[list[str]] = page.eval_on_selector_all(
        f"{section} tr", "all => all.map((one) => [...one.cells].map((c) => c.textContent))"
    )
    return found


def _last(values: list[tuple[float, Any]], time_s: float) -> Any:
    return [value for since_s, value in values if since_s <= time_s + 1e-9][-1]


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> tuple[Recording, _Truth, Path]:
    """Record the mission; return it, the truth, and its bag."""
    simulation = Simulation(_scenario())
    recorder, truth = FrameRecorder(simulation.setup), _Truth()
    bag = tmp_path_factory.mktemp("rescue") / "rescue.bag"
    simulation.run([recorder, truth, BagWriter(bag)])
    return recorder.recording, truth, bag


def test_page_shows_the_burning_cells_and_the_states_of_the_mission_at_any_time(
    browser: Browser, mission: tuple[Recording, _Truth, Path], tmp_path: Path
) -> None:
    recording, truth, _ = mission
    with shown(browser, tmp_path, [recording]) as page:
        end_s = recording.frames[-1].time_s
        for time_s in (35.05, 5.05, 20.05, end_s, 10.05):  # forwards and backwards
            found = seek(page, time_s)
            shown_s = float(found["time"])
            frame = [frame for frame in recording.frames if frame.time_s <= shown_s + 1e-9][-1]
            states = _last(truth.states, frame.time_s)
            assert int(found["burning"]) == _last(truth.burning, shown_s)
            flees = [victim.gait == "flees" for victim in frame.victims]
            expected = [
                "fleeing" if away and s in ("waiting", "heard") else s for s, away in zip(states, flees, strict=True)
            ]
            assert found["states"].split() == expected
        assert int(seek(page, 30.0)["smoky"]) > int(seek(page, 10.0)["smoky"]) > 0
        assert max(count for _, count in truth.burning) > 3


def test_key_names_the_states_and_roles_and_layers_can_be_hidden(
    browser: Browser, mission: tuple[Recording, _Truth, Path], tmp_path: Path
) -> None:
    with shown(browser, tmp_path, [mission[0]]) as page:
        words = str(page.text_content(".key"))
        for word in ("carried", "fleeing", "dead", "firefighter", "command centre", "burning", "smoke"):
            assert word in words
        seek(page, 30.0)
        picture = page.locator(".view").screenshot()
        page.uncheck("#layer-fire")
        page.uncheck("#layer-smoke")
        seek(page, 30.0)
        assert page.locator(".view").screenshot() != picture
        labels = page.eval_on_selector_all(".label.robot:not([hidden])", "all => all.map((one) => one.textContent)")
        assert {"F2", "centre"} <= set(labels)


def test_click_on_a_victim_shows_their_states_with_times(
    browser: Browser, mission: tuple[Recording, _Truth, Path], tmp_path: Path
) -> None:
    recording, truth, _ = mission
    with shown(browser, tmp_path, [recording]) as page:
        seek(page, 30.0)
        label = page.locator(".label.victim", has_text="tom").bounding_box()
        assert label is not None
        x, y = label["x"] + label["width"] / 2, label["y"] + label["height"]
        for down in range(4, 60, 4):
            page.mouse.click(x, y + down)
            seek(page, 30.0)
            if page.is_visible("#victim"):
                break
        rows = _rows(page, "#victim")
        begins: list[tuple[str, float]] = []
        for time_s, states in truth.states:
            if time_s <= 30.0 and (not begins or begins[-1][0] != states[3]):
                begins.append((states[3], time_s))
        assert str(page.text_content("#victim h2")) == "tom"
        found, exposure = rows[: len(begins)], dict(rows[len(begins) :])
        assert [state for state, _ in found] == [state for state, _ in begins]
        for (_, text), (_, time_s) in zip(found, begins, strict=True):
            assert float(text.removesuffix(" s")) == pytest.approx(time_s, abs=0.25)
        frame = [frame for frame in recording.frames if frame.time_s <= 30.0 + 1e-9][-1]
        assert frame.egress is not None
        gas, heat, visibility_m = frame.egress.exposures[3]
        assert [exposure["FED by gas"], exposure["FED by heat"]] == [f"{gas:.2f}", f"{heat:.2f}"]
        assert float(exposure["visibility"].removesuffix(" m")) == pytest.approx(visibility_m, abs=0.11)


def test_panel_counts_people_out_by_exit_and_shows_egress_times(
    browser: Browser, mission: tuple[Recording, _Truth, Path], tmp_path: Path
) -> None:
    recording, _, _ = mission
    with shown(browser, tmp_path, [recording]) as page:
        for time_s in (5.0, recording.frames[-1].time_s):
            seek(page, time_s)
            frame = [frame for frame in recording.frames if frame.time_s <= time_s + 1e-9][-1]
            assert frame.egress is not None
            rows = dict(_rows(page, "#egress"))
            assert rows["out: gate"] == str(frame.egress.out["gate"])
            assert (rows["out: gate"] == "0") == (time_s == 5.0)
            rset_s = frame.egress.rset_s
            assert rows["RSET"] == ("not reached" if rset_s is None else f"{rset_s:.1f} s")
            assert "fire began" in rows


def test_a_bag_shows_the_same_fire_and_smoke(mission: tuple[Recording, _Truth, Path]) -> None:
    own, _, path = mission
    bag = recording_of(read_run([path]), _scenario())
    assert bag.scene.has_fire
    assert [robot.role for robot in bag.scene.robots] == ["robot", "robot", "firefighter", "command_centre"]
    for layers, others in ((bag.fire, own.fire), (bag.smoke, own.smoke)):
        assert len(layers) == len(others) > 5
        for layer, other in zip(layers, others, strict=True):
            np.testing.assert_array_equal(layer.values, other.values)


@pytest.mark.parametrize("topic", [FIRE.name, SMOKE.name])
def test_a_bag_whose_floor_changes_is_rejected_in_one_line(
    mission: tuple[Recording, _Truth, Path], tmp_path: Path, topic: str
) -> None:
    path, types = tmp_path / "odd.bag", bag_typestore()
    with Reader(mission[2]) as good, Writer(path) as odd:
        connections = {c.topic: odd.add_connection(c.topic, c.msgtype, typestore=types) for c in good.connections}
        count = 0
        for known, time_ns, data in good.messages():
            count += known.topic == topic
            if known.topic == topic and count == 2:  # soon after the first, so that it would not be shown
                message = types.deserialize_ros1(data, known.msgtype)
                message.info.height //= 2
                message.data = message.data[: message.info.height * message.info.width]
                data = types.serialize_ros1(message, known.msgtype)
            odd.write(connections[known.topic], time_ns, data)
    with pytest.raises(
        RecordingError,
        match=f"^{re.escape(str(path))}: {topic}: maps of different sizes or places; expected one floor$",
    ):
        recording_of(read_run([path]))


def test_each_viewer_receives_the_layers_that_it_has_chosen() -> None:
    live = LiveMission(_scenario, speed=1000.0, playing=False)
    live.start()
    one, other = live.subscribe(), live.subscribe()
    numbers = [taken(live, viewer).viewer for viewer in (one, other)]
    live.execute(SetLayers(numbers[0], ["voice", "laser"]))
    for _ in range(12):
        live.execute(Step())
    first, second = taken(live, one), taken(live, other)
    assert set(first.layers) == {"voice"}
    assert set(second.layers) == {"fire", "smoke"}
    assert first.frames[-1].scans_m
    assert not second.frames[-1].scans_m
    live.close()


@pytest.fixture
def server() -> Iterator[ViewServer]:
    live = LiveMission(_scenario, speed=1000.0, playing=False)
    live.start()
    with served(live) as server:
        yield server
    live.close()


def test_live_page_shows_the_burning_cells(browser: Browser, server: ViewServer) -> None:
    alone = Simulation(_scenario())
    alone.mission.start()
    hazards = None
    for _ in range(102):
        hazards = alone.step().hazards or hazards
    assert hazards is not None
    assert server.mission is not None
    with opened(browser, server.url) as page:
        for _ in range(101):
            server.mission.execute(Step())
        wanted = {"time": "10.1", "burning": str(np.count_nonzero(hazards.states == BURNING))}
        wanted["smoky"] = str(np.count_nonzero((smoke_cells(hazards) + 2) // 4))
        page.wait_for_function(
            f"(() => {{ const found = document.querySelector('.view').dataset, wanted = {json.dumps(wanted)};"
            "return Object.keys(wanted).every((key) => found[key] === wanted[key]); })()"
        )
        earlier = seek(page, 5.0)
        assert (earlier["time"], earlier["burning"], earlier["smoky"]) == ("5.0", wanted["burning"], wanted["smoky"])

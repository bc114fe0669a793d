"""A program's own loop on a page: each step is shown, the page can pause it, and the file plays it."""

from __future__ import annotations

import json
import threading
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest

import robotteamsim as rts
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.recording import BagWriter
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Mission
from robotteamsim.view.live import Pause, SetLayers, SetNoise, SetSpeed, Step
from robotteamsim.view.recorder import record_mission
from robotteamsim.view.shown import MOST_SPEED


@pytest.fixture
def short(hall_scenario: Callable[..., Scenario]) -> Scenario:
    return hall_scenario(mission=Mission(time_limit_s=2.0))


def test_a_loop_without_commands_is_the_same_mission_as_run(short: Scenario, tmp_path: Path) -> None:
    recording, result = record_mission(short)
    with rts.LiveView(rts.Simulation(short), speed=MOST_SPEED, browser=False) as view:
        while view.step().mission.state != "ended":
            pass
    assert view.result is not None
    assert view.result.trajectory_hash == result.trajectory_hash
    view.save(tmp_path / "loop.html")
    assert (tmp_path / "loop.html").stat().st_size > 100_000
    assert recording.title in (tmp_path / "loop.html").read_text(encoding="utf-8")


def test_page_receives_the_scene_and_then_the_frames_and_the_end(short: Scenario) -> None:
    with rts.LiveView(rts.Simulation(short), speed=MOST_SPEED, browser=False) as view:
        viewer = view.subscribe()
        view.step()
        first = view.take(viewer, 1.0)
        assert first is not None
        assert first.restarted
        assert len(first.scene.robots) == 2
        while view.step().mission.state != "ended":
            pass
        last = view.take(viewer, 1.0)
        assert last is not None
        assert last.frames[-1].state == "ended"
        with urllib.request.urlopen(view.url, timeout=10.0) as page:
            assert b"<html" in page.read()


def test_page_pauses_the_program_and_lets_it_make_one_step(short: Scenario) -> None:
    simulation = rts.Simulation(short)
    with rts.LiveView(simulation, browser=False) as view:
        view.execute(Pause())
        made = threading.Event()
        thread = threading.Thread(target=lambda: (view.step(), made.set()))
        thread.start()
        view.execute(SetSpeed(MOST_SPEED))
        view.execute(SetLayers(1, ["laser"]))
        assert not made.wait(0.2)
        view.execute(Step())
        assert made.wait(10.0)
        thread.join()
        assert simulation.world.step_index == 1


def test_pause_is_shown_while_the_program_does_something_else(short: Scenario) -> None:
    with rts.LiveView(rts.Simulation(short), browser=False) as view:
        viewer = view.subscribe()
        view.step()
        first = view.take(viewer, 1.0)
        assert first is not None
        assert first.status["playing"]
        view.execute(Pause())  # the program is not within `step`
        second = view.take(viewer, 1.0)
        assert second is not None
        assert not second.status["playing"]


def test_page_of_the_loop_can_be_saved_from_the_browser(short: Scenario, tmp_path: Path) -> None:
    with rts.LiveView(rts.Simulation(short), speed=MOST_SPEED, browser=False) as view:
        view.step()
        view.save(tmp_path / "loop.html")
        with urllib.request.urlopen(f"{view.url}mission.html", timeout=10.0) as page:
            assert page.read() == (tmp_path / "loop.html").read_bytes()


def test_steps_that_the_loop_did_not_make_are_refused(short: Scenario) -> None:
    simulation = rts.Simulation(short)
    with rts.LiveView(simulation, speed=MOST_SPEED, browser=False) as view:
        view.step()
        simulation.step()
        with pytest.raises(ValueError, match="made 1 step elsewhere, which its result would lack"):
            view.step()
    with pytest.raises(ValueError, match="made 3 steps elsewhere"):
        simulation.run()


@pytest.mark.parametrize(
    ("what", "speed", "line"), [("hall", 10.0, "'hall' is not a Simulation"), (None, "fast", "'fast'")]
)
def test_what_cannot_be_watched_is_refused_in_one_line(short: Scenario, what: str, speed: object, line: str) -> None:
    with pytest.raises(ValueError, match=line):
        rts.LiveView(what or rts.Simulation(short), speed=speed, browser=False)


@pytest.mark.parametrize("opens", [True, False])
def test_address_is_told_where_no_browser_opens(short, monkeypatch, caplog, opens) -> None:
    monkeypatch.setattr("webbrowser.open", lambda _: opens)
    with rts.LiveView(rts.Simulation(short)) as view:
        assert caplog.messages == ([] if opens else [f"watch it at {view.url}"])


def test_a_port_that_is_in_use_is_named_in_one_line(short: Scenario) -> None:
    with rts.LiveView(rts.Simulation(short), browser=False) as view:
        port = int(view.url.rsplit(":")[-1].strip("/"))
        with pytest.raises(RobotTeamSimError, match=rf"^host 127\.0\.0\.1, port {port}: Address already in use$"):
            rts.LiveView(rts.Simulation(short), port=port, browser=False)
    with pytest.raises(RobotTeamSimError, match=r"^host 127\.0\.0\.1, port 70000: .*0-65535"):
        rts.LiveView(rts.Simulation(short), port=70000, browser=False)


def test_page_may_not_change_what_the_program_changes(short: Scenario) -> None:
    with rts.LiveView(rts.Simulation(short), browser=False) as view:
        view.step()
        body = json.dumps({"command": "set_noise", "noise_db": 20.0}).encode()
        request = urllib.request.Request(f"{view.url}command", body, {"Content-Type": "application/json"})
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request, timeout=10.0)
        with refused.value as answer:
            assert "only it changes anything else" in json.loads(answer.read())["error"]
        with pytest.raises(ValueError, match="a program steps this mission"):
            view.execute(SetNoise(20.0))


def test_a_loop_that_is_left_early_closes_its_bag(short: Scenario, tmp_path: Path) -> None:
    bag = tmp_path / "loop.bag"
    with rts.LiveView(rts.Simulation(short), speed=MOST_SPEED, observers=[BagWriter(bag)], browser=False) as view:
        view.step()
    assert view.result is None
    assert [path.name for path in tmp_path.iterdir()] == ["loop.bag"]


@pytest.mark.parametrize("speed", [0.0, float("nan"), float("inf"), -1.0])
def test_a_speed_out_of_range_is_refused(short: Scenario, speed: float) -> None:
    with pytest.raises(ValueError, match=r"^speed: .*; expected 0\.001 to 1000$"):
        rts.LiveView(rts.Simulation(short), speed=speed, browser=False)

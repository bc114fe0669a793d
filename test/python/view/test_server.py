"""The live server: on this machine only, obeys its page, and reports what it cannot do."""

from __future__ import annotations

import http.client
import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser
from shown_page import READY_MS, opened, served, taken

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.scenario.sensors import Camera
from robotteamsim.simulation import Simulation
from robotteamsim.view.live import LiveMission, Pause, Play, Restart, SetLayers, SetNoise, SetSpeed, SetVictim, Step
from robotteamsim.view.server import ViewServer

_WAIT_S = 60.0


@pytest.fixture
def mission(hall_scenario: Callable[..., Scenario]) -> Iterator[LiveMission]:
    """A mission that waits for its first step."""

    def load(seed: int | None) -> Scenario:
        return hall_scenario(run=Run(seed=1 if seed is None else seed))

    started = LiveMission(load, speed=1000.0, playing=False)
    started.start()
    yield started
    started.close()


def _post(server: ViewServer, body: str, headers: dict[str, str] | None = None) -> tuple[int, str]:
    connection = http.client.HTTPConnection(*server.server_address[:2], timeout=_WAIT_S)
    connection.request("POST", "/command", body, {"Content-Type": "application/json"} | (headers or {}))
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer.status, str(json.loads(text).get("error", "")) if text else ""


def test_first_update_contains_the_scene_and_further_ones_each_step(mission: LiveMission) -> None:
    viewer = mission.subscribe()
    first = taken(mission, viewer)
    assert first.restarted
    assert len(first.scene.robots) == 2
    assert first.events[0].kind == "start"
    mission.execute(Step())
    times_s = [frame.time_s for frame in taken(mission, viewer).frames]
    assert times_s[-1] == pytest.approx(first.frames[-1].time_s + 0.1)


def test_steps_are_those_of_the_same_mission_without_a_viewer(
    mission: LiveMission, hall_scenario: Callable[..., Scenario]
) -> None:
    viewer = mission.subscribe()
    for _ in range(20):
        mission.execute(Step())
    frames = taken(mission, viewer).frames
    alone = Simulation(hall_scenario())
    alone.mission.start()
    for _ in range(21):
        record = alone.step()
    expected = [reading.true_pose for reading in record.readings]
    assert frames[-1].poses == tuple((pose.x_m, pose.y_m, pose.yaw_rad) for pose in expected)


def test_commands_change_the_mission_and_a_restart_begins_it_again(mission: LiveMission) -> None:
    viewer = mission.subscribe()
    mission.execute(SetNoise(33.0))
    mission.execute(SetVictim("eve", (10.0, 5.0)))
    mission.execute(Step())
    frame = taken(mission, viewer).frames[-1]
    assert frame.noise_db == 33.0
    assert frame.victims[-1].name == "eve"
    mission.execute(Restart(7))
    again = taken(mission, viewer)
    assert again.restarted
    assert again.status["seed"] == 7
    assert len(again.frames[-1].victims) == 2


def test_a_map_of_a_step_is_shown_at_the_time_of_its_frame(hall_scenario: Callable[..., Scenario]) -> None:
    mission = LiveMission(lambda _: hall_scenario(run=Run(step_s=0.0333)), speed=1000.0, playing=False)
    mission.start()
    viewer = mission.subscribe()
    mission.execute(SetLayers(taken(mission, viewer).viewer, ["voice"]))
    taken(mission, viewer)
    mission.execute(Step())
    mission.execute(SetNoise(33.0))
    update = taken(mission, viewer)
    assert update.layers["voice"]["times_s"] == [update.frames[-1].time_s]
    mission.close()


@pytest.mark.slow
def test_steps_after_a_command_draw_the_images_of_cameras(hall_scenario: Callable[..., Scenario]) -> None:
    robot = PlacedRobot(start_pose=(3.0, 4.0, 0.0), sensors=(Camera(name="front", every_steps=1),))

    def load(seed: int | None) -> Scenario:
        return hall_scenario(robots=(robot,), run=Run(seed=seed or 1, world="mujoco"))

    mission = LiveMission(load, speed=1000.0, playing=False)
    mission.start()
    viewer = mission.subscribe()
    for command in (Step(), Restart(7), Step(), Play()):
        mission.execute(command)
    while (update := taken(mission, viewer)).frames[-1].time_s < 0.5:
        assert update.status["error"] == ""
    mission.close()


@pytest.mark.parametrize("command", [Play(), Restart(7)], ids=["play", "restart"])
def test_error_of_a_step_is_gone_after_a_new_start(
    mission: LiveMission, monkeypatch: pytest.MonkeyPatch, command: Play | Restart
) -> None:
    viewer = mission.subscribe()

    def fail(_: Simulation) -> None:
        raise RuntimeError("broken")

    with monkeypatch.context() as broken:
        broken.setattr(Simulation, "step", fail)
        mission.execute(Play())
        while (update := taken(mission, viewer)).status["error"] == "":
            pass
    assert update.status["error"] == "RuntimeError: broken"
    mission.execute(command)
    while (update := taken(mission, viewer)).status["error"]:
        pass


def test_thread_that_ends_unexpectedly_says_so_and_refuses_further_commands(
    mission: LiveMission, monkeypatch: pytest.MonkeyPatch
) -> None:
    viewer = mission.subscribe()

    def leave(_: Simulation) -> None:
        raise SystemExit("a library has enough")

    monkeypatch.setattr(Simulation, "step", leave)
    mission.execute(Play())
    while (update := taken(mission, viewer)).status["error"] == "":
        pass
    said = "the mission has ended unexpectedly: SystemExit: a library has enough; start `robotteamsim view` again"
    assert (update.status["error"], update.status["playing"]) == (said, False)
    with pytest.raises(ValueError, match=r"^the mission has ended unexpectedly: SystemExit: a library has enough; "):
        mission.execute(Play())


def test_step_after_the_slowest_speed_does_not_wait_for_that_speed(mission: LiveMission) -> None:
    viewer = mission.subscribe()
    mission.execute(SetSpeed(0.001))
    mission.execute(Play())
    while taken(mission, viewer).frames[-1].time_s < 0.05:  # the next one is due 100 s later
        pass
    begin_s = time.monotonic()
    mission.execute(SetSpeed(1000.0))
    while taken(mission, viewer).frames[-1].time_s < 0.5:
        pass
    assert time.monotonic() - begin_s < 50.0


@pytest.mark.parametrize("speed", [1e-300, 0.0009, 1000.5, float("nan")])
def test_mission_of_a_speed_out_of_range_is_refused(hall_scenario: Callable[..., Scenario], speed: float) -> None:
    with pytest.raises(ValueError, match=r"^speed: .*; expected 0\.001 to 1000$"):
        LiveMission(lambda _: hall_scenario(), speed=speed, playing=False)


def test_a_restart_that_fails_leaves_the_mission_as_it_is(
    mission: LiveMission, monkeypatch: pytest.MonkeyPatch
) -> None:
    viewer = mission.subscribe()
    taken(mission, viewer)
    with monkeypatch.context() as broken:
        broken.setattr(Simulation, "step", lambda simulation: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            mission.execute(Restart(7))
    mission.execute(Step())
    update = taken(mission, viewer)
    assert not update.restarted
    assert update.status["seed"] == 1
    assert update.frames[-1].time_s == pytest.approx(0.1)


def test_changes_of_a_paused_mission_are_shown_before_the_next_step(mission: LiveMission) -> None:
    viewer = mission.subscribe()
    first = taken(mission, viewer).frames[-1]
    mission.execute(SetVictim("eve", (10.0, 5.0)))
    mission.execute(SetNoise(33.0))
    frame = taken(mission, viewer).frames[-1]
    assert frame.time_s == first.time_s
    assert (frame.victims[-1].name, frame.noise_db) == ("eve", 33.0)
    again = taken(mission, mission.subscribe())
    assert [one.time_s for one in again.frames] == [first.time_s]


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('{"command": "set_noise", "noise_db": -1}', "noise_db: -1.0 is below 0"),
        ('{"command": "set_noise", "noise_db": 81}', "noise_db: 81.0 is above 80"),
        ('{"command": "set_noise", "noise_db": NaN}', "malformed"),
        ('{"command": "set_door", "name": "none", "closed": true}', "unknown door 'none'"),
        ('{"command": "set_victim", "name": "eve", "position_m": [1e300, 0]}', "<= 1000000.0"),
        ('{"command": "set_victim", "name": "", "position_m": [3, 4]}', "set_victim: name: is empty"),
        ('{"command": "set_speed", "speed": 0}', ">= 0.001"),
        ('{"command": "set_speed", "speed": 1e-300}', ">= 0.001"),
        ('{"command": "set_speed", "speed": 1000.5}', "<= 1000.0"),
        ('{"command": "watched"}', "Invalid value"),
        ('{"command": "fly"}', "Invalid value"),
        ('{"command": "play", "more": 1}', "unknown field"),
        ('{"comm', "truncated"),
        ("x" * 20_000, "too long"),
    ],
)
def test_a_wrong_command_is_answered_in_one_line_and_the_mission_goes_on(
    server: ViewServer, mission: LiveMission, body: str, said: str
) -> None:
    status, error = _post(server, body)
    assert status == 400
    assert said in error
    assert "\n" not in error
    mission.execute(Pause())


def test_server_answers_only_on_loopback_and_only_to_its_own_page(server: ViewServer) -> None:
    assert server.server_address[0] == "127.0.0.1"
    assert _post(server, '{"command": "play"}', {"Host": "attacker.example"})[0] == 403
    assert _post(server, '{"command": "play"}', {"Content-Type": "text/plain"})[0] == 403
    connection = http.client.HTTPConnection(*server.server_address[:2], timeout=_WAIT_S)
    for path, status in {"/": 200, "/page/main.js": 200, "/page/../server.py": 404, "/etc/passwd": 404}.items():
        connection.request("GET", path)
        answer = connection.getresponse()
        answer.read()
        assert answer.status == status
    connection.close()


@pytest.mark.parametrize(
    ("origin", "status"),
    [
        (None, 200),
        ("http://127.0.0.1:{port}", 200),
        ("http://localhost:{port}", 403),  # another origin than that of `Host`
        ("https://127.0.0.1:{port}", 403),
        ("http://127.0.0.1:1", 403),  # another program on this machine
        ("https://attacker.example", 403),
        ("null", 403),  # a file, or a frame in a sandbox
        ("", 403),
    ],
)
def test_page_of_another_origin_is_refused_in_one_line(server: ViewServer, origin: str | None, status: int) -> None:
    headers = {} if origin is None else {"Origin": origin.format(port=server.server_address[1])}
    given, error = _post(server, '{"command": "play"}', headers)
    assert given == status
    connection = http.client.HTTPConnection(*server.server_address[:2], timeout=_WAIT_S)
    connection.request("GET", "/", headers=headers)
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    assert answer.status == status
    if status == 403:
        assert error == text == "only for the viewer's own page: open the whole address that was printed"


_HOSTS = ["127.0.0.1", "0.0.0.0", *(["::1"] if Path("/proc/net/if_inet6").exists() else [])]


@pytest.mark.parametrize("host", _HOSTS)
def test_server_at_a_chosen_address_answers_only_requests_with_its_token(mission: LiveMission, host: str) -> None:
    with served(mission, host) as server:
        root, near = server.root, "::1" if host == "::1" else "127.0.0.1"
        assert len(root) >= 24

        def status_of(method: str, path: str, headers: dict[str, str]) -> int:
            connection = http.client.HTTPConnection(near, server.server_address[1], timeout=_WAIT_S)
            connection.request(method, path, '{"command": "step"}' if method == "POST" else None, headers)
            answer = connection.getresponse()
            text = answer.read().decode()
            connection.close()
            assert ("open the whole address" in text) == (answer.status == 403)
            return answer.status

        json_type = {"Content-Type": "application/json"}
        wrong = [root[:-2] + "/", root.swapcase(), root[:-1], "/", "/wrong/", f"/x{root}"]
        found = {path: status_of("GET", path, {}) for path in (root, f"{root}page/main.js", f"{root}none", *wrong)}
        assert found == {root: 200, f"{root}page/main.js": 200, f"{root}none": 404} | dict.fromkeys(wrong, 403)
        for path in ("/page/main.js", "/frames", "/command"):
            assert (path, status_of("GET", path, {})) == (path, 403)
        paths = [f"{root}command", "/command", f"{wrong[0]}command"]
        assert [status_of("POST", path, json_type) for path in paths] == [200, 403, 403]
        assert status_of("POST", f"{root}command", json_type | {"Origin": "https://attacker.example"}) == 403
    with served(mission, host) as again:
        assert again.root != root


@pytest.mark.parametrize(
    ("host", "name", "status"),
    [
        # Whoever knows the token was given the whole address, by whatever name the machine has.
        ("127.0.0.1", "lab-pc.example:8000", 200),
        ("127.0.0.1", "lab-pc.example", 200),  # as browsers ask at port 80
        (None, "localhost:8000", 200),
        (None, "127.0.0.1", 200),
        (None, "attacker.example:8000", 403),
        (None, "", 403),
    ],
)
def test_name_of_the_machine_matters_only_without_a_token(
    mission: LiveMission, host: str | None, name: str, status: int
) -> None:
    with served(mission, host) as server:
        connection = http.client.HTTPConnection(*server.server_address[:2], timeout=_WAIT_S)
        connection.request("GET", server.root, headers={"Host": name})
        assert connection.getresponse().status == status
        connection.close()


@pytest.mark.slow
@pytest.mark.parametrize("host", [None, "127.0.0.1"], ids=["default", "token"])
def test_live_page_follows_the_mission_and_sends_commands(
    browser: Browser, mission: LiveMission, host: str | None
) -> None:
    with served(mission, host) as server, opened(browser, server.url) as page:
        page.fill("#live-noise", "42")
        page.click("#live >> text=set")
        page.click("#step")
        page.wait_for_function("document.getElementById('state').textContent.includes('42 dB')")


@pytest.mark.slow
def test_live_page_says_that_a_mission_is_paused_and_its_fields_follow_a_restart(
    browser: Browser, server: ViewServer
) -> None:
    with opened(browser, server.url) as page:
        assert page.inner_text("#state").endswith("paused")
        noise_db = page.input_value("#live-noise")
        page.fill("#live-noise", "42")
        page.click("#live >> text=set")
        page.wait_for_function("document.getElementById('state').textContent.includes('42 dB')")
        page.fill("#live-seed", "7")
        page.click("#live >> text=restart")
        page.wait_for_function("document.getElementById('title').textContent.endsWith('seed 7')")
        assert (page.input_value("#live-noise"), page.input_value("#live-seed")) == (noise_db, "7")
        page.click("#play")
        page.wait_for_function("!document.getElementById('state').textContent.includes('paused')")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "value", "verb", "said"),
    [
        ("noise", "-5", "set", "noise_db: -5.0 is below 0"),
        ("noise", "1e999", "set", "noise [dB]: expected a number"),
        ("seed", "1.5", "restart", "seed: expected a whole number from 0 on"),
        ("seed", "-3", "restart", "seed: expected a whole number from 0 on"),
        ("seed", "", "restart", "seed: expected a whole number from 0 on"),
    ],
)
def test_live_page_shows_what_is_wrong_with_a_value(
    browser: Browser, server: ViewServer, field: str, value: str, verb: str, said: str
) -> None:
    page = browser.new_page()
    page.goto(server.url)
    page.wait_for_selector("body[data-ready]", state="attached", timeout=READY_MS)
    page.fill(f"#live-{field}", value)
    page.click(f"#live >> text={verb}")
    page.wait_for_selector(f'#live p:text-is("{said}")', timeout=READY_MS)
    page.close()

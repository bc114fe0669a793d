"""Environments in the viewer of the browser."""

from __future__ import annotations

import http.client
import json
import threading
from urllib.parse import urlsplit

import numpy as np
import pytest
from pettingzoo.test import render_test

from robotteamsim import learning
from robotteamsim.learning import gym_env, parallel_env
from robotteamsim.scenario import load

WAIT_S = 60.0
STAND = np.zeros(2, np.float32)


@pytest.fixture
def env():
    made = parallel_env(load("garage_sar", ["mission.time_limit_s=20"]), render_mode="human")
    yield made
    made.close()


class Page:
    """A page that reads what its server sends."""

    def __init__(self, address):
        self._host = urlsplit(address).netloc
        self._connection = http.client.HTTPConnection(self._host, timeout=WAIT_S)
        self._connection.request("GET", "/frames", headers={"Host": self._host})
        self._answer = self._connection.getresponse()

    def update(self):
        """Return the next update; None at the end."""
        while line := self._answer.readline():
            if line.startswith(b"data: "):
                return json.loads(line.removeprefix(b"data: "))
        return None

    def send(self, **command):
        """Return what is wrong with a command."""
        connection = http.client.HTTPConnection(self._host, timeout=WAIT_S)
        connection.request("POST", "/command", json.dumps(command), {"Content-Type": "application/json"})
        error = json.loads(connection.getresponse().read())["error"]
        connection.close()
        return error

    def close(self):
        self._answer.close()
        self._connection.close()


def logged(caplog):
    """Return the address of the page."""
    (line,) = caplog.messages
    return line.removesuffix(" shows the mission")


def stand(env):
    return env.step(dict.fromkeys(env.agents, STAND))


@pytest.mark.slow
def test_is_rendered_as_pettingzoo_and_gymnasium_expect():
    def make(render_mode):
        return learning.env(load("garage_sar", ["mission.time_limit_s=20"]), render_mode=render_mode)

    render_test(make)
    env = gym_env("tutorial_arena", render_mode="human")
    env.reset(seed=1)
    env.step(env.action_space.sample())
    assert env.render() is None
    env.close()


def test_page_shows_each_step_until_the_environment_is_closed(env, caplog):
    env.reset(seed=7)
    address = logged(caplog)
    assert address.startswith("http://127.0.0.1:")
    page = Page(address)
    first = page.update()
    assert (first["restarted"], first["title"], first["status"]["seed"]) == (True, "garage_sar, seed 7", 7)
    stand(env)
    update = first
    while update["frames"][-1]["time_s"] < env.record.mission.time_s:
        update = page.update()
    pose = env.record.readings[0].true_pose
    assert update["frames"][-1]["poses"][0] == [pose.x_m, pose.y_m, pose.yaw_rad]
    env.reset(seed=8)
    while not update["restarted"]:
        update = page.update()
    assert update["title"] == "garage_sar, seed 8"
    assert len(caplog.messages) == 1
    env.close()
    while page.update() is not None:
        pass
    page.close()
    with pytest.raises(ConnectionRefusedError):
        Page(address)


_ONLY_THE_PROGRAM = "not possible: a program steps this mission, and only it changes anything else"


def test_page_lets_the_environment_wait_and_changes_nothing_else(env, caplog):
    env.reset(seed=7)
    page = Page(logged(caplog))
    page.update()
    assert page.send(command="set_noise", noise_db=50.0) == _ONLY_THE_PROGRAM
    assert page.send(command="pause") == ""
    before_s = env.record.mission.time_s
    steps = threading.Thread(target=stand, args=(env,))
    steps.start()
    for number in range(1, 5):
        while page.update()["frames"][-1]["time_s"] < before_s + 0.1 * number - 0.01:
            pass
        assert env.record.mission.time_s == pytest.approx(before_s + 0.1 * number)
        assert page.send(command="step") == ""
    assert page.send(command="play") == ""
    steps.join(WAIT_S)
    assert env.record.mission.time_s == pytest.approx(before_s + 0.5)
    page.close()


def test_window_changes_no_bits(env):
    plain = parallel_env(load("garage_sar", ["mission.time_limit_s=20"]))
    seen = []
    for one in (env, plain):
        one.reset(seed=3)
        seen.append([stand(one)[0]["robot_0"] for _ in range(4)])
    np.testing.assert_array_equal(*seen)


def test_environment_that_was_never_reset_opens_nothing(caplog):
    env = parallel_env("garage_sar", render_mode="human")
    env.close()
    assert caplog.messages == []

"""A browser for the tests of pages: Debian's Chromium with software rendering."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, sync_playwright

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Simulation
from robotteamsim.view.recorder import FrameRecorder, Recording

_FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Start Chromium."""
    chromium = shutil.which("chromium")
    assert chromium, "Chromium is missing: `make setup` installs it"
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=chromium, args=_FLAGS)
        yield started
        started.close()


@pytest.fixture
def recording(hall_scenario: Callable[..., Scenario]) -> Recording:
    """Record the mission in the hall."""
    simulation = Simulation(hall_scenario())
    recorder = FrameRecorder(simulation)
    simulation.run([recorder])
    return recorder.recording

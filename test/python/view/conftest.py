"""A recording and a server for the tests of pages."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from shown_page import served

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.view.live import LiveMission
from robotteamsim.view.recorder import Recording, record_mission
from robotteamsim.view.server import ViewServer


@pytest.fixture
def recording(hall_scenario: Callable[..., Scenario]) -> Recording:
    """Record the mission in the hall."""
    return record_mission(hall_scenario())[0]


@pytest.fixture
def server(mission: LiveMission) -> Iterator[ViewServer]:
    """Serve the mission of a test's module."""
    with served(mission) as server:
        yield server

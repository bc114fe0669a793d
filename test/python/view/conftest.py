"""A recording for the tests of pages."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.view.recorder import Recording, record_mission


@pytest.fixture
def recording(hall_scenario: Callable[..., Scenario]) -> Recording:
    """Record the mission in the hall."""
    return record_mission(hall_scenario())[0]

"""A recording for the tests of pages."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Simulation
from robotteamsim.view.recorder import FrameRecorder, Recording


@pytest.fixture
def recording(hall_scenario: Callable[..., Scenario]) -> Recording:
    """Record the mission in the hall."""
    simulation = Simulation(hall_scenario())
    recorder = FrameRecorder(simulation)
    simulation.run([recorder])
    return recorder.recording

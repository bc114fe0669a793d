"""Recordings of missions that are simulated now, for the first time or again."""

from __future__ import annotations

from robotteamsim.errors import RecordingError
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, Simulation
from robotteamsim.view.recorder import FrameRecorder, Recording


def record_mission(scenario: Scenario) -> tuple[Recording, Result]:
    """Simulate a mission; return its recording and its result."""
    simulation = Simulation(scenario)
    recorder = FrameRecorder(simulation)
    return recorder.recording, simulation.run([recorder])


def repeat_mission(scenario: Scenario, trajectory_hash: str, place: str) -> Recording:
    """Simulate a mission again and return its recording.

    Args:   trajectory_hash: of the first time. place: where it is stored, for the error.
    Raises: RecordingError: the trajectories differ.
    """
    recording, result = record_mission(scenario)
    if result.trajectory_hash != trajectory_hash:
        raise RecordingError(
            f"{place}: this version computes another mission (trajectory hash {result.trajectory_hash[:8]}.. instead "
            f"of {trajectory_hash[:8]}..), so it cannot be shown; a bag of it can"
        )
    return recording

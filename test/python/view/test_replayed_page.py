"""A bag or an MCAP file has the totals of its mission, and its page shows what that of the mission itself shows."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from robotteamsim.analysis.runs.totals import RunTotals, run_totals
from robotteamsim.recording import BagWriter
from robotteamsim.recording.mcap_writer import McapWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation
from robotteamsim.view.from_bag import recording_of
from robotteamsim.view.recorder import FrameRecorder

GPS = "{kind: gps, name: gps, datum_lat_deg: 40.2, datum_lon_deg: -8.4}"
SENSORS = f"[{{kind: sonar, name: front}}, {GPS}, {{kind: laser, name: rear}}]"
LEVELS = Path(__file__).parents[2] / "data" / "scenarios" / "two_levels.yaml"
CASES = {
    "warehouse_push": ["mission.time_limit_s=25"],  # objects
    "office_fire": ["mission.time_limit_s=30"],  # people who flee, doors, smoke
    "garage_rescue": ["mission.time_limit_s=40"],  # firefighters
    "office_manet": ["mission.time_limit_s=15"],  # links by distance
    "office_egress": ["mission.time_limit_s=20"],  # no robots
    "garage_sar": ["mission.time_limit_s=60", "robots.count=6", "control.algorithm=dpso"],  # several swarms
    str(LEVELS): [],
    "tutorial_arena": [f"robots.sensors={SENSORS}", "mission.time_limit_s=10"],
}
"""Scenarios, and what is different."""


def _plain(shown: Any) -> Any:
    """Return what is shown as nested tuples; numbers to 1e-5, because quaternions and float32 have rounded them."""
    if isinstance(shown, float):
        return round(shown, 5) + 0.0
    if isinstance(shown, msgspec.Struct):
        return tuple(_plain(getattr(shown, name)) for name in shown.__struct_fields__)
    if isinstance(shown, np.ndarray):
        return _plain(shown.tolist())
    if is_dataclass(shown):
        return tuple(_plain(getattr(shown, one.name)) for one in fields(shown))
    if isinstance(shown, list | tuple):
        return tuple(map(_plain, shown))
    return shown


def _check_totals(found: RunTotals, expected: Result) -> None:
    """Check that the totals of a recording are those of its mission, to the bit."""
    assert found.mission is not None
    for total in fields(found.mission):
        assert getattr(found.mission, total.name) == getattr(expected, total.name), total.name
    for robot, of_mission in zip(found.robots, expected.robots, strict=True):
        for total in ("distance_m", "contact_s", "excluded_s"):
            assert getattr(robot, total) == getattr(of_mission, total), (robot.name, total)
    assert found.egress == expected.egress
    assert found.trajectory_hash == (expected.trajectory_hash if expected.robots else None)
    assert found.omitted == found.gaps == found.notes == ()


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_totals_and_page_of_a_recording_are_those_of_the_mission(name: str, tmp_path: Path):
    scenario = load(name, CASES[name])
    simulation = Simulation(scenario)
    live, files = FrameRecorder(simulation.setup), [tmp_path / "a.bag", tmp_path / "a.mcap"]
    result = simulation.run([live, BagWriter(files[0]), McapWriter(files[1])])
    expected = live.recording
    for path in files:
        run = read_run([path])
        _check_totals(run_totals(run), result)
        found = recording_of(run, scenario)
        assert len(found.frames) == len(expected.frames)
        for frame, expected_frame in zip(found.frames, expected.frames, strict=True):
            for part in frame.__struct_fields__:
                assert _plain(getattr(frame, part)) == _plain(getattr(expected_frame, part)), (frame.time_s, part)
        for layer in ("events", "voice", "radio", "fire", "smoke"):
            assert _plain(getattr(found, layer)) == _plain(getattr(expected, layer)), layer
        for part in ("solids", "doors", "areas", "objects", "exits", "bays", "bounds", "victim_states", "has_fire"):
            assert _plain(getattr(found.scene, part)) == _plain(getattr(expected.scene, part)), part

"""People are shown as they are: lying once they have collapsed, and not fleeing while no path to an exit is open."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.recording import BagWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.scenario.people import People, PeopleGroup
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.victims import Region
from robotteamsim.simulation import Simulation
from robotteamsim.view.frame import Frame
from robotteamsim.view.from_bag import recording_of
from robotteamsim.view.recorder import FrameRecorder

pytestmark = pytest.mark.slow

_OPENS_S = 4.0


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    """A hall with a closed door before the exit; bob could walk, but collapses before the firefighter reaches him."""
    walls = {
        "south": [[0, 0.1], [30, 0.1]],
        "north": [[0, 9.9], [30, 9.9]],
        "west": [[0.1, 0.2], [0.1, 9.8]],
        "east": [[29.9, 0.2], [29.9, 9.8]],
        "middle_south": [[15, 0.2], [15, 4]],
        "middle_north": [[15, 6], [15, 9.8]],
    }
    return from_mapping(
        {
            "name": "hall",
            "plan": {
                "name": "hall",
                "bounds": {"min": [0, 0], "max": [30, 10]},
                "walls": [{"name": name, "from": a, "to": b, "thickness_m": 0.2} for name, (a, b) in walls.items()],
                "doors": [{"name": "door", "from": [15, 4], "to": [15, 6], "thickness_m": 0.2, "closed": True}],
            },
            "robots": {"count": 1, "start": [4.0, 8.0, 0.0]},
            "command_centre": [1.5, 5.0],
            "firefighters": {"count": 1, "start": [3.0, 5.0, 0.0]},
            "control": {"algorithm": "cover"},
            "mission": {
                "saved_by": "firefighter",
                "exits": [{"name": "west", "center": [1.5, 8.5]}],
                "victims": [
                    {"name": "bob", "position": [8.0, 2.0], "can_walk": True},
                    {"name": "eve", "position": [28.0, 8.0], "flees": True, "calling": False},
                ],
                "rescue": {"pick_up_s": 2.0},
                "time_limit_s": 40.0,
            },
            "schedule": [{"at_s": _OPENS_S, "door": "door", "closed": False}],
            "fire": {
                "fuel": [{"name": "pile", "center": [12.0, 4.0], "radius_m": 1.0, "growth": "ultra_fast"}],
                "ignitions": [{"position": [12.0, 4.0]}],
                "casualties": {"collapse_dose": 1e-9},
            },
        },
        "hall.yaml",
    )


def _gaits(frames: list[Frame], victim: int) -> dict[str, set[str]]:
    """Return how a victim was shown to move, by state."""
    found: dict[str, set[str]] = {}
    for frame in frames:
        if frame.victims:
            shown = frame.victims[victim]
            found.setdefault(shown.state, set()).add(shown.gait)
    return found


def test_recordings_and_bags_show_collapsed_and_enclosed_people(scenario: Scenario, tmp_path: Path) -> None:
    simulation = Simulation(scenario)
    recorder = FrameRecorder(simulation.setup)
    simulation.run([recorder, BagWriter(tmp_path / "hall.bag")])
    paths = [tmp_path / "hall.bag"]
    for frames in (recorder.recording.frames, recording_of(read_run(paths), scenario).frames):
        bob = _gaits(frames, 0)
        assert bob["collapsed"] == bob["reached"] == bob["carried"] == {"lies"}
        eve = {(frame.time_s < _OPENS_S, frame.victims[1].gait) for frame in frames if 0.5 < frame.time_s < 8.0}
        assert (True, "walks") in eve
        assert (True, "flees") not in eve
        assert (False, "flees") in eve


def test_people_of_a_group_flee_in_a_recording_and_in_a_bag(scenario: Scenario, tmp_path: Path) -> None:
    group = PeopleGroup(name="guest", count=2, region=Region(center=(26.0, 3.0), radius_m=2.0))
    mission = scenario.mission.model_copy(update={"victims": (), "time_limit_s": 6.0})
    guests = scenario.model_copy(update={"mission": mission, "people": People(groups=(group,))})
    simulation = Simulation(guests)
    recorder = FrameRecorder(simulation.setup)
    simulation.run([recorder, BagWriter(tmp_path / "guests.bag")])
    paths = [tmp_path / "guests.bag"]
    for frames in (recorder.recording.frames, recording_of(read_run(paths), guests).frames):
        assert [(victim.name, victim.state) for victim in frames[-1].victims] == [
            ("guest_1", "fleeing"),
            ("guest_2", "fleeing"),
        ]

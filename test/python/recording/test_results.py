from __future__ import annotations

import json
import os
import resource
import subprocess
import sys

import pytest

import robotteamsim
from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter, ResultWriter, result_summary
from robotteamsim.recording.files import write_atomically
from robotteamsim.scenario.scenario import Scenario


@pytest.fixture
def document(trial, tmp_path) -> dict:
    trial.play(ResultWriter(tmp_path), steps=5)
    return json.loads((tmp_path / "mission.json").read_text())


def test_mission_json_has_result_events_versions_and_scenario(document):
    assert list(document) == ["result", "events", "versions", "scenario"]


def test_result_describes_the_trial(document, trial):
    result = document["result"]
    assert result["trajectory_hash"] == "ab" * 32
    assert (result["end"], result["time_s"], result["seed"]) == ("time_limit", 0.5, 1)
    assert (result["areas_explored"], result["victims_saved"], result["endangered_links"]) == (0, 1, 1)
    assert result["robots"][1] == {"distance_m": 2.0, "contact_s": 0.5, "excluded_s": 1.0, "longest_stay_s": 0.2}
    assert result == result_summary(trial.result(5))


def test_every_event_is_reported(document):
    assert document["events"] == [
        {
            "time_s": 0.3,
            "kind": "victim_saved",
            "subject": "ann",
            "robot_id": 1,
            "detail": "robot 1 saves ann (1 of 2)",
        }
    ]


def test_versions_name_package_python_and_libraries(document):
    assert document["versions"]["robotteamsim"] == robotteamsim.__version__
    assert {"python", "numpy", "rosbags"} <= set(document["versions"])


def test_scenario_in_mission_json_repeats_the_trial(document, trial):
    assert Scenario.model_validate_json(json.dumps(document["scenario"])) == trial.scenario


def test_broken_off_trial_leaves_no_result(trial, tmp_path):
    writer = ResultWriter(tmp_path)
    writer.begin(trial.setup)
    writer.step(trial.record(3))
    writer.abandon()
    assert os.listdir(tmp_path) == []


def test_folder_that_cannot_be_created_is_rejected_at_the_beginning(trial, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(RecordingError, match="file/out: cannot be written: Not a directory"):
        ResultWriter(tmp_path / "file" / "out").begin(trial.setup)


@pytest.mark.slow
def test_full_disk_keeps_the_old_file_whole(tmp_path):
    path = tmp_path / "mission.json"
    write_atomically(path, "old")
    code = (
        "import sys; from pathlib import Path; from robotteamsim.recording.files import write_atomically;"
        "write_atomically(Path(sys.argv[1]), 'new' * 10_000)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)),
    )
    assert f"RecordingError: {path}: cannot be written: File too large" in done.stderr
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["mission.json"]


@pytest.mark.parametrize("name", ["m.txt", "m.bag", "m.mcap"])
def test_file_is_on_the_disk_before_it_has_its_name_and_its_name_after(trial, tmp_path, monkeypatch, name):
    path, synced, fsync = tmp_path / name, [], os.fsync

    def record(descriptor: int) -> None:
        fsync(descriptor)
        there = os.fstat(descriptor)
        synced.append((there.st_ino, there.st_size, path.exists()))

    monkeypatch.setattr(os, "fsync", record)
    if name == "m.txt":
        write_atomically(path, "new")
    else:
        trial.play({"m.bag": BagWriter, "m.mcap": McapWriter}[name](path), steps=2)
    file, folder = path.stat(), tmp_path.stat()
    assert synced[0] == (file.st_ino, file.st_size, False)
    assert [(inode, named) for inode, _, named in synced[1:]] == [(folder.st_ino, True)]

"""`robotteamsim view`: pages of scenarios, folders and bags; mistakes in one line."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from robotteamsim.cli import main

_SHORT = ["--set", "mission.time_limit_s=5"]


def test_page_of_a_scenario_is_one_file_of_at_most_two_megabytes(tmp_path: Path) -> None:
    page = tmp_path / "mission.html"
    assert main(["view", "garage_sar", *_SHORT, "--html", str(page)]) == 0
    assert page.stat().st_size < 2_000_000
    assert "http://" not in page.read_text(encoding="utf-8").replace("http://www.w3.org", "")


def test_folder_of_a_run_is_shown_and_one_of_another_version_is_rejected(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, page = tmp_path / "out", tmp_path / "mission.html"
    assert main(["run", "garage_sar", *_SHORT, "--quiet", "--seed", "5", "--out", str(folder)]) == 0
    assert main(["view", str(folder), "--html", str(page)]) == 0
    assert "garage_sar, seed 5" in page.read_text(encoding="utf-8")
    path = folder / "mission.json"
    document = json.loads(path.read_text(encoding="utf-8"))
    document["result"]["trajectory_hash"] = "0" * 64
    path.write_text(json.dumps(document), encoding="utf-8")
    capsys.readouterr()
    assert main(["view", str(folder), "--html", str(page)]) == 2
    assert "computes another mission" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["none.bag"], "none.bag: cannot be read"),
        (["none"], "no shipped scenario"),
        (["."], "mission.json: cannot be read"),
        (["garage_sar", "--noise", "x"], "'x' is not a number"),
        (["garage_sar", "--port", "70000"], "--port 70000 is outside 0 to 65535"),
        (["garage_sar", "--host", "192.0.2.7"], "host 192.0.2.7, port 0: Cannot assign requested address"),
        (["garage_sar", "--speed", "0"], "not above 0"),
        (["garage_sar", "--speed", "2000"], "--speed 2000 is outside 0.001 to 1000"),
        (["garage_sar", "--speed", "1e-300"], "--speed 1e-300 is outside 0.001 to 1000"),
        (["garage_sar", "--speed", "0.0009"], "--speed 0.0009 is outside 0.001 to 1000"),
        (
            ["garage_sar", "--scenario", "office_manet"],
            "--scenario office_manet: only allowed for bags; got garage_sar",
        ),
        (["one.bag", "--seed", "5"], "--seed: has no effect on recordings: one.bag"),
        (["one.bag", "--set", "run.seed=5"], "--set: has no effect on recordings: one.bag"),
        (["garage_sar", "--html", "."], "is a folder"),
        (["garage_sar", "--compare", "none.bag", "--html", "x.html"], "none.bag: cannot be read"),
    ],
)
def test_a_mistake_gives_one_line(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["view", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_mission_that_is_no_text_is_one_line(capsys, tmp_path):
    (tmp_path / "mission.json").write_bytes(b'{"scenario": {"name": "\xff"}}')
    assert main(["view", str(tmp_path), "--html", str(tmp_path / "o.html")]) == 2
    line = f"robotteamsim: {tmp_path}/mission.json: is not a mission.json of `run --out`: "
    assert capsys.readouterr().err.startswith(line)


def test_damaged_mission_is_one_line_with_the_key(capsys, tmp_path):
    (tmp_path / "mission.json").write_text('{"scenario": {}, "result": {"trajectory_hash": 3}}')
    assert main(["view", str(tmp_path), "--html", str(tmp_path / "o.html")]) == 2
    assert capsys.readouterr().err.endswith("Expected `str`, got `int` - at `$.result.trajectory_hash`\n")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "status", "said"), [(signal.SIGTERM, 143, "terminated"), (signal.SIGINT, 130, "interrupted")]
)
def test_live_viewer_ends_with_the_status_of_its_signal(number, status, said):
    words = (sys.executable, "-c", "import sys; from robotteamsim.cli import main; sys.exit(main())", "view")
    command = (*words, "tutorial_arena", "--no-browser")
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as viewer:
        assert viewer.stdout is not None
        assert viewer.stdout.readline().startswith("http://127.0.0.1:")
        viewer.send_signal(number)
        _, error = viewer.communicate(timeout=60.0)
    assert (viewer.returncode, error) == (status, f"robotteamsim: {said}\n")

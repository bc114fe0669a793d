"""`robotteamsim campaign`."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from robotteamsim.campaign import read_store
from robotteamsim.cli import campaign_command, main
from robotteamsim.scenario.controllers import ALGORITHMS

SHORT = ("--set", "mission.time_limit_s=1")
KNOWN = f"expected one of: {', '.join(ALGORITHMS)}, module:Class, or policy.pt"
NOISE = ("--noise", "10", "--noise", "20")


@pytest.fixture
def on_two_workers(two_workers, monkeypatch):
    """Let the command use the workers that are there already."""
    monkeypatch.setattr(campaign_command, "local_workers", lambda count, most: contextlib.nullcontext(two_workers))


@pytest.mark.slow
def test_campaign_ends_with_a_row_per_cell_and_the_file_of_its_trials(capsys, tmp_path, on_two_workers):
    assert main(["campaign", "garage_sar", *NOISE, "--trials", "2", *SHORT, "--out", str(tmp_path / "c")]) == 0
    captured = capsys.readouterr()
    assert captured.out.startswith("Mean, standard deviation, 95 % interval of the mean\n")
    rows = [line.split()[:2] for line in captured.out.splitlines() if line[:1].isdigit()]
    assert rows[:2] == [["10.0", "2"], ["20.0", "2"]]
    assert captured.out.endswith(f"\nwritten {tmp_path}/c/trials.csv\n")
    *progress, end = captured.err.splitlines()
    # On a busy machine there are more lines between the two.
    assert (progress[0], progress[-1]) == ("garage_sar: 4 trials", "4 of 4 trials, 0 s left")
    minutes = sum(outcome.time_s for outcome in read_store(tmp_path / "c").outcomes) / 60.0
    assert end.startswith(f"4 trials, {minutes:.1f} min of missions, in ")
    assert len((tmp_path / "c" / "trials.csv").read_text().splitlines()) == 5


@pytest.mark.slow
def test_finished_campaign_only_prints_its_tables_again(capsys, tmp_path, monkeypatch, on_two_workers):
    command = ["campaign", "tutorial_arena", "--sweep", "control.alpha=0.3,0.5", "--trials", "2", *SHORT]
    command += ["--out", str(tmp_path)]
    assert main(command) == 0
    first, csv = capsys.readouterr().out, (tmp_path / "trials.csv").read_bytes()
    monkeypatch.setattr(campaign_command, "local_workers", None)
    assert main(command) == 0
    again = capsys.readouterr()
    assert (again.out, again.err) == (first, "")
    assert (tmp_path / "trials.csv").read_bytes() == csv
    assert first.startswith("Mean, standard deviation, 95 % interval of the mean\n")


@pytest.mark.slow
def test_json_and_quiet(capsys, tmp_path, on_two_workers):
    command = ["campaign", "tutorial_arena", *NOISE, "--trials", "1", *SHORT, "--out", str(tmp_path)]
    assert main([*command, "--quiet"]) == 0
    captured = capsys.readouterr()
    assert captured.out == captured.err == ""
    assert main([*command, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [cell["settings"] for cell in document["cells"]] == [{"voice.noise_db": 10.0}, {"voice.noise_db": 20.0}]
    assert document["cells"][0]["statistics"]["time_s"] == {"mean": 1.0, "sd": None, "low": None, "high": None}
    assert (document["failed"], document["given_up"]) == ([], [])


def test_design_file_and_options_make_one_design(capsys, tmp_path, on_two_workers):
    design = tmp_path / "design.yaml"
    design.write_text(
        "trials: 5\nseed: 3\nset: {mission.time_limit_s: 1}\nsweep: {voice.noise_db: [10]}\n"
        "cells:\n  - {control.algorithm: random_walk}\n  - {control.alpha: 0.5}\n"
    )
    command = ["campaign", "tutorial_arena", "--design", str(design), "--trials", "1", "--sweep", "robots.count=1,2"]
    assert main([*command, "--quiet", "--out", str(tmp_path / "c")]) == 0
    settings = read_store(tmp_path / "c").settings
    assert (settings["trials"], settings["seed"]) == (1, 3)
    assert settings["keys"] == ["control.algorithm", "control.alpha", "voice.noise_db", "robots.count"]
    assert settings["cells"] == [
        [algorithm, alpha, 10.0, count]
        for algorithm, alpha in (("random_walk", None), ("rdpso", 0.5))
        for count in (1, 2)
    ]


def test_paired_campaign_gives_its_cells_the_same_seeds_and_knows_its_command(capsys, tmp_path, on_two_workers):
    arguments = ["tutorial_arena", "--sweep", "control.algorithm=rdpso,random_walk", *SHORT, "--trials", "2"]
    assert main(["campaign", *arguments, "--paired", "--out", str(tmp_path), "--quiet"]) == 0
    stored = read_store(tmp_path)
    seeds = [[outcome.seed for outcome in stored.outcomes if outcome.cell == cell] for cell in (0, 1)]
    assert seeds[0] == seeds[1]
    assert stored.command == (
        "robotteamsim campaign tutorial_arena --sweep control.algorithm=rdpso,random_walk --set mission.time_limit_s=1 "
        "--trials 2 --seed 1 --paired --out DIR"
    )


def test_failed_trials_are_reported_and_the_rest_runs(capsys, tmp_path, monkeypatch, failed_outcome_of, outcome_of):
    def run(design, trials, keep):
        for trial in trials[:-1]:
            keep(failed_outcome_of(trial) if trial.number == 1 else outcome_of(trial))
        return (trials[-1],)

    workers = SimpleNamespace(run=run)
    monkeypatch.setattr(campaign_command, "local_workers", lambda count, most: contextlib.nullcontext(workers))
    assert main(["campaign", "tutorial_arena", "--trials", "3", "--out", str(tmp_path)]) == 1
    captured = capsys.readouterr()
    failed, good = read_store(tmp_path).outcomes
    assert not good.failed
    lines = captured.err.splitlines()
    assert lines[-2] == f"robotteamsim: trial 1 of cell 0 (seed {failed.seed}) failed: KeyError: 7"
    assert lines[-1].startswith("robotteamsim: trial 3 of cell 0 (seed ")
    assert lines[-1].endswith(") killed its workers; not stored")
    assert "1 + 1 failed" in captured.out


def test_long_error_of_a_trial_is_printed_with_its_place_in_the_code(capsys, tmp_path, monkeypatch, failed_outcome_of):
    long = f"SensorError: robot 0, sensor others (kind neighbours): {300 * 'x'}\x1b (neighbours.py:30)"

    def run(design, trials, keep):
        keep(dataclasses.replace(failed_outcome_of(trials[0]), error=long))
        return ()

    workers = SimpleNamespace(run=run)
    monkeypatch.setattr(campaign_command, "local_workers", lambda count, most: contextlib.nullcontext(workers))
    assert main(["campaign", "tutorial_arena", "--trials", "1", "--out", str(tmp_path)]) == 1
    line = capsys.readouterr().err.splitlines()[-1]
    assert "failed: SensorError: robot 0, sensor others (kind neighbours): xx" in line
    assert line.endswith("x\\x1b (neighbours.py:30)")
    assert len(line) < 300


@pytest.mark.parametrize(
    ("count", "messages"), [(0, ["tls://x:1 has no workers yet; missions start when workers connect"]), (1, [])]
)
def test_cluster_without_workers_gives_a_message(capsys, tmp_path, monkeypatch, outcome_of, count, messages):
    def run(design, trials, keep):
        for trial in trials:
            keep(outcome_of(trial))
        return ()

    cluster = SimpleNamespace(run=run, count=count)
    monkeypatch.setattr(campaign_command, "scheduler_at", lambda address: contextlib.nullcontext(cluster))
    command = ["campaign", "tutorial_arena", "--trials", "2", "--out", str(tmp_path), "--scheduler", "tls://x:1"]
    assert main(command) == 0
    assert capsys.readouterr().err.splitlines()[:-1] == [
        "tutorial_arena: 2 trials",
        *messages,
        "2 of 2 trials, 0 s left",
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (["--trials", "0"], "--trials: 0 is below 1"),
        (["--trials", "few"], "argument --trials: 'few' is not a whole number (see `robotteamsim campaign --help`)"),
        (["--workers", "0"], "argument --workers: 0 is not above 0 (see `robotteamsim campaign --help`)"),
        (["--sweep", "control.alfa=1,2"], "--sweep: control.alfa: unknown key; did you mean 'alpha'?"),
        (["--noise", "1e9"], "--noise: voice.noise_db: 1000000000.0 is above 80"),
        (["--set", "control.alpha=2"], "--set: control.alpha: 2 is above 1"),
        (["--set", "control.alpha"], "--set: 'control.alpha' is not of the form KEY=VALUE, such as voice.noise_db=20"),
        (
            ["--set", "control.algorithm=rdspo"],
            f"--set: control.algorithm: 'rdspo' is not known; {KNOWN}; did you mean 'rdpso'?",
        ),
        (
            ["--sweep", "control.algorithm=rdpso,nowhere:Class"],
            "--sweep: control.algorithm: 'nowhere:Class': ModuleNotFoundError: No module named 'nowhere'; "
            "is its folder in PYTHONPATH?",
        ),
        (
            ["--sweep", "control.algorithm=rdpso,builtins:slice"],
            "--sweep: control.algorithm: 'builtins:slice' makes a builtins.slice, "
            "which has no step(observation, inbox, task)",
        ),
        (["--design", "none.yaml"], "none.yaml: there is no such file"),
        (
            ["--workers", "2", "--scheduler", "tcp://x:1"],
            "argument --scheduler: not allowed with argument --workers (see `robotteamsim campaign --help`)",
        ),
        (["--scheduler", "tcp://127.0.0.1:9"], None),
    ],
)
def test_mistakes_end_in_one_line_and_leave_nothing(refusal, tmp_path, arguments, wanted):
    line = refusal("campaign", "garage_sar", "--out", str(tmp_path / "c"), *arguments)
    assert line == wanted if wanted else line.startswith("tcp://127.0.0.1:9: no scheduler answers: ")
    assert os.listdir(tmp_path) == []


def test_wrong_value_in_a_design_file_is_named_with_the_file(refusal, tmp_path):
    design = tmp_path / "d.yaml"
    design.write_text("sweep: {control.alpha: [0.5, 7]}\n")
    line = refusal("campaign", "garage_sar", "--out", str(tmp_path / "c"), "--design", str(design))
    assert line == f"{design}: control.alpha: 7 is above 1"


@pytest.mark.slow
def test_interrupted_campaign_completes_later(tmp_path):
    command = [sys.executable, "-m", "robotteamsim.cli", "campaign", "garage_sar", *NOISE]
    command += ["--trials", "20", "--workers", "2", "--set", "mission.time_limit_s=20", "--quiet", "--out"]
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
    options["preexec_fn"] = _heed_interrupts
    with subprocess.Popen([*command, str(tmp_path / "c")], **options) as process:
        _wait_for_rows(process, tmp_path / "c", 3)
        os.killpg(process.pid, signal.SIGINT)  # As a terminal does: the workers get it, too.
        out, err = process.communicate(timeout=60)
    lines = err.splitlines()
    kept = len(read_store(tmp_path / "c").outcomes)
    assert (process.returncode, out) == (130, "")
    assert lines == [
        f"robotteamsim: {kept} of 40 trials are stored in {tmp_path}/c; run the same command to resume",
        "robotteamsim: interrupted",
    ]
    for folder in ("c", "undisturbed"):
        subprocess.run([*command, str(tmp_path / folder)], check=True, timeout=120)
    assert (tmp_path / "c" / "trials.csv").read_bytes() == (tmp_path / "undisturbed" / "trials.csv").read_bytes()


def _heed_interrupts() -> None:
    """What a shell starts in the background, and its children, ignore them."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _wait_for_rows(process: subprocess.Popen[str], folder: Path, count: int) -> None:
    """Wait until the store of a running campaign holds that many trials; it fails when the campaign has ended."""
    while process.poll() is None:
        if (folder / "campaign.sqlite").exists() and len(read_store(folder).outcomes) >= count:
            return
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=0.05)
    pytest.fail(f"the campaign ended too early: {process.communicate()}")


@pytest.mark.skipif(sys.platform == "win32", reason="needs ulimit")
def test_too_few_open_files_for_the_workers_are_one_line(tmp_path):
    command = f"{sys.executable} -m robotteamsim.cli campaign tutorial_arena --workers 20 --out {tmp_path}/c"
    shell = ["bash", "-c", f"ulimit -n 24; {command} --quiet"]
    done = subprocess.run(shell, capture_output=True, text=True, check=False, timeout=60)
    line = "robotteamsim: workers cannot be started: Too many open files\n"
    assert (done.returncode, done.stderr) == (2, line)

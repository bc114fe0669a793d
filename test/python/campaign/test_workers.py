"""Trials on worker processes of this machine; the two are shared, so no test may end them."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import time

import psutil
import pytest

import robotteamsim
from robotteamsim.campaign import open_store, run_trial
from robotteamsim.campaign.workers import local_workers
from robotteamsim.errors import CampaignError


def export(folder, design, workers) -> bytes:
    """Run what the store of a folder lacks and return its table."""
    with open_store(folder, design) as store:
        assert workers.run(design, store.missing(), store.keep) == ()
        return store.export().read_bytes()


@pytest.fixture(scope="module")
def one_worker():
    with local_workers(1) as workers:
        yield workers


@pytest.mark.slow
def test_one_and_two_workers_give_the_same_bytes(short_design, two_workers, one_worker, tmp_path):
    design = short_design("voice.noise_db=10,20", trials=3)
    assert (two_workers.count, one_worker.count) == (2, 1)
    assert export(tmp_path / "2", design, two_workers) == export(tmp_path / "1", design, one_worker)


@pytest.mark.slow
def test_workers_and_this_process_give_equal_results(short_design, two_workers, tmp_path):
    design = short_design("voice.noise_db=10,20")
    export(tmp_path, design, two_workers)
    with open_store(tmp_path, design) as store:
        for outcome, trial in zip(
            store.outcomes(), sorted(design.all_trials(), key=lambda t: (t.cell, t.number)), strict=True
        ):
            here = run_trial(design.cells[trial.cell].scenario, trial, "0.1.0")
            assert (outcome.trajectory_hash, outcome.details) == (here.trajectory_hash, here.details)
            assert outcome.paths == here.paths


@pytest.mark.slow
def test_only_missing_trials_run(short_design, two_workers, outcome_of, tmp_path):
    design = short_design("voice.noise_db=10,20")
    with open_store(tmp_path, design) as store:
        trials = store.missing()
        store.keep(outcome_of(trials[1], trajectory_hash="kept"))
        assert two_workers.run(design, store.missing(), store.keep) == ()
        hashes = [outcome.trajectory_hash for outcome in store.outcomes()]
    assert hashes.count("kept") == 1
    assert len(set(hashes)) == 4


SPYING = """
import multiprocessing
import os
import signal

import robotteamsim


class Spy:
    # Says in its error what its process is like.
    def __init__(self, robot_id, scenario):
        threads = [os.environ[name] for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")]
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ())
        if multiprocessing.parent_process() is not None:
            raise RuntimeError(f"{threads} {sorted(map(int, blocked))}")


    def step(self, observation, inbox, task):
        return robotteamsim.Decision()


class Interrupting(Spy):
    def __init__(self, robot_id, scenario):
        if multiprocessing.parent_process() is not None:
            raise KeyboardInterrupt


class Endless(Spy):
    def __init__(self, robot_id, scenario):
        while multiprocessing.parent_process() is not None:
            pass


class Deadly(Spy):
    def __init__(self, robot_id, scenario):
        is_worker = multiprocessing.parent_process() is not None
        if is_worker and scenario.run.seed % 2 == int(os.environ["DEADLY_IN"]):
            os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture
def spying(tmp_path, monkeypatch):
    """Make controllers that look at their process, or kill it, known to workers that are started from now on."""
    (tmp_path / "spying_of_test.py").write_text(SPYING)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("DEADLY_IN", "2")


@pytest.mark.slow
def test_workers_have_one_thread_each_and_leave_interrupts_to_the_campaign(short_design, spying, monkeypatch):
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.setenv(name, "2")
    design, kept = short_design("control.algorithm=spying_of_test:Spy"), []
    with local_workers(1) as workers:
        assert workers.run(design, list(design.all_trials())[:1], kept.append) == ()
    blocked = sorted((int(signal.SIGINT), int(signal.SIGHUP)))
    assert f"['1', '1', '1'] {blocked}" in kept[0].error + kept[0].controller_failed
    assert os.environ["OMP_NUM_THREADS"] == "2"


@pytest.mark.slow
def test_trials_of_a_killed_worker_run_again_on_another_worker(short_design, two_workers, tmp_path):
    design = short_design("voice.noise_db=10,20", trials=6)
    with open_store(tmp_path / "killed", design) as store:

        def keep_and_kill(outcome):
            store.keep(outcome)
            if len(store.outcomes()) in (2, 5):
                for child in psutil.Process().children():
                    with contextlib.suppress(psutil.Error):  # it has just ended
                        if "spawn_main" in " ".join(child.cmdline()):
                            child.kill()

        assert two_workers.run(design, store.missing(), keep_and_kill) == ()
        killed = store.export().read_bytes()
    assert killed == export(tmp_path / "undisturbed", design, two_workers)


@pytest.mark.slow
@pytest.mark.parametrize("deadly", [0, 1])
def test_trial_that_kills_its_workers_is_given_up_and_the_others_go_on(short_design, spying, monkeypatch, deadly):
    monkeypatch.setenv("DEADLY_IN", str(deadly))
    design, kept = short_design("control.algorithm=spying_of_test:Deadly", trials=6), []
    trials = list(design.all_trials())
    with local_workers(2) as workers:
        given_up = workers.run(design, trials, kept.append)
    assert set(given_up) == {trial for trial in trials if trial.seed % 2 == deadly}
    assert {outcome.number for outcome in kept} == {trial.number for trial in trials if trial.seed % 2 != deadly}


@pytest.mark.slow
def test_what_keep_raises_ends_the_run_and_the_workers_can_be_used_again(short_design, two_workers):
    design = short_design(trials=4)

    def full(outcome):
        raise OSError("the disk is full")

    with pytest.raises(OSError, match="the disk is full"):
        two_workers.run(design, list(design.all_trials()), full)
    kept = []
    assert two_workers.run(design, list(design.all_trials()), kept.append) == ()
    assert sorted(outcome.number for outcome in kept) == [1, 2, 3, 4]


@pytest.mark.slow
def test_worker_of_another_version_ends_the_campaign(short_design, two_workers, monkeypatch):
    monkeypatch.setattr(robotteamsim, "__version__", "9.9")
    design = short_design()
    with pytest.raises(CampaignError, match=r"^a worker has robotteamsim 0\.1\.0, expected 9\.9$"):
        two_workers.run(design, list(design.all_trials()), lambda outcome: None)


@pytest.mark.slow
def test_workers_that_die_at_once_are_reported(short_design, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/bin/false")
    multiprocessing.set_executable("/bin/false")
    try:
        with local_workers(2) as workers, pytest.raises(CampaignError, match="they die at once"):
            workers.run(short_design(), list(short_design().all_trials()), lambda outcome: None)
    finally:
        monkeypatch.undo()
        multiprocessing.set_executable(sys.executable)


@pytest.mark.slow
def test_controller_that_interrupts_fails_its_trial(short_design, spying):
    design, kept = short_design("control.algorithm=spying_of_test:Interrupting"), []
    with local_workers(1) as workers:
        assert workers.run(design, list(design.all_trials()), kept.append) == ()
    assert [outcome.error for outcome in kept] == ["KeyboardInterrupt"] * 2


@pytest.mark.slow
def test_workers_end_with_a_campaign_that_is_killed(spying, tmp_path):
    command = [
        sys.executable,
        "-m",
        "robotteamsim.cli",
        "campaign",
        "tutorial_arena",
        "--trials",
        "2",
        "--workers",
        "2",
    ]
    command += ["--set", "control.algorithm=spying_of_test:Endless", "--quiet", "--out", str(tmp_path / "c")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", "")))}
    with psutil.Popen(command, env=environment) as campaign:
        deadline_s = time.monotonic() + 60.0
        while len(busy := [one for one in campaign.children() if one.cpu_times().user > 2.0]) < 2:
            assert time.monotonic() < deadline_s
            time.sleep(0.2)
        campaign.kill()
    _, left = psutil.wait_procs(busy, timeout=30)
    assert left == []


@pytest.mark.slow
def test_no_more_workers_than_needed_are_started():
    with local_workers(8, most=1) as workers:
        assert workers.count == 1

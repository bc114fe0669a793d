"""Trials on worker processes; the cluster of two is shared, so no test may end it."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys

import pytest

from robotteamsim.campaign import open_store, run_trial
from robotteamsim.campaign import runner as runner_module
from robotteamsim.campaign.runner import run_trials, scheduler_at
from robotteamsim.errors import CampaignError


def export(folder, design, client) -> bytes:
    """Run what the store of a folder lacks and return its table."""
    with open_store(folder, design) as store:
        assert run_trials(client, design, store.missing(), store.keep) == ()
        return store.export().read_bytes()


@pytest.fixture(scope="module")
def one_worker():
    with runner_module.local_workers(1) as client:
        yield client


@pytest.mark.slow
def test_one_and_two_workers_give_the_same_bytes(short_design, two_workers, one_worker, tmp_path):
    design = short_design("voice.noise_db=10,20", trials=3)
    assert len(two_workers.ncores()) == 2
    assert export(tmp_path / "2", design, two_workers) == export(tmp_path / "1", design, one_worker)


@pytest.mark.slow
def test_dask_prints_nothing_while_local_workers_run():
    program = (
        "import logging\n"
        "from robotteamsim.campaign.runner import local_workers\n"
        "with local_workers(1):\n"
        "    logging.getLogger('distributed.scheduler').critical('Closed comm')\n"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert (run.stdout, run.stderr) == ("", "")


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


def test_workers_have_one_thread_each(two_workers):
    def threads(name):
        return os.environ.get(name)

    assert set(two_workers.ncores().values()) == {1}
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        assert set(two_workers.run(threads, name).values()) == {"1"}


@pytest.mark.slow
def test_trials_of_a_killed_worker_run_again_on_another_worker(short_design, two_workers, tmp_path):
    design = short_design("voice.noise_db=10,20", trials=6)
    pids = list(two_workers.run(os.getpid).values())
    with open_store(tmp_path / "killed", design) as store:

        def keep_and_kill(outcome):
            store.keep(outcome)
            if len(store.outcomes()) in (2, 5) and pids:
                os.kill(pids.pop(), signal.SIGKILL)

        assert run_trials(two_workers, design, store.missing(), keep_and_kill) == ()
        assert pids == []
        killed = store.export().read_bytes()
    assert killed == export(tmp_path / "undisturbed", design, two_workers)


@pytest.mark.slow
def test_only_missing_trials_run(short_design, two_workers, outcome_of, tmp_path):
    design = short_design("voice.noise_db=10,20")
    with open_store(tmp_path, design) as store:
        trials = store.missing()
        store.keep(outcome_of(trials[1], trajectory_hash="kept"))
        assert run_trials(two_workers, design, store.missing(), store.keep) == ()
        hashes = [outcome.trajectory_hash for outcome in store.outcomes()]
    assert hashes.count("kept") == 1
    assert len(set(hashes)) == 4


def test_trial_that_kills_every_worker_is_given_up_and_the_others_go_on(short_design, outcome_of, monkeypatch):
    from distributed import KilledWorker

    class Future:
        def __init__(self, trial):
            self.trial = trial

        def result(self):
            if self.trial.number == 1:
                raise KilledWorker("trial", None, 20)
            return outcome_of(self.trial)

    outcomes = [runner_module.completed_outcome(Future(trial)) for trial in short_design().all_trials()]
    assert [outcome and outcome.number for outcome in outcomes] == [None, 2]


def test_lost_scheduler_is_reported_in_one_line():
    from distributed.client import FutureCancelledError

    class Future:
        def result(self):
            raise FutureCancelledError("trial", "scheduler-connection-lost")

    with pytest.raises(CampaignError, match="the connection to the scheduler was lost; run the same"):
        runner_module.completed_outcome(Future())


@pytest.mark.slow
def test_more_trials_than_are_in_flight_at_once_all_run(short_design, two_workers, monkeypatch):
    monkeypatch.setattr(runner_module, "MIN_IN_FLIGHT", 1)
    monkeypatch.setattr(two_workers, "ncores", dict)
    design, kept = short_design(trials=4), []
    assert run_trials(two_workers, design, list(design.all_trials()), kept.append) == ()
    assert sorted(outcome.number for outcome in kept) == [1, 2, 3, 4]


@pytest.mark.slow
def test_worker_of_another_version_ends_the_campaign(short_design, two_workers, monkeypatch):
    monkeypatch.setattr(runner_module.robotteamsim, "__version__", "9.9")
    design = short_design()
    with pytest.raises(CampaignError, match=r"^a worker has robotteamsim 0\.1\.0, expected 9\.9$"):
        run_trials(two_workers, design, list(design.all_trials()), lambda outcome: None)


@pytest.mark.slow
def test_scheduler_of_an_address_is_used(short_design, two_workers, tmp_path):
    design = short_design("voice.noise_db=10,20")
    with scheduler_at(two_workers.scheduler.address) as client:
        there = export(tmp_path / "there", design, client)
    assert there == export(tmp_path / "here", design, two_workers)


def test_scheduler_that_does_not_answer_is_rejected(monkeypatch):
    monkeypatch.setattr(runner_module, "CONNECT_TIMEOUT_S", 0.2)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(CampaignError, match=f"^{address}: no scheduler answers: "), scheduler_at(address):
            pass


@pytest.mark.slow
@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "udp://127.0.0.1:9", "127.0.0.1:x", "nonsense"])
def test_address_of_no_scheduler_is_rejected_in_one_line(address, monkeypatch):
    monkeypatch.setattr(runner_module, "CONNECT_TIMEOUT_S", 0.2)
    with pytest.raises(CampaignError) as raised, scheduler_at(address):
        pass
    assert str(raised.value).startswith(f"{address}: no scheduler answers: ")
    assert "\n" not in str(raised.value)


@pytest.mark.slow
def test_a_damaged_configuration_of_dask_is_one_line(tmp_path):
    (tmp_path / "dask.yaml").write_text("a: [")
    command = "from robotteamsim.campaign.runner import local_workers; local_workers(1).__enter__()"
    environment = os.environ | {"DASK_CONFIG": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", command], env=environment, capture_output=True, text=True)
    last = done.stderr.splitlines()[-1]
    assert last.startswith("robotteamsim.errors.CampaignError: A dask config file at")
    assert "dask.yaml" in last

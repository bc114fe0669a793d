"""A cluster of processes of their own, as on several machines: one scheduler, two workers, the command."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from robotteamsim import _core
from robotteamsim.campaign import cluster as cluster_module
from robotteamsim.campaign.cluster import Cluster, scheduler_at
from robotteamsim.errors import CampaignError

START_TIMEOUT_S = 600
END_TIMEOUT_S = 60


@contextlib.contextmanager
def process(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a Python module in a process that is ended at the end; it finds the package where this one has."""
    place = str(Path(_core.__file__).parents[1])
    path = os.pathsep.join([place, *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "PYTHONPATH": path, "OMP_NUM_THREADS": "1"}
    with subprocess.Popen(
        [sys.executable, "-m", *arguments], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as started:
        try:
            yield started
        finally:
            started.terminate()
            try:
                started.wait(END_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                started.kill()


@pytest.fixture
def cluster(tmp_path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Give the address of a scheduler and the processes of its two workers."""
    from distributed import Client

    file = str(tmp_path / "scheduler.json")
    scheduler = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    worker = ["distributed.cli.dask_worker", "--scheduler-file", file, "--nthreads", "1", "--no-nanny"]
    worker += ["--local-directory", str(tmp_path), "--no-dashboard"]
    with contextlib.ExitStack() as stack:
        stack.enter_context(process(*scheduler, "--scheduler-file", file))
        workers = [stack.enter_context(process(*worker)) for _ in range(2)]
        # The client waits for the file, then for the workers.
        with Client(scheduler_file=file, timeout=START_TIMEOUT_S) as client:
            client.wait_for_workers(2, timeout=START_TIMEOUT_S)
            address = client.scheduler.address
        yield address, workers


def campaign(folder: Path, *options: str) -> None:
    """Run a campaign by its command. Raises: CalledProcessError: it failed."""
    arguments = ["tutorial_arena", "--noise", "10", "--noise", "20", "--trials", "3", "--set", "mission.time_limit_s=1"]
    subprocess.run(
        [sys.executable, "-m", "robotteamsim.cli", "campaign", *arguments, "--quiet", "--out", str(folder), *options],
        check=True,
        timeout=START_TIMEOUT_S,
    )


@pytest.mark.slow
def test_two_worker_cluster_gives_the_bytes_of_this_machine_and_outlives_a_worker(cluster, tmp_path):
    address, workers = cluster
    campaign(tmp_path / "here", "--workers", "1")
    campaign(tmp_path / "there", "--scheduler", address)
    workers[0].kill()
    workers[0].wait()
    campaign(tmp_path / "left", "--scheduler", address)
    wanted = (tmp_path / "here" / "trials.csv").read_bytes()
    assert len(wanted.splitlines()) == 7
    assert (tmp_path / "there" / "trials.csv").read_bytes() == wanted
    assert (tmp_path / "left" / "trials.csv").read_bytes() == wanted


@pytest.mark.slow
def test_more_trials_than_are_in_flight_at_once_all_run(cluster, short_design, monkeypatch):
    monkeypatch.setattr(cluster_module, "MIN_IN_FLIGHT", 1)
    monkeypatch.setattr(Cluster, "count", 0)
    design, kept = short_design(trials=4), []
    with scheduler_at(cluster[0]) as workers:
        assert workers.run(design, list(design.all_trials()), kept.append) == ()
    assert sorted(outcome.number for outcome in kept) == [1, 2, 3, 4]


def test_trial_that_kills_every_worker_is_given_up_and_the_others_go_on(short_design, outcome_of, monkeypatch):
    from distributed import KilledWorker

    class Future:
        def __init__(self, trial):
            self.trial = trial

        def result(self):
            if self.trial.number == 1:
                raise KilledWorker("trial", None, 20)
            return outcome_of(self.trial)

    outcomes = [cluster_module.completed_outcome(Future(trial)) for trial in short_design().all_trials()]
    assert [outcome and outcome.number for outcome in outcomes] == [None, 2]


def test_lost_scheduler_is_reported_in_one_line():
    from distributed.client import FutureCancelledError

    class Future:
        def result(self):
            raise FutureCancelledError("trial", "scheduler-connection-lost")

    with pytest.raises(CampaignError, match="the connection to the scheduler was lost; run the same"):
        cluster_module.completed_outcome(Future())


def test_scheduler_that_does_not_answer_is_rejected(monkeypatch):
    monkeypatch.setattr(cluster_module, "CONNECT_TIMEOUT_S", 0.2)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(CampaignError, match=f"^{address}: no scheduler answers: "), scheduler_at(address):
            pass


@pytest.mark.slow
@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "udp://127.0.0.1:9", "127.0.0.1:x", "nonsense"])
def test_address_of_no_scheduler_is_rejected_in_one_line(address, monkeypatch):
    monkeypatch.setattr(cluster_module, "CONNECT_TIMEOUT_S", 0.2)
    with pytest.raises(CampaignError) as raised, scheduler_at(address):
        pass
    assert str(raised.value).startswith(f"{address}: no scheduler answers: ")
    assert "\n" not in str(raised.value)


@pytest.mark.slow
def test_a_damaged_configuration_of_dask_is_one_line(tmp_path):
    (tmp_path / "dask.yaml").write_text("a: [")
    command = "from robotteamsim.campaign.cluster import scheduler_at; scheduler_at('tcp://127.0.0.1:9').__enter__()"
    environment = os.environ | {"DASK_CONFIG": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", command], env=environment, capture_output=True, text=True)
    last = done.stderr.splitlines()[-1]
    assert last.startswith("robotteamsim.errors.CampaignError: A dask config file at")
    assert "dask.yaml" in last

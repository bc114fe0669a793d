"""A cluster of processes of their own, as on several machines: one scheduler, two workers, the command."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from robotteamsim import _core

pytestmark = pytest.mark.slow

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

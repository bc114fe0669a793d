"""Runs trials on the workers of a Dask cluster: processes of this machine, or a scheduler's."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import logging
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from types import ModuleType
from typing import TYPE_CHECKING

import robotteamsim
from robotteamsim.campaign.design import Design, Trial
from robotteamsim.campaign.trial import Outcome, run_trial
from robotteamsim.errors import CampaignError
from robotteamsim.wording import counted

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster

CONNECT_TIMEOUT_S = 5
MIN_IN_FLIGHT = 100
_NOTHING = logging.CRITICAL + 1
"""A level without messages: Dask's scheduler calls it critical that an interrupted client has closed its connection."""
_FILES, _FILES_PER_WORKER = 30, 10
"""Open files that a campaign needs, and each worker in addition, with some to spare: 35 were seen with one worker."""
_START_ATTEMPTS = 5
_REPLACE_EVERY_MS = 2000
_RESTART_CHECKS = 5
"""After this many checks with too few workers, the missing ones are not about to restart."""

# A trial whose worker dies moves to another worker. After this many deaths it is given up.
_ALLOWED_DEATHS = 20

_LOCAL_SETTINGS = {
    "distributed.scheduler.allowed-failures": _ALLOWED_DEATHS,
    "distributed.worker.profile.enabled": False,
    "distributed.diagnostics.nvml": False,
    "distributed.admin.tick.limit": "1h",  # Silence lag warnings; load is expected.
    # Dask's self-monitoring, many times a second in every process, would slow down the trials.
    "distributed.admin.tick.interval": "2s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.admin.system-monitor.gil.enabled": False,
}
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@contextlib.contextmanager
def local_workers(count: int | None = None) -> Iterator[Client]:
    """Start worker processes on this machine, and stop them at the end.

    Args:   count: of workers, each with one thread; None: one per core that this process may use.
    Raises: CampaignError: they cannot be started.
    """
    distributed = _distributed()
    import dask

    count = count or len(os.sched_getaffinity(0))
    _check_open_files(count)
    with dask.config.set(_LOCAL_SETTINGS):
        with _interrupts_kept_from_children():
            cluster = _start_cluster(count)
        with cluster, _dead_workers_replaced(cluster, count), distributed.Client(cluster) as client:
            yield client


def _distributed() -> ModuleType:
    """Return Dask's package, which is slow to import. Raises: CampaignError: a configuration file of Dask is wrong."""
    try:
        import distributed
    except ValueError as error:
        raise CampaignError(" ".join(str(error).split())) from None
    return distributed


def _check_open_files(count: int) -> None:
    """Raises: CampaignError: this process may open fewer files than a cluster needs; Dask would wait without an end."""
    if sys.platform == "win32":
        return
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = _FILES + _FILES_PER_WORKER * count
    if limit != resource.RLIM_INFINITY and limit < needed:
        workers = counted(count, "worker")
        raise CampaignError(f"{workers}: {needed} open files are needed, {limit} are allowed; raise `ulimit -n`")


def _start_cluster(count: int) -> LocalCluster:
    """Return a cluster on this machine. Raises: CampaignError: its workers died repeatedly while starting."""
    from distributed import LocalCluster

    for attempt in range(_START_ATTEMPTS):
        try:
            return LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                processes=True,
                memory_limit=0,
                dashboard_address="127.0.0.1:0",  # Any free port: the default one may be in use.
                silence_logs=_NOTHING,
                env=_ONE_THREAD,
            )
        except RuntimeError as error:
            if attempt + 1 == _START_ATTEMPTS:
                raise CampaignError(f"workers cannot be started: {_line(error.__cause__ or error)}") from error
    raise AssertionError("unreachable")


@contextlib.contextmanager
def _dead_workers_replaced(cluster: LocalCluster, count: int) -> Iterator[None]:
    """Keep the number of workers constant. Dask restarts a dead worker, but not one that died while it restarted."""
    from tornado.ioloop import PeriodicCallback

    checks_with_too_few = 0

    def replace() -> None:
        nonlocal checks_with_too_few
        running = len(cluster.scheduler_info["workers"])
        checks_with_too_few = checks_with_too_few + 1 if running < count else 0
        if checks_with_too_few == _RESTART_CHECKS:
            checks_with_too_few = 0
            cluster.scale(running)  # Forgets those that do not run.
            cluster.scale(count)

    loop, every = cluster.loop, PeriodicCallback(replace, _REPLACE_EVERY_MS)
    assert loop is not None
    loop.add_callback(every.start)
    try:
        yield
    finally:
        loop.add_callback(every.stop)


@contextlib.contextmanager
def _interrupts_kept_from_children() -> Iterator[None]:
    """Block Ctrl-C and SIGHUP in threads and processes that are started here, and in their children.

    This thread handles them. A terminal sends them to all processes, and workers would print tracebacks, or end first.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    former = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
    # Starts Python's resource tracker, which unblocks Ctrl-C: later it would do so in a thread of Dask.
    multiprocessing.get_context("spawn").Lock()
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, former)


@contextlib.contextmanager
def scheduler_at(address: str) -> Iterator[Client]:
    """Connect to a scheduler such as tcp://10.0.0.1:8786, and disconnect at the end.

    Raises: CampaignError: no Dask scheduler answers within 5 s.
    """
    distributed = _distributed()
    # It logs the loss of a scheduler, which we report ourselves.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        # Client would wait forever for a server that accepts the connection but does not answer.
        asyncio.run(asyncio.wait_for(_shake_hands(address), CONNECT_TIMEOUT_S))
        client = distributed.Client(address, timeout=CONNECT_TIMEOUT_S)
    except Exception as error:  # Another kind of server may cause any exception.
        raise CampaignError(f"{address}: no scheduler answers: {_line(error)}") from None
    with client:
        yield client


async def _shake_hands(address: str) -> None:
    from distributed import Security, connect

    # The certificates of TLS, from Dask's own settings.
    secured = Security().get_connection_args("client")
    comm = await connect(address, timeout=CONNECT_TIMEOUT_S, **secured)
    await comm.close()


def run_trials(
    client: Client, design: Design, trials: Sequence[Trial], keep: Callable[[Outcome], None]
) -> tuple[Trial, ...]:
    """Run trials on a client's workers, in any order, and give each outcome to `keep` in this thread.

    Returns: the trials that were given up because their workers died repeatedly.
    Raises:  CampaignError: the scheduler is lost, or a worker cannot run trials, for example with another version.
    """
    from distributed import as_completed

    waiting = iter(trials)
    running: dict[Future[Outcome], Trial] = {}
    given_up: list[Trial] = []
    pending = as_completed(loop=client.loop)  # The default client would be the newest one.

    def submit(count: int) -> None:
        for trial in itertools.islice(waiting, count):
            scenario = design.cells[trial.cell].scenario
            # Impure: with a new key, so that a cluster does not reuse results of an older version.
            future = client.submit(run_trial, scenario, trial, robotteamsim.__version__, pure=False)
            running[future] = trial
            pending.add(future)

    # Enough that no worker waits, but not all, because each is sent with its scenario.
    submit(max(MIN_IN_FLIGHT, 4 * sum(client.ncores().values())))
    try:
        for future in pending:
            trial = running.pop(future)
            outcome = completed_outcome(future)
            if outcome is None:
                given_up.append(trial)
            else:
                keep(outcome)
            submit(1)
    finally:
        client.cancel(list(running))
    return tuple(given_up)


def completed_outcome(future: Future[Outcome]) -> Outcome | None:
    """Return the outcome of a trial that ended; None: its workers died. Raises: CampaignError, as `run_trials`."""
    from distributed import KilledWorker

    try:
        # Waits again if a worker died before it returned the result.
        outcome: Outcome = future.result()
        return outcome
    except KilledWorker:
        return None
    except CampaignError:
        raise
    except (CancelledError, OSError):
        raise CampaignError("the connection to the scheduler was lost; run the same command to resume") from None
    except Exception as error:
        # Exceptions in a trial are in its outcome; this one is from the worker, for example if the package is missing.
        raise CampaignError(f"a worker cannot run trials: {type(error).__name__}: {_line(error)}") from error


def _line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__

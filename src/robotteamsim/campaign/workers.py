"""Runs trials on worker processes of this machine."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import traceback
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from typing import Protocol

import robotteamsim
from robotteamsim.campaign.design import Design, Trial
from robotteamsim.campaign.trial import Outcome, run_trial
from robotteamsim.errors import CampaignError

MOST_DEATHS = 5
"""A trial whose worker dies runs again on another one; after so many deaths it is given up."""
_START_ATTEMPTS = 5
"""So many workers in a row may die before they are ready."""
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

_SPAWN = multiprocessing.get_context("spawn")


class Workers(Protocol):
    """Processes that run trials, here or on a cluster."""

    @property
    def count(self) -> int:
        """How many there are now."""

    def run(self, design: Design, trials: Sequence[Trial], keep: Callable[[Outcome], None]) -> tuple[Trial, ...]:
        """Run trials, in any order, and give each outcome to `keep` in this thread.

        Returns: the trials that were given up because their workers died repeatedly.
        Raises:  CampaignError: trials cannot be run.
        """


class _Worker:
    """A process, and the trial that it runs; None: it is starting, or it waits."""

    def __init__(self) -> None:
        self.connection, others = _SPAWN.Pipe()
        self.trial: Trial | None = None
        self.is_ready = False
        with others, _interrupts_kept_from_children(), _variables(_ONE_THREAD):
            self._process = _SPAWN.Process(target=_work, args=(others,), daemon=True)
            self._process.start()

    def give(self, design: Design, trial: Trial) -> None:
        """Let it run a trial. A worker that has died is seen when its answer is read."""
        self.trial = trial
        with contextlib.suppress(OSError):
            self.connection.send((design.cells[trial.cell].scenario, trial, robotteamsim.__version__))

    def end(self) -> None:
        """End the process, which has nothing to lose."""
        self.connection.close()
        self._process.kill()
        self._process.join()
        self._process.close()


class LocalWorkers:
    """Worker processes of this machine; see `Workers`. One that dies is replaced."""

    def __init__(self, count: int) -> None:
        """Start them."""
        self.count = count
        self._workers: list[_Worker] = []
        try:
            self._fill()
        except BaseException:
            self.close()
            raise

    def run(self, design: Design, trials: Sequence[Trial], keep: Callable[[Outcome], None]) -> tuple[Trial, ...]:
        """As for all workers. Raises: CampaignError: workers die while they start, or one cannot run trials."""
        self._fill()
        waiting, given_up = deque(trials), []
        deaths, failed_starts, num_left = Counter[Trial](), 0, len(trials)
        try:
            while num_left:
                for worker in self._workers:
                    if worker.is_ready and worker.trial is None and waiting:
                        worker.give(design, waiting.popleft())
                answered = wait([worker.connection for worker in self._workers])
                for worker in [one for one in self._workers if one.connection in answered]:
                    try:
                        answer = worker.connection.recv()
                    except (EOFError, OSError):  # it has died
                        self._remove(worker)
                        self._fill()
                        if (trial := worker.trial) is None:
                            failed_starts += not worker.is_ready
                        elif deaths[trial] + 1 == MOST_DEATHS:
                            given_up.append(trial)
                            num_left -= 1
                        else:
                            deaths[trial] += 1
                            waiting.appendleft(trial)
                        if failed_starts == _START_ATTEMPTS:
                            raise CampaignError("workers cannot be started: they die at once") from None
                        continue
                    if isinstance(answer, CampaignError):
                        raise answer
                    if answer is None:
                        worker.is_ready, failed_starts = True, 0
                    else:
                        worker.trial = None
                        num_left -= 1
                        keep(answer)
        finally:
            for worker in [one for one in self._workers if one.trial is not None]:
                self._remove(worker)  # nobody waits for its answer
        return tuple(given_up)

    def close(self) -> None:
        """End all."""
        for worker in self._workers:
            worker.end()

    def _fill(self) -> None:
        """Start workers in place of those that were removed."""
        while len(self._workers) < self.count:
            self._workers.append(_Worker())

    def _remove(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.end()


@contextlib.contextmanager
def local_workers(count: int | None = None, most: int | None = None) -> Iterator[LocalWorkers]:
    """Start worker processes on this machine, and end them at the end.

    Args:   count: of workers, each with one thread; None: one per core that this process may use.
            most: more are not needed.
    Raises: CampaignError: they cannot be started.
    """
    count = count or len(os.sched_getaffinity(0))
    try:
        workers = LocalWorkers(count if most is None else min(count, most))
    except OSError as error:
        raise CampaignError(f"workers cannot be started: {error.strerror or error}") from None
    with contextlib.closing(workers):
        yield workers


def _work(connection: Connection) -> None:
    """Run the trials that come, until the other end is closed."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    answer: Outcome | CampaignError | None = None
    with contextlib.suppress(EOFError, OSError):
        while True:
            connection.send(answer)
            scenario, trial, version = connection.recv()
            try:
                answer = run_trial(scenario, trial, version)
            except CampaignError as error:
                answer = error
            except KeyboardInterrupt:  # of a controller: Ctrl-C is blocked here
                text = "KeyboardInterrupt"
                answer = Outcome(trial.cell, trial.number, trial.seed, error=text, traceback=traceback.format_exc())


def _end_with_parent() -> None:
    """End this process when its parent has ended, such as a campaign that was killed in the midst of a trial."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


@contextlib.contextmanager
def _variables(values: dict[str, str]) -> Iterator[None]:
    """Set variables of the environment, which children inherit, and restore them."""
    former = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in former.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _interrupts_kept_from_children() -> Iterator[None]:
    """Block Ctrl-C and SIGHUP in processes that are started here, and in their children.

    This thread handles them. A terminal sends them to all processes, and workers would print tracebacks, or end first.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    former = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
    _SPAWN.Lock()  # starts Python's resource tracker, which unblocks Ctrl-C
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, former)

"""Runs trials on the workers of a Dask cluster."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import logging
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from typing import TYPE_CHECKING

import robotteamsim
from robotteamsim.campaign.design import Design, Trial
from robotteamsim.campaign.trial import Outcome, run_trial
from robotteamsim.errors import CampaignError

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT_TIMEOUT_S = 5
MIN_IN_FLIGHT = 100


@contextlib.contextmanager
def scheduler_at(address: str) -> Iterator[Cluster]:
    """Connect to a scheduler such as tcp://10.0.0.1:8786, and disconnect at the end.

    Raises: CampaignError: no Dask scheduler answers within 5 s, or a configuration file of Dask is wrong.
    """
    try:
        import distributed
    except ValueError as error:
        raise CampaignError(" ".join(str(error).split())) from None
    # It logs the loss of a scheduler, which we report ourselves.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        # Client would wait forever for a server that accepts the connection but does not answer.
        asyncio.run(asyncio.wait_for(_shake_hands(address), CONNECT_TIMEOUT_S))
        client = distributed.Client(address, timeout=CONNECT_TIMEOUT_S)
    except Exception as error:  # Another kind of server may cause any exception.
        raise CampaignError(f"{address}: no scheduler answers: {_line(error)}") from None
    with client:
        yield Cluster(client)


async def _shake_hands(address: str) -> None:
    from distributed import Security, connect

    # The certificates of TLS, from Dask's own settings.
    secured = Security().get_connection_args("client")
    comm = await connect(address, timeout=CONNECT_TIMEOUT_S, **secured)
    await comm.close()


class Cluster:
    """The workers of a scheduler; see `Workers`."""

    def __init__(self, client: Client) -> None:
        """Args: client: that is connected to the scheduler."""
        self._client = client

    @property
    def count(self) -> int:
        """As for all workers."""
        return sum(self._client.ncores().values())

    def run(self, design: Design, trials: Sequence[Trial], keep: Callable[[Outcome], None]) -> tuple[Trial, ...]:
        """As for all workers.

        Raises: CampaignError: the scheduler is lost, or a worker cannot run trials, for example with another version.
        """
        from distributed import as_completed

        waiting = iter(trials)
        running: dict[Future[Outcome], Trial] = {}
        given_up: list[Trial] = []
        pending = as_completed(loop=self._client.loop)  # The default client would be the newest one.

        def submit(count: int) -> None:
            for trial in itertools.islice(waiting, count):
                scenario = design.cells[trial.cell].scenario
                # Impure: with a new key, so that a cluster does not reuse results of an older version.
                future = self._client.submit(run_trial, scenario, trial, robotteamsim.__version__, pure=False)
                running[future] = trial
                pending.add(future)

        # Enough that no worker waits, but not all, because each is sent with its scenario.
        submit(max(MIN_IN_FLIGHT, 4 * self.count))
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
            self._client.cancel(list(running))
        return tuple(given_up)


def completed_outcome(future: Future[Outcome]) -> Outcome | None:
    """Return the outcome of a trial that ended; None: its workers died. Raises: CampaignError, as `run`."""
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

"""Runs on a Dask cluster whose workers share the results folder and the source that decides a result.

A worker has as many threads as its machine has cores; each of them computes in a process of its own (`processes.py`),
because two runs in one process would share a simulator.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import uuid4

from move.errors import BadInput
from move.study.processes import Processes
from move.study.provenance import deciding, difference
from move.study.spec import RunSpec

if TYPE_CHECKING:
    from distributed import Client

ANSWER = 10.0  # seconds that a scheduler may take to answer
PATIENCE = 3.0  # seconds that a worker may take to join before one is told that there is none
GONE = "cluster: the scheduler is gone; what is stored stays, and the same command goes on with another"
SAME = "allowed are workers with the same source and versions"
_HERE = Processes()  # of this worker


class UnfitWorker(BadInput):
    """A worker that cannot store what it would compute, or would compute something else."""


class Cluster:
    """The workers of a scheduler, the token by which they know the results folder, and what decides results here."""

    def __init__(self, client: Client, address: str, folder: Path) -> None:
        self.client, self.executor, self.address = client, client.get_executor(pure=False), address
        self.token, self.deciding = folder / f".{uuid4().hex}.probe", deciding()
        self.seen = time.monotonic()  # when there was a worker

    def submit(self, spec: RunSpec, folder: Path) -> Future:
        """Compute and store a run on whichever worker is free."""
        return self.executor.submit(_compute, spec, folder, self.token, self.deciding)

    def trouble(self) -> str:
        """That no worker is there, if so for some seconds.

        Raises:
            BadInput: the scheduler is not there either.
        """
        try:
            if self.client.nthreads():
                self.seen = time.monotonic()
        except OSError as error:
            raise BadInput(GONE) from error
        return "" if time.monotonic() - self.seen < PATIENCE else f"{self.address} has no workers; waiting for one"

    def refuse_unfit_workers(self) -> None:
        """Try on each worker whether it can store a result, and would compute what is computed here, before it does.

        Raises:
            BadInput: one of them cannot.
        """
        answers = self.client.run(_problem, self.token, self.deciding, on_error="return")
        for address, problem in answers.items():
            if isinstance(problem, (TypeError, AttributeError, ImportError)):
                problem = f"it has another version of this package ({problem}); {SAME}"
            if problem is not None:
                raise UnfitWorker(f"cluster: the worker {address}: {problem}")


@contextmanager
def dask_cluster(address: str, folder: Path) -> Iterator[Cluster]:
    """A cluster that shares `folder`; what it has not begun is cancelled at the end of the block.

    Raises:
        BadInput: no scheduler answers at the address, or a worker cannot write to the folder.
    """
    from distributed import Client

    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what goes wrong is said here, in one line
    try:
        asyncio.run(_call(address))
        client = Client(address, timeout=ANSWER)
    except (OSError, ValueError, TypeError) as error:  # dask has a TypeError for tls without certificates
        raise BadInput(f"cluster: no Dask scheduler at {address} ({error}); start one with `dask scheduler`") from error
    cluster = Cluster(client, address, folder)
    try:
        cluster.token.touch()
        cluster.refuse_unfit_workers()
        yield cluster
    finally:
        cluster.token.unlink(missing_ok=True)
        if client.status == "running":
            cluster.executor.shutdown(wait=False)
        with suppress(TimeoutError):  # of a client that still looks for its lost scheduler; its thread ends with us
            client.close(timeout=1)


async def _call(address: str) -> None:
    """See that something answers at the address, before a client starts a thread that waits for it."""
    from distributed.comm import connect

    (await connect(address, timeout=ANSWER)).abort()


def _problem(token: Path, there: dict[str, str]) -> str | None:
    """On a worker: why it cannot store results next to the token, or what else it would compute, in one line.

    Args:
        there: what decides results where they are asked for.
    """
    if differing := difference(there):
        return f"it has {differing}; {SAME}"
    if not token.exists():
        return f"it does not share the folder {token.parent}; allowed are workers that do"
    probe = token.with_suffix(f".{uuid4().hex}.probe")
    try:
        probe.touch()
        probe.unlink()
    except OSError as error:
        return f"it cannot write to {token.parent}: {error.strerror}; allowed are workers that can"
    return None


def _compute(spec: RunSpec, folder: Path, token: Path, there: dict[str, str]) -> str:
    """On a worker: compute and store a run in the process of this thread."""
    if problem := _problem(token, there):
        raise UnfitWorker(f"cluster: a worker: {problem}")
    return _HERE.compute(spec, folder)

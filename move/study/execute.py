"""Runs what is missing of a list of specs, on processes of this machine or on a Dask cluster, and shows how long.

Every run is independent and stores its own result, so Ctrl-C at any time loses at most the runs under way, and those
go on from their last checkpoint when the same command is given again.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)
from rich.table import Column

from move.errors import BadInput
from move.machine import default_workers, one_thread_in_children
from move.paths import RUNS
from move.study.results import Result, check_writable, split
from move.study.run import run_and_report
from move.study.spec import RunSpec

PART_SHARE = {"collect": (0.0, 0.1), "train": (0.1, 0.75), "evaluate": (0.85, 0.15)}  # start and share of a run's time


@contextmanager
def process_pool(workers: int) -> Iterator[Executor]:
    """A pool of fresh processes, one thread each, that take the machine's GPUs in turn."""
    one_thread_in_children()
    context = multiprocessing.get_context("spawn")
    started = context.Value("i", 0)
    executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_begin, initargs=(started,))
    try:
        yield executor
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    executor.shutdown()


def _begin(started: Any) -> None:
    """In a worker: take the next GPU, and end with the parent; `started` counts the workers."""
    with started.get_lock():
        number, started.value = started.value, started.value + 1
    if gpus := torch.cuda.device_count():
        torch.cuda.set_device(number % gpus)
    _end_with_parent()


def _end_with_parent() -> None:
    """End when the process that wants the results is gone, however it went."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def dask_cluster(address: str) -> Iterator[Executor]:
    """The executor of a Dask cluster that shares this folder.

    Raises:
        BadInput: no scheduler answers at the address.
    """
    from distributed import Client

    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise BadInput(f"cluster: no Dask scheduler at {address} ({error}); start one with `dask scheduler`") from error
    with client, client.get_executor() as executor:
        yield executor


def execute(
    specs: list[RunSpec], folder: Path, cluster: str | None = None, workers: int | None = None, quiet: bool = False
) -> tuple[list[Result], list[tuple[RunSpec, str]]]:
    """Compute what is missing of `specs` in `folder`; return all stored results and what is missing still, with why.

    Raises:
        BadInput: a folder that cannot be written, or a cluster that does not answer.
    """
    _, missing = split(specs, folder)
    if missing:
        check_writable(folder)
        todo = list({spec.hash: spec for spec, _ in missing}.values())
        pool = dask_cluster(cluster) if cluster else process_pool(min(len(todo), workers or default_workers()))
        with pool as executor:
            failed = _run_all(executor, todo, folder, quiet)
        there, missing = split(specs, folder)
        return there, [(spec, failed.get(spec.hash, why)) for spec, why in missing]
    return split(specs, folder)


def _run_all(executor: Executor, todo: list[RunSpec], folder: Path, quiet: bool) -> dict[str, str]:
    """Run all of `todo`; return one line of explanation for each run that failed, by its hash."""
    futures = {executor.submit(run_and_report, spec, folder): spec for spec in todo}
    failed: dict[str, str] = {}
    with progress_bars(quiet) as progress:
        whole = progress.add_task(f"{len(todo)} runs", total=len(todo))
        bars = {spec.hash: progress.add_task(spec.label, total=1.0, visible=False) for spec in todo}
        waiting = set(futures)
        while waiting:
            done, waiting = wait(waiting, timeout=1.0, return_when=FIRST_COMPLETED)
            for future in done:
                _finish(future, futures[future], failed, progress, bars)
            for future in waiting:
                _show(futures[future], progress, bars)
            fractions = [progress.tasks[bar].completed for bar in bars.values()]
            progress.update(whole, completed=sum(fractions))
        progress.update(whole, completed=len(todo), refresh=True)
    return failed


def _finish(future: Future, spec: RunSpec, failed: dict[str, str], progress: Progress, bars: dict[str, TaskID]) -> None:
    error = future.exception()
    if error is not None:
        failed[spec.hash] = f"failed: {type(error).__name__}: {' '.join(str(error).split())[:200]}"
        progress.console.print(f"{spec.label}: {failed[spec.hash]}", style="red")
    progress.update(bars[spec.hash], completed=1.0, visible=False)


def _show(spec: RunSpec, progress: Progress, bars: dict[str, TaskID]) -> None:
    """Show how far a run under way is, from the small file that it writes."""
    try:
        part, done, total = (RUNS / spec.hash / "progress").read_text().split()
    except (OSError, ValueError):
        return
    start, share = PART_SHARE[part]
    progress.update(bars[spec.hash], completed=start + share * int(done) / int(total), visible=True,
                    description=f"{spec.label}: {part}")


def progress_bars(quiet: bool) -> Progress:
    """Bars on standard error or in a notebook, of which a narrow page cuts the descriptions alone."""
    columns = (SpinnerColumn(), TaskProgressColumn(), TimeRemainingColumn(elapsed_when_finished=True),
               BarColumn(bar_width=20), TextColumn("{task.description}", table_column=Column(ratio=1, no_wrap=True)))
    return Progress(*columns, console=Console(stderr=True), disable=quiet, refresh_per_second=2,
                    expand=True)

"""Each run in a process of its own, which ends with it and with this one.

MuJoCo's model and the GL context are one a process, and neither gives its memory back; a run that dies costs itself
alone. GL and CUDA do not live on in a fork: on Linux a process is forked from one that has imported what runs need,
but opened neither (`preloaded`), and elsewhere it is spawned.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from itertools import count
from multiprocessing import current_process, get_context, parent_process
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from move.errors import BadInput
from move.machine import load_gl, one_thread_in_children
from move.study.provenance import deciding, difference
from move.study.spec import RunSpec

METHOD = get_context("forkserver") if sys.platform == "linux" else get_context("spawn")
METHOD.set_forkserver_preload(["move.study.preloaded"])


class RunFailed(RuntimeError):
    """A run ended without a result; the message says why in one line."""


def in_one_line(error: BaseException) -> str:
    """What went wrong, after the kind of error where its message was not written for a reader."""
    kind = "" if isinstance(error, (BadInput, RunFailed)) else f"{type(error).__name__}: "
    return f"{kind}{' '.join(str(error).split())[:200]}"


class Processes:
    """The processes under way, each with the number by which it chooses its GPU."""

    def __init__(self) -> None:
        self._lock, self._ended = threading.Lock(), False
        self._running: dict[BaseProcess, int] = {}

    def compute(self, spec: RunSpec, folder: Path) -> str:
        """Compute and store a run in a process of its own, wait for it, and return its hash.

        Raises:
            RunFailed: the run failed, its process died, or `end` was called.
        """
        answer, asked = METHOD.Pipe(duplex=False)
        process = self._start(spec, folder, asked)
        asked.close()
        try:
            problem = answer.recv()
        except EOFError:  # it died
            process.join()
            code = process.exitcode or 0
            cause = signal.Signals(-code).name if code < 0 else f"exit code {code}"
            problem = f"its process died of {cause}; the same command goes on with it"
        process.join()
        with self._lock:
            del self._running[process]
        if problem:
            raise RunFailed(problem)
        return spec.hash

    def _start(self, spec: RunSpec, folder: Path, asked: Connection) -> BaseProcess:
        one_thread_in_children()
        with self._lock:
            if self._ended:
                raise RunFailed("interrupted")
            number = next(free for free in count() if free not in self._running.values())
            process = METHOD.Process(target=_compute, args=(number, asked, spec, folder, deciding()), daemon=True)
            with _children_allowed():
                process.start()
            self._running[process] = number
            return process

    def end(self) -> None:
        """Kill all of them, whatever they do, and start no more."""
        with self._lock:
            self._ended = True
            for process in self._running:
                process.kill()


@contextmanager
def _children_allowed() -> Iterator[None]:
    """Let a daemon start a process, as Dask's workers are; the child ends with it all the same."""
    config: dict[str, Any] = vars(current_process())["_config"]
    daemon = config.pop("daemon", None)
    try:
        yield
    finally:
        if daemon is not None:
            config["daemon"] = daemon


def _end_with_parent() -> None:
    """End this process as soon as the one that asked for it is gone; Ctrl-C is that one's to handle."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _compute(number: int, answer: Connection, spec: RunSpec, folder: Path, there: dict[str, str]) -> None:
    """In the process of a run: compute it, and answer with one line on what went wrong, or nothing.

    Args:
        there: what decides results where the run is asked for.
    """
    _end_with_parent()
    load_gl()
    os.dup2(2, 1)  # what libraries print is not the command's answer
    try:
        if differing := difference(there):
            raise RunFailed(f"its process has {differing}: the source was changed meanwhile")
        import torch

        from move.study.run import run_and_report

        if gpus := torch.cuda.device_count():
            torch.cuda.set_device(number % gpus)
        run_and_report(spec, folder)
    except Exception as error:  # whatever it is, the others go on
        answer.send(in_one_line(error))
    else:
        answer.send("")


class ProcessPool:
    """So many runs at a time, each waited for by a thread."""

    def __init__(self, workers: int) -> None:
        self.processes, self.threads = Processes(), ThreadPoolExecutor(workers)

    def submit(self, spec: RunSpec, folder: Path) -> Future[str]:
        """Compute and store a run as soon as a thread is free."""
        return self.threads.submit(self.processes.compute, spec, folder)

    def trouble(self) -> str:
        """Nothing keeps all runs waiting."""
        return ""

    def __enter__(self) -> ProcessPool:
        return self

    def __exit__(self, *exception: object) -> None:
        self.processes.end()
        self.threads.shutdown(cancel_futures=True)

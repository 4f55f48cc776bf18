"""Runs the notebooks by papermill, with a profile's parameters, and refuses what papermill would only warn about."""

from __future__ import annotations

import gc
import multiprocessing
import os
import re
import signal
import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any
from unittest.mock import patch

from move import paths
from move.errors import BadInput
from move.figures import load, names
from move.figures.page import forked
from move.figures.page.changes import BY_COMMAND, plain
from move.figures.page.parameters import parameters, parts, runs, specs
from move.machine import end_with
from move.study.execute import how_far
from move.study.profiles import Profile

OnProgress = Callable[[list[str], float, int, int], None]
"""Called with the notebooks under way, how many are done (one under way by its runs), and how many of its runs are."""


class NotebookFailed(RuntimeError):
    """A notebook did not run to its end; the message names its executed copy."""


STARTS = 2  # a kernel can lose the race for its ports once
LOOKS = 0.5  # seconds between looks at how far runs are


@dataclass
class Done:
    """A notebook that has ended: its executed copy, or why there is none."""

    name: str
    executed: Path | None = None
    problem: Exception | None = None


@dataclass
class _Worker:
    """A process that executes one notebook."""

    name: str
    process: Any
    answer: Connection
    missing: list[str]


def of_profile(profile: Profile, stored_only: bool = False) -> list[str]:
    """The figures that have something to show in `profile`: not those that ask it for no run.

    With `stored_only` nor those none of whose runs is stored yet.
    """
    def shows(name: str) -> bool:
        stored = (profile.results / f"{run.spec.hash}.json" for run in runs(name, profile))
        return any(path.exists() or not stored_only for path in stored)

    return [name for name in names() if "runs" not in parts(name) or shows(name)]


def run_notebooks(
    asked: Sequence[str], profile: Profile, changes: dict[str, Any] | None = None, stored_only: bool = False,
    on_progress: OnProgress | None = None,
) -> Iterator[Done]:
    """Execute notebooks, each in a fork of this process, and give each as it ends.

    What they import is imported here, once. From stored results as many run at a time as there are cores; what
    computes has all cores for itself. Where forks are not possible, and for a single notebook that computes nothing,
    each runs from here.
    """
    if not forked.POSSIBLE or (stored_only and len(asked) == 1):
        for number, name in enumerate(asked):
            if on_progress:
                on_progress([name], number, 0, 0)
            try:
                yield Done(name, run_notebook(name, profile, changes, stored_only))
            except (NotebookFailed, BadInput) as problem:
                yield Done(name, problem=problem)
        return
    _import_all(asked)
    working: list[_Worker] = []
    waiting, done = deque(asked), 0
    at_once = len(os.sched_getaffinity(0)) if stored_only else 1
    try:
        while waiting or working:
            while waiting and len(working) < at_once:
                working.append(_start(waiting.popleft(), profile, changes, stored_only))
            if on_progress:
                under_way = [how_far(paths.RUNS / run) for worker in working for run in worker.missing]
                so_far = sum(found[1] for found in under_way if found)
                on_progress([worker.name for worker in working], done + (so_far / len(under_way) if under_way else 0),
                            round(so_far), len(under_way))
            ready = wait([worker.answer for worker in working], LOOKS)
            for worker in [worker for worker in working if worker.answer in ready]:
                working.remove(worker)
                done += 1
                yield _ended(worker)
    finally:
        for worker in working:
            worker.process.terminate()
            worker.process.join()


def _import_all(asked: Sequence[str]) -> None:
    """Import what the notebooks and their kernels need, so that forks have it."""
    sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]  # nbformat would build its grammars: 1.5 s
    import ipykernel.kernelapp  # noqa: F401
    import matplotlib.backends.backend_pdf  # noqa: F401
    import pandas.io.formats.style  # noqa: F401
    import papermill  # noqa: F401
    import seaborn  # noqa: F401

    from move.figures.page import make  # noqa: F401

    for name in asked:
        load(name)
    gc.collect()
    gc.freeze()


def _start(name: str, profile: Profile, changes: dict[str, Any] | None, stored_only: bool) -> _Worker:
    receiving, sending = multiprocessing.Pipe(duplex=False)
    fork = multiprocessing.get_context("fork")
    process = fork.Process(target=_work, args=(sending, name, profile, changes, stored_only))
    missing = [] if stored_only else missing_runs(name, profile, changes)
    sys.stdout.flush()
    process.start()
    sending.close()
    return _Worker(name, process, receiving, missing)


def _work(answer: Connection, name: str, profile: Profile, changes: dict[str, Any] | None, stored_only: bool) -> None:
    """In the fork: execute one notebook and say what came of it; Ctrl-C ends its kernel too."""
    parent = multiprocessing.parent_process()
    assert parent is not None and parent.pid is not None
    end_with(parent.pid)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        done = Done(name, run_notebook(name, profile, changes, stored_only))
    except (NotebookFailed, BadInput, OSError) as problem:
        done = Done(name, problem=problem)
    answer.send(done)


def _ended(worker: _Worker) -> Done:
    try:
        done = worker.answer.recv()
    except EOFError:
        done = Done(worker.name, problem=NotebookFailed(f"{worker.name}.ipynb failed: its process was killed"))
    worker.process.join()
    return done


def run_notebook(
    name: str, profile: Profile, changes: dict[str, Any] | None = None, stored_only: bool = False
) -> Path:
    """Execute notebook `name`; the executed copy stays under build/notebooks/.

    With `stored_only` the notebook runs nothing that is missing.

    Raises:
        BadInput: parameters that the notebook does not have, or bad input found inside it.
        NotebookFailed: a cell failed, or the kernel died twice.
    """
    import papermill  # slow to import, so after the names are checked
    from nbclient.exceptions import DeadKernelError
    from papermill.exceptions import PapermillExecutionError

    folder = paths.BUILD / "notebooks" / profile.name
    executed, problem = folder / f"{name}.ipynb", ""
    given = {**plain(parameters(name, profile, changes)), "profile": profile.name}
    manager = {"kernel_manager_class": forked.ForkedKernel} if forked.POSSIBLE else {}
    environment = {BY_COMMAND: "1", **({"MOVE_STORED_ONLY": "1"} if stored_only else {})}
    for _ in range(STARTS):
        try:
            with _replaced_at_the_end(executed) as under_way, patch.dict(os.environ, environment):
                done = papermill.execute_notebook(
                    paths.NOTEBOOKS / f"{name}.ipynb", under_way, given, kernel_name="python3", progress_bar=False,
                    cwd=paths.NOTEBOOKS, extra_arguments=["--log-level=ERROR"], **manager)
        except PapermillExecutionError as error:
            if error.ename in ("BadInput", "ValidationError"):
                raise BadInput(_useful(error.ename, error.evalue)) from error
            reason = " ".join(error.evalue.split())[:300]
            raise NotebookFailed(f"{name}.ipynb failed: {error.ename}: {reason} (see {executed})") from error
        except (DeadKernelError, RuntimeError) as error:
            problem = str(error)
            continue
        if all(cell.execution_count for cell in done.cells if cell.cell_type == "code" and cell.source):
            return executed
        problem = "the kernel died before the last cell"
    raise NotebookFailed(f"{name}.ipynb failed: {problem} (see {executed})")


@contextmanager
def _replaced_at_the_end(executed: Path) -> Iterator[Path]:
    """Where a notebook is executed, cell after cell; what is there becomes `executed` once it ends, however it does."""
    under_way = executed.parent / "under_way" / executed.name
    under_way.parent.mkdir(parents=True, exist_ok=True)
    under_way.unlink(missing_ok=True)
    try:
        yield under_way
    except OSError:  # a full disk, and half a copy
        under_way.unlink(missing_ok=True)
        raise
    finally:
        if under_way.exists():
            os.replace(under_way, executed)


def _useful(kind: str, message: str) -> str:
    """What a reader needs of an error inside a notebook.

    >>> _useful("ValidationError", "1 validation error for A\\nsize\\n  small [type=x, input_value=-4, input_type=int]")
    'size: -4 given; small'
    """
    if kind == "ValidationError" and (found := re.search(
            r"\n(\S+)\n\s+(.*?) \[type=.*?input_value=(.*), input_type", message)):
        return f"{found[1]}: {found[3]} given; {found[2]}"
    return " ".join(message.split())


def missing_runs(name: str, profile: Profile, changes: dict[str, Any] | None) -> list[str]:
    """The hashes of a figure's runs of which no result is stored."""
    found = [spec.hash for spec in specs(name, profile, changes)]
    return [run for run in found if not (profile.results / f"{run}.json").exists()]

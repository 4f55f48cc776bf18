"""Runs what is missing of a list of specs, on processes of this machine or on a Dask cluster, and shows how long.

Every run is independent and stores its own result, so Ctrl-C at any time loses at most the runs under way, and those
go on from their last checkpoint when the same command is given again.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

from filelock import FileLock, Timeout
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
from move.files import HOST, put_away_all_remains, refuse_unwritable
from move.machine import default_workers
from move.paths import RUNS
from move.study.cluster import GONE, Cluster, UnfitWorker, dask_cluster
from move.study.processes import ProcessPool, in_one_line
from move.study.provenance import deciding
from move.study.results import NOT_COMPUTED, Result, set_aside, split
from move.study.spec import RunSpec

PART_SHARE = {"collect": (0.0, 0.1), "train": (0.1, 0.75), "evaluate": (0.85, 0.15)}  # start and share of a run's time


def execute(
    specs: list[RunSpec], folder: Path, cluster: str | None = None, workers: int | None = None, quiet: bool = False
) -> tuple[list[Result], list[tuple[RunSpec, str]]]:
    """Compute what is missing of `specs` in `folder`; return all stored results and what is missing still, with why.

    Raises:
        BadInput: a folder that cannot be written, or into which another process writes results of other source or
            versions; a cluster that does not answer, or whose workers have other ones.
    """
    folder = folder.absolute()
    there, missing = split(specs, folder)
    if not missing:
        return there, missing
    refuse_unwritable(folder / "result.json")
    folder.mkdir(parents=True, exist_ok=True)
    put_away_all_remains(folder)
    todo = list({spec.hash: (spec, why) for spec, why in missing}.values())
    local = min(len(todo), workers or default_workers())
    with only_alike(folder), dask_cluster(cluster, folder) if cluster else ProcessPool(local) as pool:
        failed = _run_all(pool, todo, folder, quiet)
    there, missing = split(specs, folder)
    return there, [(spec, failed.get(spec.hash, why)) for spec, why in missing]


WRITING = re.compile(r"\.([0-9a-f]{16})\.(.+)\.(\d+)\.\w+\.writing")  # source and versions, host, process


@contextmanager
def only_alike(folder: Path) -> Iterator[None]:
    """While the block lasts, say in `folder` by a locked file's name which source and versions compute its results.

    The lock ends with the process that holds it, so that what a killed one leaves counts for nothing.

    Raises:
        BadInput: another process writes there, with other ones.
    """
    own = hashlib.sha256(repr(sorted(deciding().items())).encode()).hexdigest()[:16]
    mark = FileLock(folder / f".{own}.{HOST}.{os.getpid()}.{uuid4().hex[:8]}.writing", mode=0o666)
    with mark:
        try:
            for path in set(folder.glob(".*.writing")) - {Path(mark.lock_file)}:
                if (found := WRITING.fullmatch(path.name)) and _is_held(path) and found[1] != own:
                    raise BadInput(f"results: process {found[3]} of {found[2]} is writing to {folder} with another "
                                   "source or other versions of packages; allowed is a folder of its own, or after it")
            yield
        finally:
            Path(mark.lock_file).unlink(missing_ok=True)


def _is_held(path: Path) -> bool:
    """Whether a process holds a lock; what nobody holds is removed."""
    try:
        with FileLock(path, timeout=0, mode=0o666):
            path.unlink(missing_ok=True)
        return False
    except Timeout:
        return True


def _run_all(
    pool: Cluster | ProcessPool, missing: list[tuple[RunSpec, str]], folder: Path, quiet: bool
) -> dict[str, str]:
    """Run all that is missing; return one line on each run that failed, by its hash."""
    failed: dict[str, str] = {}
    with progress_bars(quiet) as progress:
        _set_aside(missing, folder, progress.console)
        whole = progress.add_task(f"{len(missing)} runs", total=len(missing))
        bars = {spec.hash: progress.add_task(spec.label, total=1.0, visible=False)
                for spec, _ in missing}
        futures = {pool.submit(spec, folder): spec for spec, _ in missing}
        waiting, trouble = set(futures), ""
        while waiting:
            done, waiting = wait(waiting, timeout=1.0, return_when=FIRST_COMPLETED)
            for future in done:
                _finish(future, futures[future], failed, progress, bars)
            for future in waiting:
                _show(futures[future], progress, bars)
            if waiting and trouble != (trouble := pool.trouble()):
                _print(progress.console, trouble or "going on")
            fractions = [progress.tasks[bar].completed for bar in bars.values()]
            progress.update(whole, completed=sum(fractions))
        progress.update(whole, completed=len(missing), refresh=True)
    return failed


def _set_aside(missing: list[tuple[RunSpec, str]], folder: Path, console: Console) -> None:
    """Make place for the runs whose files are not usable, and say so."""
    for spec, why in missing:
        if why != NOT_COMPUTED and (aside := set_aside(spec, folder)):
            _print(console, f"{why}; it is now {aside.name}, and computed anew")


def _finish(future: Future, spec: RunSpec, failed: dict[str, str], progress: Progress, bars: dict[str, TaskID]) -> None:
    try:
        error = future.exception()
    except CancelledError as gone:
        raise BadInput(GONE) from gone
    if isinstance(error, UnfitWorker):
        raise error
    if error is not None:
        failed[spec.hash] = f"failed: {in_one_line(error)}"
        _print(progress.console, f"{spec.label}: {failed[spec.hash]}")
    progress.update(bars[spec.hash], completed=1.0, visible=False)


def _print(console: Console, line: str) -> None:
    console.print(line, style="red", soft_wrap=True, markup=False, highlight=False)


def _show(spec: RunSpec, progress: Progress, bars: dict[str, TaskID]) -> None:
    """Show how far a run under way is."""
    if far := how_far(RUNS / spec.hash):
        part, fraction = far
        progress.update(bars[spec.hash], completed=fraction, visible=True, description=f"{spec.label}: {part}")


def how_far(folder: Path) -> tuple[str, float] | None:
    """Which part a run is at and how much of it all is done, from the small file that it writes; None if there is none.

    Args:
        folder: the run's own, under build/runs.
    """
    try:
        part, done, total = (folder / "progress").read_text().split()
        start, share = PART_SHARE[part]
        return part, start + share * int(done) / int(total)
    except (OSError, ValueError, KeyError, ZeroDivisionError):
        return None


def progress_bars(quiet: bool) -> Progress:
    """Bars on standard error or in a notebook, of which a narrow page cuts the descriptions alone."""
    columns = (SpinnerColumn(), TaskProgressColumn(), TimeRemainingColumn(elapsed_when_finished=True),
               BarColumn(bar_width=20), TextColumn("{task.description}", table_column=Column(ratio=1, no_wrap=True)))
    return Progress(*columns, console=Console(stderr=True), disable=quiet, refresh_per_second=2,
                    expand=True)

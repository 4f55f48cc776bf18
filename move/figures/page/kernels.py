"""Runs the notebooks by papermill, with a profile's parameters, and refuses what papermill would only warn about."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from move import paths
from move.errors import BadInput
from move.figures import names
from move.figures.page.changes import BY_COMMAND
from move.figures.page.parameters import parameters, parts, runs, specs
from move.study.execute import how_far
from move.study.profiles import Profile

OnRuns = Callable[[float, int], None]
"""Called with how many of the missing runs are done, one under way counted in part, and how many there are."""


class NotebookFailed(RuntimeError):
    """A notebook did not run to its end; the message names its executed copy."""


STARTS = 2  # a kernel can lose the race for its ports once


def of_profile(profile: Profile) -> list[str]:
    """The figures that have something to show in `profile`: not those that ask it for no run."""
    return [name for name in names() if "runs" not in parts(name) or runs(name, profile)]


def run_notebook(
    name: str, profile: Profile, changes: dict[str, Any] | None = None, stored_only: bool = False,
    on_runs: OnRuns | None = None,
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
    given = {key: list(value) if isinstance(value, tuple) else value  # a tuple is a text to papermill
             for key, value in {**parameters(name, profile, changes), "profile": profile.name}.items()}
    folder.mkdir(parents=True, exist_ok=True)
    for _ in range(STARTS):
        try:
            with (_environment({BY_COMMAND: "1"} | ({"MOVE_STORED_ONLY": "1"} if stored_only else {})),
                   watched([] if stored_only else _missing(name, profile, changes or {}), on_runs)):
                done = papermill.execute_notebook(
                    paths.NOTEBOOKS / f"{name}.ipynb", executed, given, kernel_name="python3", progress_bar=False,
                    cwd=paths.NOTEBOOKS, extra_arguments=["--log-level=ERROR"])
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


def _useful(kind: str, message: str) -> str:
    """What a reader needs of an error inside a notebook.

    >>> _useful("ValidationError", "1 validation error for A\\nsize\\n  small [type=x, input_value=-4, input_type=int]")
    'size: -4 given; small'
    """
    if kind == "ValidationError" and (found := re.search(
            r"\n(\S+)\n\s+(.*?) \[type=.*?input_value=(.*), input_type", message)):
        return f"{found[1]}: {found[3]} given; {found[2]}"
    return " ".join(message.split())


def _missing(name: str, profile: Profile, changes: dict[str, Any]) -> list[str]:
    """The hashes of the notebook's runs of which no result is stored."""
    folder = paths.results(profile)
    found = dict.fromkeys(spec.hash for spec in specs(name, profile, changes))
    return [run for run in found if not (folder / f"{run}.json").exists()]


@contextmanager
def watched(missing: list[str], on_runs: OnRuns | None) -> Iterator[None]:
    """While the runs of a notebook are computed elsewhere, report once a second how far they are."""
    ended = threading.Event()

    def watch() -> None:
        while missing and on_runs and not ended.wait(1.0):
            under_way = filter(None, map(how_far, (paths.RUNS / run for run in missing)))
            on_runs(sum(fraction for _, fraction in under_way), len(missing))

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


@contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    """For a while, what a kernel started here finds in its environment."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value

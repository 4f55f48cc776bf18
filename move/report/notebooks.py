"""Runs the notebooks by papermill, with a profile's parameters, and refuses what papermill would only warn about."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import papermill
from nbclient.exceptions import DeadKernelError
from papermill.exceptions import PapermillExecutionError

from move import paths
from move.errors import BadInput
from move.report.changes import BY_COMMAND
from move.study.experiments import EXPERIMENTS, runs
from move.study.profiles import Profile


class NotebookFailed(RuntimeError):
    """A notebook did not run to its end; the message names its executed copy."""


STARTS = 2  # a kernel can lose the race for its ports once


def names() -> list[str]:
    """The notebooks that exist, by name; each makes the figure or table of the same name."""
    return sorted(path.stem for path in paths.NOTEBOOKS.glob("*.ipynb"))


def of_profile(profile: Profile) -> list[str]:
    """The notebooks that have something to show in `profile`: not those whose experiment asks it for no run."""
    return [name for name in names() if name not in EXPERIMENTS or runs(name, profile)]


def notebook_parameters(name: str, profile: Profile, changes: dict[str, Any]) -> dict[str, Any]:
    """The profile's parameters for notebook `name`, then `changes`, each known to its parameters cell.

    Raises:
        BadInput: an unknown notebook or parameter.
    """
    if name not in names():
        raise BadInput(f"notebook: {name!r} given; allowed are {', '.join(names())}")
    given = {**profile.parameters(name), **changes, "profile": profile.name}
    known = papermill.inspect_notebook(str(paths.NOTEBOOKS / f"{name}.ipynb"))
    if unknown := set(given) - set(known):
        raise BadInput(f"{name}.ipynb has no parameter {', '.join(sorted(unknown))}; allowed are {', '.join(known)}")
    return given


def run_notebook(
    name: str, profile: Profile, changes: dict[str, Any] | None = None, stored_only: bool = False
) -> Path:
    """Execute notebook `name`; the executed copy stays under build/notebooks/.

    With `stored_only` the notebook runs nothing that is missing.

    Raises:
        BadInput: parameters that the notebook does not have, or bad input found inside it.
        NotebookFailed: a cell failed, or the kernel died twice.
    """
    folder = paths.BUILD / "notebooks" / profile.name
    folder.mkdir(parents=True, exist_ok=True)
    executed, problem = folder / f"{name}.ipynb", ""
    given = notebook_parameters(name, profile, changes or {})
    for _ in range(STARTS):
        try:
            with _environment({BY_COMMAND: "1"} | ({"MOVE_STORED_ONLY": "1"} if stored_only else {})):
                done = papermill.execute_notebook(
                    paths.NOTEBOOKS / f"{name}.ipynb", executed, given, kernel_name="python3", progress_bar=False,
                    cwd=paths.NOTEBOOKS, extra_arguments=["--log-level=ERROR"])
        except PapermillExecutionError as error:
            if error.ename == "BadInput":
                raise BadInput(error.evalue) from error
            raise NotebookFailed(f"{name}.ipynb failed: {error.ename}: {error.evalue} (see {executed})") from error
        except (DeadKernelError, RuntimeError) as error:
            problem = str(error)
            continue
        if all(cell.execution_count for cell in done.cells if cell.cell_type == "code" and cell.source):
            return executed
        problem = "the kernel died before the last cell"
    raise NotebookFailed(f"{name}.ipynb failed: {problem} (see {executed})")


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

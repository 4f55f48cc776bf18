"""Executed copies of the notebooks, for the site: those that were left, where they are of today, else made now.

A notebook is executed as it would be opened, from stored results alone, several at once. A kernel that dies or waits
for what never comes costs its own notebook.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path

import nbformat
import papermill
from nbclient.exceptions import CellTimeoutError, DeadKernelError
from nbformat import NotebookNode

from move import paths
from move.figures.page import changes
from move.study.profiles import load_profile

PROFILE = load_profile("laptop")
EXECUTED = paths.BUILD / "site-notebooks"
TRIES = 2  # a cell's reply can be lost on the way; then its kernel is ended and the notebook executed again
PATIENCE = 900  # seconds that a cell may take: from stored results none takes a tenth of that


def executed_copies(notebooks: list[Path]) -> dict[Path, NotebookNode | str]:
    """Each notebook with its outputs, or why it has none; what has to be executed is, several at once."""
    found: dict[Path, NotebookNode | str | None] = {path: copy_of_today(path) for path in notebooks}
    lacking = [path for path, copy in found.items() if copy is None]
    numbers = count(1)

    def execute(path: Path) -> NotebookNode | str:
        sys.stdout.write(f"make_site: executing {path.stem} ({next(numbers)} of {len(lacking)}) ...\n")
        sys.stdout.flush()
        try:
            return executed_copy(path)
        except Exception as problem:  # of whatever kind: its page says it, and the others go on
            return f"{path.stem}: {type(problem).__name__}: {' '.join(str(problem).split())[-300:]}"

    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:  # each notebook has a process of its own
        executed = dict(zip(lacking, pool.map(execute, lacking), strict=True))
    return {path: executed[path] if copy is None else copy for path, copy in found.items()}


def copy_of_today(path: Path) -> NotebookNode | None:
    """The executed copy that `move figure` or an earlier call left, unless notebook or results have changed since."""
    newest = max((result.stat().st_mtime for result in PROFILE.results.glob("*.json")), default=0)
    for folder in (paths.BUILD / "notebooks" / PROFILE.name, EXECUTED):
        left = folder / path.name
        if left.exists() and left.stat().st_mtime > newest and (copy := read_copy(left)) and is_of_today(
                copy, nbformat.read(path, 4)):
            return copy
    return None


def executed_copy(path: Path) -> NotebookNode:
    """A notebook executed now, as it would be opened, from stored results alone; the copy stays under build/.

    Raises:
        RuntimeError: its kernel died or did not answer as often as it was tried.
    """
    EXECUTED.mkdir(parents=True, exist_ok=True)
    for _ in range(TRIES):
        try:
            done = papermill.execute_notebook(path, EXECUTED / path.name, kernel_name="python3", progress_bar=False,
                                              cwd=path.parent, execution_timeout=PATIENCE)
        except (DeadKernelError, CellTimeoutError):
            continue
        if all(cell.execution_count for cell in done.cells if cell.cell_type == "code" and cell.source):
            return done
    raise RuntimeError(f"its kernel died or did not answer {TRIES} times")


def read_copy(path: Path) -> NotebookNode | None:
    """A notebook that was left; None where it is damaged."""
    try:
        return nbformat.read(path, 4)
    except (ValueError, AttributeError, nbformat.ValidationError):
        return None


def is_of_today(executed: NotebookNode, notebook: NotebookNode) -> bool:
    """Whether an executed copy has the cells of the notebook, all run, under the profile's own parameters."""
    cells = [cell for cell in executed.cells if "injected-parameters" not in cell.metadata.get("tags", [])]
    run_by = executed.metadata.get("papermill", {})
    same = [cell.source for cell in cells] == [cell.source for cell in notebook.cells]
    run = all(cell.execution_count for cell in cells if cell.cell_type == "code" and cell.source)
    name, given = Path(run_by.get("input_path") or "none").stem, run_by.get("parameters", {})
    return same and run and not (given and changes.change(name, PROFILE, given))

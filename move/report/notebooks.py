"""Runs the notebooks by papermill, with a profile's parameters, and refuses what papermill would only warn about."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import papermill
import yaml

from move import paths
from move.errors import BadInput
from move.study.experiments import EXPERIMENTS, specs
from move.study.profiles import load_profile


class NotebookFailed(RuntimeError):
    """A notebook did not run to its end; the message names its executed copy."""


STARTS = 2  # a kernel can lose the race for its ports once


def names() -> list[str]:
    """The notebooks that exist, by name; each makes the figure or table of the same name."""
    return sorted(path.stem for path in paths.NOTEBOOKS.glob("*.ipynb"))


def of_profile(profile: str) -> list[str]:
    """The notebooks that have something to show in `profile`: not those whose experiment asks it for no run."""
    return [name for name in names() if name not in EXPERIMENTS or specs(name, profile)]


def notebook_parameters(name: str, profile: str, changes: dict[str, Any]) -> dict[str, Any]:
    """The profile's parameters for notebook `name`, then `changes`, each known to its parameters cell.

    Raises:
        BadInput: an unknown notebook, profile or parameter.
    """
    if name not in names():
        raise BadInput(f"notebook: {name!r} given; allowed are {', '.join(names())}")
    given = {**load_profile(profile).parameters(name), **changes, "profile": profile}
    known = papermill.inspect_notebook(str(paths.NOTEBOOKS / f"{name}.ipynb"))
    if unknown := set(given) - set(known):
        raise BadInput(f"{name}.ipynb has no parameter {', '.join(sorted(unknown))}; allowed are {', '.join(known)}")
    return given


def run_notebook(
    name: str, profile: str, changes: dict[str, Any] | None = None, stored_only: bool = False
) -> Path:
    """Execute notebook `name`; the executed copy and its log stay under build/notebooks/.

    With `stored_only` the notebook runs nothing that is missing.

    Raises:
        BadInput: parameters that the notebook does not have, or bad input found inside it.
        NotebookFailed: a cell failed, or the kernel died.
    """
    folder = paths.BUILD / "notebooks" / profile
    folder.mkdir(parents=True, exist_ok=True)
    given, executed = folder / f"{name}.yaml", folder / f"{name}.ipynb"
    given.write_text(yaml.safe_dump(notebook_parameters(name, profile, changes or {})))
    command = [sys.executable, "-m", "papermill", "--no-progress-bar", "--log-level", "ERROR", "-k", "python3",
               "--cwd", str(paths.NOTEBOOKS), "-f", str(given), str(paths.NOTEBOOKS / f"{name}.ipynb"), str(executed)]
    done = paths.BUILD / "notebooks" / profile / f"{name}.done"
    done.unlink(missing_ok=True)
    told = {"MOVE_DONE": str(done)} | ({"MOVE_STORED_ONLY": "1"} if stored_only else {})
    for _ in range(STARTS):
        outcome = subprocess.run(command, env={**os.environ, **told}, capture_output=True, text=True)
        if outcome.returncode == 0 and done.exists():
            return executed
        if bad := re.findall(r"^BadInput: (.*)$", outcome.stderr, re.MULTILINE):
            raise BadInput(bad[-1])
        if "Kernel died" not in outcome.stderr:
            break
    (folder / f"{name}.log").write_text(outcome.stderr)
    last = (outcome.stderr.strip().splitlines() or ["no message"])[-1]
    raise NotebookFailed(f"{name}.ipynb failed: {last} (see {executed})")


def finished() -> None:
    """Called by a notebook's last cell: leaves the mark that tells its runner that every cell ran."""
    if mark := os.environ.get("MOVE_DONE"):
        Path(mark).write_text(time.strftime("%Y-%m-%dT%H:%M:%S\n"))

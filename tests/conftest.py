"""What every test shares: one thread, and the notebooks as git has them.

Two test processes with two threads each wait for each other on two cores. And what somebody does to a notebook in the
browser is theirs: tests read the notebooks that are staged or committed (where there is no git, those in the folder).
What is imported stays to the end, so the garbage collector does not look through it again and again.
"""

import gc
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import matplotlib
import pytest

from move import paths
from move.machine import one_thread, one_thread_in_children

OF_ENVIRONMENTS = ("dm_control", "gym_aloha", "gymnasium_robotics", "ogbench", "robosuite", "shimmy")
"""Packages that environment.lock has not: `make test-environments` builds an environment that has them."""
collect_ignore = [] if all(map(find_spec, OF_ENVIRONMENTS)) else ["environments"]

matplotlib.use("Agg")  # no window
sys.modules["rfc3987_syntax"] = None  # nbformat's validator compiles its 38 grammars, for seconds; no test needs them
gc.disable()  # until everything is imported
one_thread_in_children()
one_thread()


def git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=paths.ROOT, capture_output=True, text=True, check=True).stdout


def notebooks_in_git(folder: str) -> Path:
    """A copy of the notebooks in git's index, made in `folder`; the folder's own where there is no git."""
    try:
        listed = git("ls-files", "notebooks").split()
        git("checkout-index", f"--prefix={folder}/", *listed)
    except (OSError, subprocess.CalledProcessError):
        return paths.NOTEBOOKS
    return Path(folder, "notebooks")


kept = tempfile.TemporaryDirectory(prefix="move-notebooks-")
changed_here = paths.NOTEBOOKS
paths.NOTEBOOKS = notebooks_in_git(kept.name)


@pytest.hookimpl
def pytest_report_header() -> str:
    """Say which notebooks differ from what is tested."""
    if paths.NOTEBOOKS == changed_here:
        return "notebooks: those in the folder (no git here)"
    differing = git("diff", "--name-only", "--", "notebooks").split()
    return f"notebooks: as git has them; changed here and not tested: {', '.join(differing) or 'none'}"


@pytest.hookimpl
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that take longest, for a file is one process's: its notebooks are executed once."""
    longest = ("test_planted_truth", "test_tutorial", "test_real_notebook", "test_missing_runs",
               "test_untouched", "test_study", "test_tasks", "test_paper_profile", "test_bad_input", "test_outputs",
               "test_real_checks", "test_cluster", "test_processes", "test_claims")
    order = {name: place for place, name in enumerate(longest)}
    items.sort(key=lambda item: order.get(item.path.stem, len(longest)))


@pytest.hookimpl
def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()

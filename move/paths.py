"""Every folder the package reads or writes; nothing else spells a path.

Notebooks, results and the lock are those of the checkout in which the package is. Installed without one, the package
has its profiles alone, and writes under the folder in which it was started.
"""

from __future__ import annotations

import os
from pathlib import Path

from move.errors import BadInput

VARIABLE = "MOVE_ROOT"  # another checkout's root
PACKAGE = Path(__file__).resolve().parent
IN_CHECKOUT = VARIABLE in os.environ or (PACKAGE.parent / "notebooks").is_dir()
ROOT = Path(os.environ.get(VARIABLE, PACKAGE.parent)) if IN_CHECKOUT else Path.cwd()
PROFILES = (ROOT if IN_CHECKOUT else PACKAGE) / "profiles"
NOTEBOOKS = ROOT / "notebooks"
LOCK = ROOT / "environment.lock"
BUILD = ROOT / "build"
RUNS = BUILD / "runs"  # checkpoints and progress of single runs
REALWORLD = BUILD / "realworld"  # real-robot data: what was fetched, and the simulated sample


def refuse_outside_checkout() -> None:
    """Refuse what needs more than the package.

    Raises:
        BadInput: the package is not in a checkout.
    """
    if not IN_CHECKOUT:
        raise BadInput(f"{PACKAGE}: installed without notebooks, results and lock; this needs a checkout of the "
                       "repository, in which `make setup` installs it (collect, export, train, evaluate and compare "
                       "need none)")


def own_figures(name: str) -> Path:
    """Where figures and tables go that are not shipped: those of a profile, or of a notebook that a reader changed."""
    return BUILD / "figures" / name

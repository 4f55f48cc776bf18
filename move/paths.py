"""Every folder the package reads or writes; nothing else spells a path."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from move.study.profiles import Profile

ROOT = Path(os.environ.get("MOVE_ROOT", Path(__file__).resolve().parent.parent))
PROFILES = ROOT / "profiles"
NOTEBOOKS = ROOT / "notebooks"
LOCK = ROOT / "environment.lock"
BUILD = ROOT / "build"
RUNS = BUILD / "runs"  # checkpoints and progress of single runs
REALWORLD = BUILD / "realworld"  # real-robot data: what was fetched, and the simulated sample


def results(profile: Profile) -> Path:
    """Where a profile's results are: one JSON file a run. A stamped profile's prove nothing and stay out of git."""
    return (BUILD if profile.stamp else ROOT) / "results" / (profile.shares_results or profile.name)


def own_results(profile: Profile) -> Path:
    """Where notebooks store the runs that they compute, so that what is shipped stays as it is."""
    return BUILD / "results" / results(profile).name


def figures(profile: Profile) -> Path:
    """Where a profile's figures and tables go; the shipped ones are in git."""
    return ROOT / "paper_figures" if profile.shipped else own_figures(profile.name)


def own_figures(name: str) -> Path:
    """Where figures and tables go that are not shipped: those of a profile, or of a notebook that a reader changed."""
    return BUILD / "figures" / name

"""Every folder the package reads or writes; nothing else spells a path."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(os.environ.get("MOVE_ROOT", Path(__file__).resolve().parent.parent))
PROFILES = ROOT / "profiles"
NOTEBOOKS = ROOT / "notebooks"
LOCK = ROOT / "environment.lock"
BUILD = ROOT / "build"
RUNS = BUILD / "runs"  # checkpoints and progress of single runs
REALWORLD = BUILD / "realworld"  # real-robot data: what was fetched, and the simulated sample


def results(profile: str) -> Path:
    """Where a profile's results are: one JSON file a run. Smoke results prove nothing and stay out of git."""
    return (BUILD if profile == "smoke" else ROOT) / "results" / profile


def figures(profile: str) -> Path:
    """Where a profile's figures and tables go; the laptop profile's are the ones in git."""
    return ROOT / "paper_figures" if profile == "laptop" else BUILD / "figures" / profile

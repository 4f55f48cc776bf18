"""Where a number came from: versions, processor, GL renderer, commit."""

from __future__ import annotations

import os
import platform
import subprocess
from functools import cache
from importlib.metadata import version

from move.machine import accelerator, gl_renderer, peak_memory_mb, processor
from move.paths import ROOT

PACKAGES = ("metaworld", "mujoco", "gymnasium", "numpy", "torch", "diffusers")


@cache
def commit() -> str:
    """The git commit of this tree, with "+" if the package differs from it; "unknown" outside git."""
    try:
        head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True)
        changed = subprocess.run(["git", "status", "--porcelain", "move", "profiles"], cwd=ROOT,
                                 capture_output=True, text=True, check=True)
        return head.stdout.strip() + ("+" if changed.stdout.strip() else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def provenance(draws: bool) -> dict:
    """What is stored with a result; `draws` says whether images were drawn."""
    return {
        "versions": {name: version(name) for name in PACKAGES},
        "python": platform.python_version(),
        "processor": processor(),
        "cores": os.cpu_count(),
        "accelerator": accelerator(),
        "gl_renderer": gl_renderer() if draws else "none",
        "commit": commit(),
        "peak_memory_mb": round(peak_memory_mb()),
    }

"""Where a number came from: versions, processor, GL renderer, commit."""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import sys
from functools import cache
from importlib.metadata import version

import torch

from move.paths import ROOT
from move.sim.observe import gl_renderer

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


@cache
def processor() -> str:
    """The processor's name."""
    try:
        with open("/proc/cpuinfo") as lines:
            return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def accelerator() -> str:
    """The name of the GPU that training uses, or "none"."""
    return torch.cuda.get_device_name() if torch.cuda.is_available() else "none"


def peak_memory_mb() -> float:
    """The largest resident size of this process so far, in megabytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)


def provenance(draws: bool) -> dict:
    """What is stored with a result; `draws` says whether pictures were drawn."""
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

"""Where a number came from: the code that decides it and its versions, processor, GL renderer, commit."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import move
from move.machine import accelerator, cpu_capability, gl_renderer, peak_memory_mb, processor
from move.paths import IN_CHECKOUT, ROOT

PACKAGES = ("metaworld", "mujoco", "gymnasium", "numpy", "torch", "diffusers")
DECIDING = ("metaworld", "mujoco", "numpy", "torch", "diffusers")  # packages that decide a result's numbers
SOURCE = ("sim", "learn", "machine.py", "study/run.py")  # what of this package does


@cache
def version(package: str) -> str:
    """The version of an installed package, looked up once."""
    return metadata.version(package)


@cache
def commit() -> str:
    """The git commit of this tree, with "+" if the package differs from it; "unknown" outside git."""
    if not IN_CHECKOUT:
        return "unknown"
    try:
        head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True)
        changed = subprocess.run(["git", "status", "--porcelain", "move", "profiles"], cwd=ROOT,
                                 capture_output=True, text=True, check=True)
        return head.stdout.strip() + ("+" if changed.stdout.strip() else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


@cache
def source(package: Path = Path(move.__file__).parent) -> str:
    """The first sixteen hexadecimal digits of the sha256 of the source that decides a result: `SOURCE` of `package`."""
    files = sorted(path for part in SOURCE for path in ([package / part] if part.endswith(".py") else
                                                        (package / part).rglob("*.py")))
    digest = hashlib.sha256()
    for path in files:
        content = path.read_bytes()
        digest.update(f"{path.relative_to(package).as_posix()} {len(content)} ".encode() + content)
    return digest.hexdigest()[:16]


def deciding() -> dict[str, str]:
    """What decides a result's numbers in this process: `source` and the versions of packages, of whichever build."""
    return {"source": source(), **_without_build({name: version(name) for name in DECIDING})}


def difference(there: Mapping[str, str]) -> str:
    """How what decides results in this process differs from what does where they are asked for; empty if it does not.

    >>> difference(deciding() | {"mujoco": "3.5.0"}).endswith(", not 3.5.0")
    True
    """
    return ", ".join(f"{name} {here}, not {there.get(name)}" for name, here in deciding().items()
                     if there.get(name) != here)


def _without_build(versions: Mapping[str, str]) -> dict[str, str]:
    return {name: text.split("+")[0] for name, text in versions.items()}


def versions_elsewhere(made: Mapping[str, Any]) -> list[str]:
    """The versions of what decides, in a result's provenance `made`, that are not those installed here.

    >>> here = {name: version(name) for name in DECIDING}
    >>> versions_elsewhere({"versions": here}), versions_elsewhere({"versions": {**here, "mujoco": "3.5.0"}})
    ([], ['mujoco 3.5.0'])
    """
    here, there = deciding(), _without_build(made.get("versions", {}))
    if not there:
        return ["versions that were not recorded"]
    return [f"{name} {text}" for name in DECIDING if (text := there.get(name, "unknown")) != here[name]]


def other_versions(provenances: Iterable[Mapping[str, Any]]) -> list[str]:
    """How many of the results with these provenances have other versions of what decides than are installed here.

    >>> other_versions([{"versions": {name: version(name) for name in DECIDING} | {"mujoco": "3.5.0"}}])
    ['1 run with mujoco 3.5.0']
    """
    found = Counter(text for made in provenances for text in versions_elsewhere(made))
    return [f"{count} run{'s' * (count > 1)} with {text}" for text, count in sorted(found.items())]


def provenance(draws: bool) -> dict:
    """What is stored with a result; `draws` says whether images were drawn."""
    return {
        "source": source(),
        "versions": {name: version(name) for name in PACKAGES},
        "python": platform.python_version(),
        "processor": processor(),
        "cpu_capability": cpu_capability(),
        "cores": os.cpu_count(),
        "accelerator": accelerator(),
        "gl_renderer": gl_renderer() if draws else "none",
        "commit": commit(),
        "peak_memory_mb": round(peak_memory_mb()),
    }

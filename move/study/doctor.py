"""What this machine has and lacks: drawing, processor, memory, versions against the lock, each with what mends it."""

from __future__ import annotations

import os
from importlib.metadata import PackageNotFoundError, version

import psutil
from packaging.requirements import Requirement

from move.machine import gl_problem, gl_renderer, processor
from move.paths import LOCK

MEMORY_GB = 4.0  # two image runs at a time, and room to breathe
Check = dict[str, str]


def examine() -> list[Check]:
    """All checks: name, outcome ("fine", "slow" or "broken"), what was found, and the one line that mends it."""
    cores = _check("processor", "fine", f"{os.cpu_count()} x {processor()}")
    return [_gl(), cores, _memory(), *_versions()]


def _check(name: str, outcome: str, found: str, mend: str = "") -> Check:
    return {"check": name, "outcome": outcome, "found": found, "mend": mend}


def _gl() -> Check:
    if problem := gl_problem():
        return _check("GL", "slow", problem, "apt-get install libegl1 libopengl0")
    try:
        renderer = gl_renderer()
    except Exception as error:  # whatever a GL driver raises: it cannot draw
        return _check("GL", "slow", f"cannot draw: {error}", "apt-get install libegl1 libopengl0 libgl1-mesa-dri")
    if "llvmpipe" in renderer:
        renderer += ": draws in software, 2 to 5 ms an image, which is enough"
    return _check("GL", "fine", renderer)


def _memory() -> Check:
    available = psutil.virtual_memory().available / 1e9
    if available < MEMORY_GB:
        return _check("memory", "slow", f"{available:.1f} GB free", "close programs, or `move run --workers 1`")
    return _check("memory", "fine", f"{available:.1f} GB free")


def locked_versions(text: str) -> dict[str, str]:
    """Package to version from a lock file in pip's format, for the packages that this platform needs.

    >>> locked_versions("numpy==2.4.6 ; python_version > '3'\\n    --hash=sha256:0\\nsix==1.17.0 ; os_name == 'none'")
    {'numpy': '2.4.6'}
    """
    pins = [Requirement(line.rstrip(" \\")) for line in text.splitlines() if line[:1].isalnum()]
    return {pin.name: str(pin.specifier).removeprefix("==") for pin in pins if not pin.marker or pin.marker.evaluate()}


def _versions() -> list[Check]:
    if not LOCK.exists():
        return [_check("lock", "broken", f"{LOCK} is missing", "git checkout environment.lock")]
    wrong = []
    for name, pinned in locked_versions(LOCK.read_text()).items():
        try:
            installed = version(name).split("+")[0]
        except PackageNotFoundError:
            installed = "not installed"
        if installed != pinned:
            wrong.append(_check(name, "broken", f"{installed}, the lock has {pinned}", "rm -rf .venv && make setup"))
    return wrong or [_check("versions", "fine", "all as in environment.lock")]

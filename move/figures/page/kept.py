"""Figures that simulate are made once: what was shipped is shown as long as it is made of the same things.

Next to such a figure `NAME.made.json` says what it was made of (its own file and what it draws and counts with, its
parameters, its runs, the policies that are there, the versions of what decides; and how much trainings differ, which
other figures' runs tell), its answer, the sha256 of each of its files, and a digest of all that. A figure whose file
says `SIMULATES = True` is made anew only if one of these differs.
"""

from __future__ import annotations

import ast
import hashlib
import json
from collections.abc import Mapping
from dataclasses import astuple
from pathlib import Path
from typing import Any

import pandas as pd

from move.figures import load, names
from move.figures.page.changes import plain
from move.figures.page.data import Data
from move.figures.page.parameters import SHARED
from move.files import written_aside
from move.machine import gl_problem
from move.paths import PACKAGE
from move.study.provenance import deciding
from move.study.spec import RESULTS_VERSION

COUNTED_WITH = ("figures/plots", "figures/tables", "statistics", "study/seen", "sim/coverage")
"""What makes a figure of what was simulated; simulating itself is held by the tests of its numbers."""

WRITTEN = (".png", ".pdf", ".mp4", ".webp", ".md", ".csv", ".tex")  # in the order in which they are listed


def keep(name: str, data: Data, chosen: Mapping[str, Any], answers: Mapping[str, str]) -> None:
    """Note what a figure was made of, once it is written."""
    if not getattr(load(name), "SIMULATES", False) or gl_problem():  # without GL there would be no images to keep
        return
    content = {"made_of": _made_of(name, data, chosen), "answers": dict(answers), "files": _files(name, data.folder),
               "noises": {f"{seen} {grid}": astuple(noise) for (seen, grid), noise in data.noises.items()}}
    with written_aside(data.folder / f"{name}.made.json") as new:
        new.write_text(json.dumps({**content, "digest": _of_json(content)}, indent=1, sort_keys=True) + "\n",
                       encoding="utf-8")


def answers(name: str, data: Data, chosen: Mapping[str, Any]) -> dict[str, str] | None:
    """What came out of a figure that would be made of the same things as the one that is there; None of any other."""
    record = data.folder / f"{name}.made.json"
    if not getattr(load(name), "SIMULATES", False) or not record.exists():
        return None
    try:
        content = json.loads(record.read_text(encoding="utf-8"))
        whole = content.pop("digest") == _of_json(content) and content["files"] == _files(name, data.folder)
        same = content["made_of"] == _made_of(name, data, chosen) and all(
            list(astuple(data.noise(seen, grid == "True"))) == noise
            for (seen, grid), noise in ((key.split(), noise) for key, noise in content.get("noises", {}).items()))
        return content["answers"] if whole and same else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):  # no such file, or not as `keep` writes it
        return None


def tables(name: str, folder: Path) -> dict[str, pd.DataFrame]:
    """The tables of a figure as they were written."""
    return {suffix: pd.read_csv(folder / f"{name}{'_' * bool(suffix)}{suffix}.csv")
            for suffix in load(name).WORDS.tables}


def files_of(name: str, folder: Path) -> list[Path]:
    """The files of a figure in a folder that may hold others': pictures first, then films, captions, tables, others."""
    own = (name, *load(name).WORDS.others)
    longer = tuple(other for other in names() if other.startswith(f"{name}_"))
    found = [path for path in folder.glob("*") if not path.name.startswith(longer) and any(
        path.name.startswith(one) and not path.name[len(one):len(one) + 1].isalnum() for one in own)]
    return sorted(found, key=lambda path: ([*WRITTEN, path.suffix].index(path.suffix), path.name))


def code(name: str) -> dict[str, str]:
    """The text of a figure's file and of the files of `COUNTED_WITH` that it imports, or that these import; by path."""
    texts: dict[str, str] = {}
    left = [f"figures/{name}.py"]
    while left:
        path = left.pop()
        if path not in texts:
            texts[path] = (PACKAGE / path).read_text(encoding="utf-8")
            left += _imported(texts[path])
    return texts


def _imported(text: str) -> list[str]:
    """The files of `COUNTED_WITH` that a text imports, wherever in it; a name that is imported may be a module."""
    modules: list[str] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.module:
            module = node.module.removeprefix("move.").replace(".", "/")
            modules += [module, *(f"{module}/{name.name}" for name in node.names)]
    paths = (path for module in modules for path in (f"{module}.py", f"{module}/__init__.py"))
    return [path for path in paths if path.startswith(COUNTED_WITH) and (PACKAGE / path).exists()]


def _made_of(name: str, data: Data, chosen: Mapping[str, Any]) -> str:
    versions = {package: version for package, version in deciding().items() if package != "source"}
    policies = sorted(path.name for path in (data.profile.results / "policies").glob("*"))
    usual = {key: default for key, (_, default) in SHARED.items()}
    own = {key: value for key, value in chosen.items() if key not in usual or value != usual[key]}
    parts = [code(name), plain(own), sorted(result.spec.hash for result in data.results),
             policies if data.runs else [], versions, RESULTS_VERSION, data.profile.stamp]
    return _of_json(parts)


def _files(name: str, folder: Path) -> dict[str, str]:
    """The sha256 of each file of a figure."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files_of(name, folder)
            if path.suffix in WRITTEN}


def _of_json(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

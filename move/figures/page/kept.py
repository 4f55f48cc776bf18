"""Figures that simulate are made once: what was shipped is shown as long as it is made of the same things.

Next to such a figure `NAME.made.json` says what it was made of (its own file, its parameters, its runs, the policies
that are there, the versions of what decides; and how much trainings differ, which other figures' runs tell), its
answer, the sha256 of each of its files, and a digest of all that. A figure whose file says `SIMULATES = True` is made
anew only if one of these differs.
"""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Mapping
from dataclasses import astuple
from pathlib import Path
from typing import Any

import pandas as pd

from move.figures import load
from move.figures.page.changes import plain
from move.figures.page.data import Data
from move.figures.page.parameters import SHARED
from move.files import written_aside
from move.machine import gl_problem
from move.study.provenance import deciding
from move.study.spec import RESULTS_VERSION

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
    found = [path for path in folder.glob("*") if any(
        path.name.startswith(one) and not path.name[len(one):len(one) + 1].isalnum() for one in own)]
    return sorted(found, key=lambda path: ([*WRITTEN, path.suffix].index(path.suffix), path.name))


def _made_of(name: str, data: Data, chosen: Mapping[str, Any]) -> str:
    versions = {package: version for package, version in deciding().items() if package != "source"}
    policies = sorted(path.name for path in (data.profile.results / "policies").glob("*"))
    usual = {key: default for key, (_, default) in SHARED.items()}
    own = {key: value for key, value in chosen.items() if key not in usual or value != usual[key]}
    parts = [inspect.getsource(load(name)), plain(own), sorted(result.spec.hash for result in data.results),
             policies if data.runs else [], versions, RESULTS_VERSION, data.profile.stamp]
    return _of_json(parts)


def _files(name: str, folder: Path) -> dict[str, str]:
    """The sha256 of each file of a figure."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files_of(name, folder)
            if path.suffix in WRITTEN}


def _of_json(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

"""Stored results: one JSON file a run, written whole or not at all, with where it came from.

A result holds its spec, one row an episode, the collection's record, the training curve, timings and provenance, and
a digest of all that. A file that cannot be read, or does not fit its digest or the spec asked for, is never a number:
it is named, and the run counts as missing.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd
from pydantic import ValidationError

from move.errors import BadInput
from move.study.labels import Label
from move.study.spec import RunSpec, run_spec_from_json

NOT_COMPUTED = "not computed yet"


@dataclass(frozen=True)
class Result:
    """One finished run."""

    spec: RunSpec
    rows: list[dict]  # one an episode, see move.learn.evaluate.evaluate
    collection: dict | None
    training: dict | None
    seconds: dict[str, float]  # wall-clock of each part
    provenance: dict
    labels: Mapping[str, Label] = field(default_factory=dict)  # the run's in the experiment that asked; not stored

    @property
    def rate(self) -> float:
        """Success rate over the evaluation episodes that are not training points."""
        judged = [row["success"] for row in self.rows if row["group"] != "point"]
        return sum(judged) / len(judged)


def _digest(content: dict) -> str:
    canonical = json.dumps({key: value for key, value in content.items() if key != "digest"}, sort_keys=True)
    return hashlib.sha256(canonical.encode()).hexdigest()


def store(result: Result, folder: Path) -> Path:
    """Write `result` under its hash, atomically.

    Raises:
        BadInput: a folder that cannot be written.
    """
    columns = {name: [row[name] for row in result.rows] for name in result.rows[0]}
    content = {**vars(result), "spec": result.spec.model_dump(mode="json"), "rows": columns}
    del content["labels"]
    content = json.loads(json.dumps(content))
    content["digest"] = _digest(content)
    path = folder / f"{result.spec.hash}.json"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        beside = path.with_suffix(f".{os.getpid()}.part")
        beside.write_text(json.dumps(content, sort_keys=True) + "\n")
        os.replace(beside, path)
    except OSError as error:
        raise BadInput(f"results: cannot write {path}: {error.strerror}; a writable folder is needed") from error
    return path


def check_writable(folder: Path) -> None:
    """Refuse a results folder that cannot be written, before any work is done.

    Raises:
        BadInput: it cannot be made, or not written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f".{os.getpid()}.probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise BadInput(f"results: cannot write to {folder}: {error.strerror}; a writable folder is needed") from error


def load(spec: RunSpec, folder: Path) -> Result | None:
    """The stored result of `spec`; None where there is none.

    Raises:
        BadInput: a file that is there and is not that result; the message names it and says why.
    """
    path = folder / f"{spec.hash}.json"
    if not path.exists():
        return None
    try:
        content = json.loads(path.read_text())
        if content.pop("digest", None) != _digest(content):
            raise ValueError("its content does not fit its digest")
        content["spec"] = run_spec_from_json(json.dumps(content["spec"]))
        if content["spec"] != spec:
            raise ValueError("it holds another spec")
        columns = content["rows"]
        content["rows"] = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
        return Result(**content)
    except (OSError, ValueError, TypeError, KeyError, ValidationError) as error:
        reason = " ".join(str(error).split())[:200]
        raise BadInput(f"result {path} is not usable: {reason}; it will be computed anew") from error


def split(specs: list[RunSpec], folder: Path) -> tuple[list[Result], list[tuple[RunSpec, str]]]:
    """Stored results of `specs`, and the missing ones each with the reason why."""
    there, missing = [], []
    for spec in specs:
        try:
            result = load(spec, folder)
        except BadInput as problem:
            missing.append((spec, str(problem)))
            continue
        if result is None:
            missing.append((spec, NOT_COMPUTED))
        else:
            there.append(result)
    return there, missing


def table(results: list[Result]) -> pd.DataFrame:
    """All episodes of all results, one row each, with the columns a figure groups by: labels, and what every run has.

    Column `kind` is "policy", "control" or "collector"; `timesteps` is 0 for a control, which has no demonstrations.

    Raises:
        BadInput: a label that has the name of an episode's own column.
    """
    frames = [
        _episodes(result).assign(
            run=result.spec.hash,
            kind=result.spec.kind,
            task=result.spec.task,
            method=result.spec.method,
            observation=result.spec.observation,
            timesteps=result.spec.collection.timesteps if result.spec.collection else 0,
            factors=result.spec.evaluation.factors,
            hand_spread=result.spec.collection.hand_spread if result.spec.collection else 0.0,
            seed=result.spec.seed,
        )
        for result in results
    ]
    return pd.concat(frames, ignore_index=True) if frames else pd.DataFrame()


def _episodes(result: Result) -> pd.DataFrame:
    rows = pd.DataFrame(result.rows)
    if taken := set(result.labels) & set(rows):
        raise BadInput(f"label: {', '.join(sorted(taken))} given, which every episode has; allowed is another name")
    return rows.assign(**result.labels)

"""Two evaluations at the same configurations: which is better, by how much, and how sure that is."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, NonNegativeInt, ValidationError

from move.choices import HASH
from move.errors import BadInput
from move.sim.configuration import SpatialConfiguration
from move.statistics.estimates import Estimate, success_rate
from move.statistics.paired import exact_difference
from move.study.provenance import other_versions
from move.study.results import find, load_named
from move.untrusted import read_json
from move.validation import first_problem

PLACE = tuple(SpatialConfiguration((0, 0, 0), (0, 0, 0), (0, 0, 0), 0).columns())

IN_EVERY_ROW = {"object_x", "object_y"}  # stored runs leave out what their specification gives again


class _Part(BaseModel):
    """What is used of a part of an evaluation's file, which may hold more."""

    model_config = ConfigDict(strict=True, extra="ignore", hide_input_in_errors=True)


class _Row(_Part):
    """One episode."""

    trial: NonNegativeInt
    group: str
    success: bool
    place: dict[str, FiniteFloat]


class _Provenance(_Part):
    """Where an evaluation came from."""

    versions: dict[str, str] = {}


class _File(_Part):
    """What `move evaluate --json` prints."""

    task: Annotated[str, Field(pattern=r"^[\w-]{1,100}$")]
    rows: list[dict[str, Any]] = Field(min_length=1)
    success_rate: FiniteFloat | None = None
    episodes: int | None = None
    provenance: _Provenance = _Provenance()  # which earlier versions did not print


@dataclass(frozen=True)
class Evaluated:
    """One policy's or control's episodes, without those at its own training points, and what computed them."""

    name: str
    task: str
    rows: list[_Row]
    provenance: dict[str, Any]


@dataclass(frozen=True)
class Comparison:
    """Two evaluations of one task: rates, and the paired difference with interval and p value."""

    task: str
    first: str
    second: str
    first_rate: Estimate
    second_rate: Estimate
    difference: Estimate
    other_versions: list[str]  # than are installed here, "1 run with mujoco 3.5.0"

    def __str__(self) -> str:
        low, value, high = (f"{100 * rate:+.1f}".replace("+0.0", "0.0").replace("-0.0", "0.0") for rate in (
            self.difference.low, self.difference.value, self.difference.high))
        p = self.difference.p_value
        others = f"; other versions than here computed {', '.join(self.other_versions)}" if self.other_versions else ""
        return (f"{self.first} {self.first_rate.value:.3f} minus {self.second} {self.second_rate.value:.3f}: {value} "
                f"points [{low}, {high}], p {f'= {p:.3f}' if p >= 0.001 else '< 0.001'}, paired at "
                f"{self.difference.episodes // 2} configurations of {self.task}; how much trainings differ is not "
                f"counted, for each was evaluated once{others}")


def read_evaluation(given: str, folders: list[Path]) -> Evaluated:
    """The evaluation in a file that `move evaluate --json` wrote, or the stored run of a hash.

    Args:
        folders: where stored runs are looked for.

    Raises:
        BadInput: neither; or one that is damaged.
    """
    path = Path(given)
    if not path.is_file() and not HASH.fullmatch(given):
        raise BadInput(f"{given[:100]!r} given; allowed is a file of `move evaluate --json`, or the hash of a run "
                       f"stored in {' or '.join(map(str, folders))}")
    if path.is_file() and "spec" not in (about := read_json(path, "`move evaluate --json`'s output, or a stored run")):
        return _of_file(given, path, about)
    result = load_named(path) if path.is_file() else find(given, folders)
    return _evaluated(given, result.spec.task, result.rows, result.provenance)


def _of_file(given: str, path: Path, about: dict[str, Any]) -> Evaluated:
    try:
        found = _File.model_validate(about)
    except ValidationError as problem:
        raise BadInput(f"{path}: {first_problem(problem)}; allowed is what `move evaluate --json` prints") from problem
    evaluated = _evaluated(given, found.task, found.rows, found.provenance.model_dump())
    if found.episodes not in (None, len(found.rows)):
        raise BadInput(f"{path}: episodes is {found.episodes}, it has {len(found.rows)} rows")
    rate = sum(bool(row["success"]) for row in found.rows) / len(found.rows)
    if found.success_rate is not None and abs(found.success_rate - rate) > 1e-9:
        raise BadInput(f"{path}: success_rate is {found.success_rate:g}, its rows say {rate:g}")
    return evaluated


def _evaluated(given: str, task: str, rows: list[dict[str, Any]], provenance: dict[str, Any]) -> Evaluated:
    read = [_row(row, given) for row in rows]
    counts = Counter((row.group, row.trial) for row in read)
    if twice := [trial for (_, trial), count in counts.items() if count > 1]:
        raise BadInput(f"{given}: trial {twice[0]} stands there more than once; allowed is once")
    return Evaluated(given, task, [row for row in read if row.group != "point"], provenance)


def _row(row: dict[str, Any], given: str) -> _Row:
    try:
        return _Row.model_validate({**row, "place": {name: row[name] for name in PLACE if name in row}})
    except ValidationError as problem:
        raise BadInput(f"{given}: row of trial {str(row.get('trial'))[:20]}: {first_problem(problem)}") from problem


def _begin_alike(row: _Row, paired: _Row) -> bool:
    """Whether two episodes have the same number, group and configuration, by the columns that both have."""
    shared = row.place.keys() & paired.place.keys()
    return shared >= IN_EVERY_ROW and (row.trial, row.group) == (paired.trial, paired.group) and all(
        row.place[name] == paired.place[name] for name in shared)


def compare(first: Evaluated, second: Evaluated) -> Comparison:
    """First minus second, paired by configuration.

    Raises:
        BadInput: two tasks, or not the same configurations in the same order.
    """
    if first.task != second.task:
        raise BadInput(f"compare: {first.name} is of {first.task}, {second.name} of {second.task}; allowed is one task")
    if not first.rows or len(first.rows) != len(second.rows):
        raise BadInput(f"compare: {len(first.rows)} and {len(second.rows)} episodes; allowed is one number in both")
    for row, paired in zip(first.rows, second.rows, strict=True):
        if not _begin_alike(row, paired):
            raise BadInput(f"compare: trial {row.trial} of {first.name} and {paired.trial} of {second.name} did not "
                           "begin in the same configuration; allowed are evaluations with the same starts, episodes "
                           "and factors")
    one, other = (np.array([[row.success for row in each.rows]], float) for each in (first, second))
    return Comparison(first.task, first.name, second.name, success_rate(one), success_rate(other),
                      exact_difference(one, other), other_versions(each.provenance for each in (first, second)))

"""Stored results: one JSON file a run, written whole or not at all, with where it came from.

A result holds its spec, one row an episode, the collection's record, the training curve, timings and provenance, and
a digest of all that (`stored.py`). A file that cannot be read, or does not fit its digest, the spec asked for or what
such a run gives, is never a number: it is named, and the run counts as missing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from move.choices import HASH
from move.errors import BadInput
from move.files import written_aside
from move.sim.tasks import FACTORS
from move.study.labels import Label
from move.study.spec import RESULTS_VERSION, RunSpec
from move.study.stored import from_bytes, to_text
from move.validation import reason_of

NOT_COMPUTED = "not computed yet"
LARGEST = 50_000_000  # bytes of a result's file; real ones have some ten thousand


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
    def successes(self) -> np.ndarray:
        """Of each episode 1 or 0, (episodes,) float, in the order of the trials."""
        return np.array([row["success"] for row in self.rows], float)

    @property
    def judged(self) -> list[bool]:
        """Whether each of the evaluation episodes that are not training points succeeded."""
        return [row["success"] for row in self.rows if row["group"] != "point"]

    @property
    def rate(self) -> float:
        """Success rate over the evaluation episodes that are not training points."""
        judged = self.judged
        return sum(judged) / len(judged)


def store(result: Result, folder: Path) -> Path:
    """Write `result` under its hash, atomically.

    Raises:
        BadInput: a folder that cannot be written.
    """
    content = {name: getattr(result, name) for name in ("collection", "training", "seconds", "provenance")}
    path = folder / f"{result.spec.hash}.json"
    with written_aside(path) as beside:
        beside.write_text(to_text(result.spec, result.rows, content))
    return path


def load(spec: RunSpec, folder: Path) -> Result | None:
    """The stored result of `spec`; None where there is none.

    Raises:
        BadInput: a file that is there and is not that result; the message names it and says why.
    """
    path = folder / f"{spec.hash}.json"
    if not path.exists():
        return None
    result = read(path)
    if result.spec != spec:
        raise BadInput(f"result {path} is not usable: it holds another spec")
    return result


def read(path: Path) -> Result:
    """The result that a file holds, whatever its name; each file is read once a process, unless it changes.

    Raises:
        BadInput: no such file, or it is damaged or of another results version; the message says what is wrong first.
    """
    try:
        if not path.is_file():
            raise ValueError("it is no file")
        found = path.stat()
        return _read(path, found.st_size, found.st_ino, found.st_mtime_ns)
    except (OSError, ValueError, TypeError, KeyError, RecursionError) as error:
        raise BadInput(f"result {path} is not usable: {reason_of(error)}") from error


@cache
def _read(path: Path, size: int, *state: int) -> Result:
    """What a file of `size` bytes holds, for as long as its `state` is the same."""
    if size > LARGEST:
        raise ValueError(f"{size} bytes; a result has at most {LARGEST}")
    spec, rows, content = from_bytes(path.read_bytes())
    if spec.results_version != RESULTS_VERSION:
        raise ValueError(f"results version {spec.results_version}; this source reads {RESULTS_VERSION}")
    return Result(spec, rows, **content)


def load_named(path: Path) -> Result:
    """The stored result in a file that is named by its run's hash.

    Raises:
        BadInput: it is no result, damaged, or of another run than its name says.
    """
    result = read(path)
    if path.stem != result.spec.hash:
        raise BadInput(f"{path} is the run {result.spec.hash}; allowed is a file of that name")
    return result


def find(name: str, folders: Sequence[Path]) -> Result:
    """The stored result of the run whose hash is `name`, from the first of `folders` that has it.

    Raises:
        BadInput: no hash, no such run, or a damaged one.
    """
    there = [path for folder in folders if HASH.fullmatch(name) and (path := folder / f"{name}.json").is_file()]
    if not there:
        raise BadInput(f"run: {name[:60]!r} given; allowed is the hash of a run stored in "
                       f"{' or '.join(map(str, folders))}")
    return load_named(there[0])


def set_aside(spec: RunSpec, folder: Path) -> Path | None:
    """Rename what stands in the place of the result of `spec` and is not that result; None where nothing does."""
    try:
        load(spec, folder)
        return None
    except BadInput:
        path = folder / f"{spec.hash}.json"
        names = (path.with_suffix(f".{number}.bad" if number else ".bad") for number in count())
        aside = next(name for name in names if not name.exists())
    try:
        path.rename(aside)
    except FileNotFoundError:  # another process was faster
        return None
    except OSError as error:
        raise BadInput(f"results: cannot rename {path}: {error.strerror}; a writable folder is needed") from error
    return aside


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


def missing_in_words(missing: list[tuple[RunSpec, str]], shown: int = 3) -> str:
    """The first runs that are missing, each with the reason if it is an unusable file, and how many more there are.

    Those that have one name are counted: they differ in what it does not say.
    """
    named = Counter(spec.label if why == NOT_COMPUTED else f"{spec.label} ({why})" for spec, why in sorted(
        missing, key=lambda run: run[1] == NOT_COMPUTED)).items()
    words = [f"{times} x {name}" if times > 1 else name for name, times in [*named][:shown]]
    left = sum(times for _, times in [*named][shown:])
    return ", ".join([*words, *[f"{left} more"] * bool(left)])


def table(results: list[Result]) -> pd.DataFrame:
    """All episodes of all results, one row each, with the columns a figure groups by: labels, and what every run has.

    Column `kind` is "policy", "control" or "collector"; `timesteps` is 0 for a control, which has no demonstrations.

    Raises:
        BadInput: a label that has the name of an episode's own column.
    """
    rows: list[dict[str, Any]] = []
    for result in results:
        shared = _of_the_run(result)
        rows += [row | shared for row in result.rows]
    return pd.DataFrame(rows)


def _of_the_run(result: Result) -> dict[str, Any]:
    """What all episodes of a result share: the labels, and what every run has."""
    if taken := set(result.labels) & set(result.rows[0]):
        raise BadInput(f"label: {', '.join(sorted(taken))} given, which every episode has; allowed is another name")
    spec, made = result.spec, result.spec.collection
    return {
        **result.labels,
        "run": spec.hash,
        "kind": spec.kind,
        "task": spec.task,
        "method": spec.method,
        "observation": spec.observation,
        "timesteps": made.timesteps if made else 0,
        "factors": spec.evaluation.factors,
        "hand_spread": made.hand_spread if made else 0.0,
        "hand": hand_start(spec),
        "seed": spec.seed,
    }


def hand_start(spec: RunSpec) -> str:
    """Where the hand starts in a run's demonstrations, in words: "anywhere", "within 3 cm" or "one place".

    Of a run without demonstrations where it starts in the evaluation.
    """
    made = spec.collection
    if "hand" in FACTORS[made.factors if made else spec.evaluation.factors]:
        return "anywhere"
    return f"within {100 * made.hand_spread:g} cm" if made and made.hand_spread else "one place"

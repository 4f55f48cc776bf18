"""Recomputes a random sample of stored results and compares, so that a reader need not take them on trust."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from move.errors import BadInput
from move.machine import processor
from move.study import run as running
from move.study.results import Result, split
from move.study.spec import RunSpec


def verify(specs: list[RunSpec], folder: Path, sample: int, rng: np.random.Generator) -> list[dict[str, Any]]:
    """Recompute `sample` stored results from nothing and say for each how many episodes ended the same.

    The same processor, GL renderer and versions give the same bits; elsewhere rounding differs and single episodes
    may turn out otherwise, so the row names both processors.

    Raises:
        BadInput: no stored result.
    """
    there, _ = split(specs, folder)
    if not there:
        raise BadInput(f"verify: no stored result in {folder}; run `move run` first")
    chosen = rng.choice(len(there), size=min(sample, len(there)), replace=False)
    return [_compare(there[index]) for index in sorted(chosen)]


def _compare(stored: Result) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as scratch:
        again = running.run(stored.spec, Path(scratch) / "results", scratch=Path(scratch) / "runs")
    same = sum(before == after for before, after in zip(stored.rows, again.rows, strict=True))
    return {
        "run": stored.spec.label,
        "stored_rate": stored.rate,
        "recomputed_rate": again.rate,
        "same_episodes": f"{same} of {len(stored.rows)}",
        "stored_on": stored.provenance["processor"],
        "recomputed_on": processor(),
    }

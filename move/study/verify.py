"""Looks for a stored result that is not what it says: recomputes named ones or a sample, or checks files and policies.

Rows are compared by the columns that both have, for results of earlier versions hold less of the configuration tried.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from move.errors import BadInput
from move.statistics.intervals import wilson_interval
from move.study.execute import PART_SHARE
from move.study.provenance import versions_elsewhere
from move.study.results import NOT_COMPUTED, Result, load_named, split
from move.study.seals import refuse_another
from move.study.spec import PolicyRun, RunSpec

LIKE = ("processor", "cpu_capability", "accelerator", "gl_renderer")
"""Of the provenance: where these differ, so may single episodes."""


def draw_sample(results: list[Result], sample: int, rng: np.random.Generator) -> list[Result]:
    """`sample` results at random, each run once, with one from pixels among them where there is any."""
    there = list({result.spec.hash: result for result in results}.values())
    order = [there[index] for index in rng.permutation(len(there))]
    pixels = [result for result in order if result.spec.observation == "rgb" and isinstance(result.spec, PolicyRun)][:1]
    return (pixels + [result for result in order if result not in pixels])[:sample]


def verify(
    specs: list[RunSpec], folder: Path, sample: int, rng: np.random.Generator,
    on_step: Callable[[float, int], None] | None = None,
) -> list[dict[str, Any]]:
    """Recompute a drawn sample of the stored results from nothing; one row each, `same` says how it came out.

    On the same processor, accelerator, GL renderer and precision every row has to be the same. Elsewhere rounding
    differs, and the recomputed rate has to lie in the stored rate's 95 % interval. A file that is not usable has a row
    of its own.

    Raises:
        BadInput: no stored result.
    """
    there, missing = split(specs, folder)
    unusable = {spec.hash: (spec, why) for spec, why in missing if why != NOT_COMPUTED}
    if not there and not unusable:
        raise BadInput(f"verify: no stored result in {folder}; run `move run` first")
    rows = [_row(spec, False, "not at all", difference=why) for spec, why in unusable.values()]
    return rows + recompute(draw_sample(there, sample, rng), on_step)


def recompute(results: list[Result], on_step: Callable[[float, int], None] | None = None) -> list[dict[str, Any]]:
    """Recompute stored results from nothing; one row each, as `verify` gives them."""
    return [_recompute(stored, number, len(results), on_step)
            for number, stored in enumerate(results)]


def _row(spec: RunSpec, same: bool, judged: str, stored_rate: float | None = None, recomputed_rate: float | None = None,
         difference: str | None = None) -> dict[str, Any]:
    return {"run": spec.label, "hash": spec.hash, "same": same, "judged": judged, "stored_rate": stored_rate,
            "recomputed_rate": recomputed_rate, "difference": difference or "none"}


def _recompute(
    stored: Result, before: int, drawn: int, on_step: Callable[[float, int], None] | None
) -> dict[str, Any]:
    from move.study import run as running  # slow to import, and the check of files recomputes nothing

    def report(part: str, done: int, total: int) -> None:
        start, share = PART_SHARE[part]
        if on_step:
            on_step(before + start + share * done / total, drawn)

    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        again = running.run(stored.spec, scratch / "results", report, scratch=scratch / "runs")
    other = _elsewhere(stored, again)
    different = first_difference(stored.rows, again.rows)
    if other:
        low, high = wilson_interval(stored.rate, len(stored.judged))
        same, judged = low <= again.rate <= high, f"by rate and interval [{low:.3f}, {high:.3f}]: other {other}"
    else:
        same, judged = different is None, "row by row"
    if others := versions_elsewhere(stored.provenance):
        judged += f"; stored with {', '.join(others)}"
    return _row(stored.spec, same, judged, stored.rate, again.rate, different)


def _elsewhere(stored: Result, again: Result) -> str:
    """What of the machine differs from the result's, in words; empty if nothing does."""
    here = again.provenance
    there = {"cpu_capability": here["cpu_capability"], **stored.provenance}  # which earlier results do not name
    names = [name for name in LIKE if there.get(name) != here[name]]
    if (stored.training or {}).get("precision") != (again.training or {}).get("precision"):
        names.append("precision")
    return ", ".join(names)


def first_difference(before: list[dict], after: list[dict]) -> str | None:
    """The first row and column in which two lists of rows differ; None if they agree in all columns that both have.

    >>> first_difference([{"trial": 0, "steps": 9}], [{"trial": 0, "steps": 8, "hand_x": 0.1}])
    'row 0: steps 9, recomputed 8'
    """
    if len(before) != len(after):
        return f"{len(before)} rows, recomputed {len(after)}"
    for number, (old, new) in enumerate(zip(before, after, strict=True)):
        for name in old:
            if name in new and old[name] != new[name]:
                return f"row {number}: {name} {old[name]}, recomputed {new[name]}"
    return None


def check_files(folder: Path) -> list[dict[str, Any]]:
    """One row a stored file of `folder`: whether it fits its digest and its spec, which has the hash of its name.

    And one row a policy that is shipped next to them: whether it is, to the last bit, that of such a run.

    Raises:
        BadInput: no stored result.
    """
    files = sorted(folder.glob("*.json"))
    if not files:
        raise BadInput(f"verify: no stored result in {folder}; run `move run` first")
    runs: dict[str, RunSpec] = {}

    def load_run(path: Path) -> None:
        spec = load_named(path).spec
        if isinstance(spec, PolicyRun):
            runs[spec.policy_hash] = spec

    def load_policy(place: Path) -> None:
        if place.name not in runs:
            raise BadInput(f"{place}: no usable result in {folder} is of a run with this policy")
        refuse_another(runs[place.name], place)

    rows = [{"file": path.name, **_check(load_run, path)} for path in files]
    return rows + [{"file": f"policies/{place.name}", **_check(load_policy, place)}
                   for place in sorted((folder / "policies").glob("*"))]


def _check(load: Callable[[Path], None], path: Path) -> dict[str, Any]:
    try:
        load(path)
    except BadInput as problem:
        return {"same": False, "difference": str(problem)}
    return {"same": True, "difference": "none"}

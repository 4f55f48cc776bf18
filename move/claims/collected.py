"""Quantities of demonstrations, before anything is trained: what they cover, how long they are, how many succeed."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pandas as pd

from move.claims.claims import Quantity
from move.claims.evidence import Evidence, over_seeds, runs_of
from move.sim.collection import Collection
from move.sim.coverage import PARTS, configurations, shares
from move.sim.methods import METHODS
from move.sim.tasks import get_task
from move.statistics.verdicts import TWO_SIDED, Finding, Item, Missing


def coverage(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """Shares of cells seen, MOVE minus another; where no stored run says, demonstrations are made here, in seconds."""
    timesteps, other = each.options["timesteps"], each.other["method"]
    share = partial(_share, evidence, timesteps=timesteps)
    return [over_seeds(f"cells of the {part} seen in {timesteps:,} timesteps, MOVE minus {METHODS[other].title}",
                       [share("move", part, seed=seed) - share(other, part, seed=seed) for seed in range(3)], each)
            for part in PARTS]


def _share(evidence: Evidence, method: str, part: str, timesteps: int, seed: int) -> float:
    """Share of the cells of a part that Pick-Place's demonstrations visit, as a stored run of keypoints says."""
    wanted = Collection(task="pick-place", method=method, timesteps=timesteps)
    for experiment in ("table_keypoint_control", "table_adc"):  # which has ADC as it is printed
        for result in evidence.stored(experiment).values():
            covered = (result.collection or {}).get("covered") or {}
            if (result.spec.collection, result.spec.seed) == (wanted, seed) and str(timesteps) in covered:
                return covered[str(timesteps)][part]
    return _collected(method, timesteps, seed)[part]


@cache
def _collected(method: str, timesteps: int, seed: int) -> dict[str, float]:
    wanted = Collection(task="pick-place", method=method, timesteps=timesteps)
    return shares(configurations(wanted, seed), get_task("pick-place"))


def lengths(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """MOVE's mean length of a demonstration over static's, minus 1: of these tasks, over their demonstrations."""
    made = _made(evidence, each, experiment)
    if isinstance(made, Missing):
        return [made]
    means = [[rows[rows.success.astype(bool)].steps for rows in side] for side in made]
    if min(len(part) for side in means for part in side) < 2:
        return [Missing(f"{each.what} (a task without two successful demonstrations)", 0, 0.0)]
    logs, variances = zip(*((np.log(np.mean([part.mean() for part in side])),
                             sum(part.var() / len(part) for part in side) / sum(part.mean() for part in side) ** 2)
                            for side in means), strict=True)
    ratio, half = np.exp(logs[0] - logs[1]), TWO_SIDED * np.sqrt(sum(variances))
    return [Finding(each.what, float(ratio - 1), float(ratio * np.exp(-half) - 1), float(ratio * np.exp(half) - 1),
                    **each.region, runs=runs_of(*made[0], *made[1]), **each.paper.of_one(0))]


def generation(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """Shares of attempts that succeed, means of these tasks, minus the paper's."""
    made = _made(evidence, each, experiment)
    if isinstance(made, Missing):
        return [made]
    items: list[Item] = []
    for method, side, theirs in zip(("MOVE", "static"), made, each.paper.value, strict=True):
        rates = [rows.success.astype(float) for rows in side]
        mean = float(np.mean([part.mean() for part in rates]))
        half = TWO_SIDED * float(np.sqrt(sum(part.var() / len(part) for part in rates))) / len(rates)
        items.append(Finding(f"{method}, {each.what}", mean, mean - half, mean + half, theirs - each.margin,
                             theirs + each.margin, theirs, theirs, runs=runs_of(*side)))
    return items


def _made(evidence: Evidence, each: Quantity, experiment: str) -> list[list[pd.DataFrame]] | Missing:
    """Attempts at demonstrations, one table a task, of both sides."""
    sides = [{**each.where, **side} for side in (each.one, each.other)]
    made = [[evidence.rows(experiment, side, where) for where in each.repetitions] for side in sides]
    if any(rows.empty for side in made for rows in side):
        return evidence.missing(each.what, experiment, *sides)
    return made

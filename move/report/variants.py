"""Variants of one method against each other: what moves, how fast, by which law, what is random; as tables.

Each table has the columns of `move.report.differences.difference_table`, with the variant, and the one that it is held
against in the column `baseline`. Holm's adjustment is over the rows of one task (and of one part, for speeds).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pandas as pd

from move.report.differences import COLUMNS, as_columns, with_holm
from move.statistics.cells import successes, training_noise
from move.statistics.estimates import UNKNOWN, TrainingNoise, difference, unpaired_difference

USUAL = {"object": 0.03, "target": 0.03, "camera": 1.0}
"""The speeds used everywhere else: metres per step, and degrees per step of the camera."""
COMPARED = ("baseline", *COLUMNS)


def step_table(episodes: pd.DataFrame, noise: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Each rung of figure 6 against the one before, and each motion alone against nothing, task by task."""
    rows = []
    for task, group in episodes.groupby("task", sort=False):
        rungs = [name for name in group.moves.unique() if "alone" not in name]
        pairs = [*zip(rungs[1:], rungs, strict=False),
                 *((name, "nothing") for name in group.moves.unique() if "alone" in name)]
        rows += _compared(group, "moves", pairs, noise, {"task": task})
    return pd.DataFrame(rows, columns=["task", "moves", *COMPARED])


def speed_table(episodes: pd.DataFrame, noise: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Each speed of figure 7 against the one used everywhere else, task by task and part by part."""
    rows = []
    for (task, part), group in episodes.groupby(["task", "part"], sort=False):
        pairs = [(speed, USUAL[part]) for speed in sorted(group.speed.unique()) if speed != USUAL.get(part, speed)]
        rows += _compared(group, "speed", pairs, noise, {"task": task, "part": part})
    return pd.DataFrame(rows, columns=["task", "part", "speed", *COMPARED])


def law_table(episodes: pd.DataFrame, noise: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Each other law of the speeds against the paper's, Beta(2, 5)."""
    pairs = [(law, "beta") for law in episodes.law.unique() if law not in ("beta", "static")]
    return pd.DataFrame(_compared(episodes, "law", pairs, noise, {}), columns=["law", *COMPARED])


def share_table(episodes: pd.DataFrame, noise: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Each share of MOVE against none."""
    pairs = [(share, 0.0) for share in sorted(episodes.share.unique()) if share]
    return pd.DataFrame(_compared(episodes, "share", pairs, noise, {}), columns=["share", *COMPARED])


def factor_table(episodes: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Static with more random (table 1) against static with the object alone; other factors, other configurations."""
    cells = {factors: successes(rows) for factors, rows in
             episodes[episodes.method == "static"].groupby("factors", sort=False)}
    noise = training_noise(episodes, ["factors", "method"], known)
    rows = [{"method": "static", "factors": more, "baseline": "object",
             **as_columns(unpaired_difference(cells[more], cells["object"], noise))}
            for more in cells if "object" in cells and more != "object"]
    return pd.DataFrame(with_holm(rows), columns=["method", "factors", *COMPARED])


def _compared(
    episodes: pd.DataFrame, column: str, pairs: Iterable[tuple], known: TrainingNoise, named: dict
) -> list[dict]:
    """One row a pair of values of `column` that both are there; the first minus the second."""
    cells: dict[object, np.ndarray] = {value: successes(rows) for value, rows in episodes.groupby(column)}
    noise = training_noise(episodes, [column, "method"], known)
    there = [pair for pair in pairs if set(pair) <= set(cells)]
    return with_holm([{**named, column: one, "baseline": other,
                       **as_columns(difference(cells[one], cells[other], noise))} for one, other in there])

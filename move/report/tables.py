"""Tables: from episodes to rates with intervals, tidy and ready to be drawn, written or read aloud."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move.study.statistics import success_rate


def successes(episodes: pd.DataFrame) -> np.ndarray:
    """The successes of one method as an array (seeds, configurations), in the order of the trials."""
    return episodes.pivot(index="seed", columns="trial", values="success").to_numpy(dtype=float)


def rate_table(episodes: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """One row a group: success rate, its 95 % interval, each seed's own rate, numbers of seeds and episodes.

    Args:
        episodes: rows as `move.study.results.table` gives them, with the columns `by`.
    """
    rows = []
    for key, group in episodes.groupby(by, sort=False):
        per_seed = successes(group)
        rate = success_rate(per_seed)
        rows.append({**dict(zip(by, key, strict=True)), "value": rate.value, "low": rate.low, "high": rate.high,
                     "seeds": per_seed.mean(axis=1).round(4).tolist(), "episodes": rate.episodes})
    return pd.DataFrame(rows)


def with_paper(table: pd.DataFrame, values: dict[str, float]) -> pd.DataFrame:
    """`table` with a column `paper`: the paper's value for each method, NaN where it has none."""
    return table.assign(paper=table.method.map(values))

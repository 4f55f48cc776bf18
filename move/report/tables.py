"""Tables: from episodes to rates with intervals, tidy and ready to be drawn, written or read aloud."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move.report.style import NAMES
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


def printed_trials(table: pd.DataFrame) -> pd.DataFrame:
    """Table 3 as it is printed: counts, per cent with the exact interval, scores with the range they could have.

    Args:
        table: from `move.study.realworld.trials.real_table`.
    """
    rows = [
        {"timesteps": f"{row.timesteps // 1000}k", "method": NAMES[row.method],
         "successes": f"{row.successes}/{row.trials}", "success": f"{100 * row.rate:.1f} %",
         "95 % interval": f"{100 * row.low:.1f} to {100 * row.high:.1f} %", "score": f"{row.normalised:.3f}",
         "allowed score": f"{row.score_low:.3f} to {row.score_high:.3f}"}
        for row in table.itertuples()
    ]
    return pd.DataFrame(rows)


def printed_pairs(table: pd.DataFrame) -> pd.DataFrame:
    """Pairs of cells with the methods' display names, from `move.study.realworld.trials.comparisons`."""
    cells = {column: [cell.split() for cell in table[column]] for column in ("first", "second")}
    return table.assign(**{column: [f"{NAMES[method]} {size}" for method, size in cell]
                           for column, cell in cells.items()})

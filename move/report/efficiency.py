"""Data efficiency of MOVE against static, task by task, as a table and in words."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move.paper import published
from move.report.differences import COLUMNS, LEVEL, as_columns, spoken_difference, with_holm
from move.sim.tasks import TASKS, get_task
from move.statistics.cells import by_budget, successes, training_noise
from move.statistics.data_efficiency import Efficiency, data_efficiency
from move.statistics.estimates import UNKNOWN, TrainingNoise, difference

EFFICIENCY = ["task", "timesteps", "ratio", "low", "high", "least", "most", "p", "holm"]
EQUAL = ["task", "move_timesteps", "static_timesteps", *COLUMNS]


def efficiency_table(episodes: pd.DataFrame, most_timesteps: int, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Static's timesteps over MOVE's for MOVE's success at table 2's budget: one row a task that has both curves.

    `p` is of a factor that is not surely above 1, `holm` the same after Holm's adjustment over the tasks.

    Args:
        episodes: of static and MOVE, with the columns task and timesteps.
        most_timesteps: the cap on table 2's budgets.
        known: as for `move.report.tables.rate_table`.
    """
    noise, rows = training_noise(episodes, ["task", "method", "timesteps"], known), []
    for task, group in episodes.groupby("task", sort=False):
        curves, budget = by_budget(group), get_task(task).budget(most_timesteps)
        if min(map(len, curves.values())) > 1 and budget in curves["move"]:
            found = data_efficiency(curves["static"], curves["move"], budget, noise)
            rows.append({"task": task, "timesteps": budget, **vars(found), "p": found.p_value(1.0)})
    return pd.DataFrame(with_holm(rows), columns=EFFICIENCY)


def spoken_efficiency(table: pd.DataFrame) -> str:
    """The table in words: each task's factor with its interval, and the median task."""
    if table.empty:
        return "No task has two budgets of both methods yet."
    each = "; ".join(f"{TASKS[row.task].title} {_efficiency(row)}" for row in table.itertuples())
    whole, clear = int((table.low > 1).sum()), int((table.holm < LEVEL).sum())
    return (f"Static's timesteps over MOVE's for the same success: {each}. Median task {_median(table)}; above "
            f"1 with its whole interval on {whole} of {len(table)}, after Holm's adjustment on {clear}.")


def _median(table: pd.DataFrame) -> str:
    """The median factor; of one that is "more than" nothing but that bound is known, so the median may be a bound."""
    least, most = np.median(np.minimum(table.ratio, table.most)), np.median(table.ratio)
    if np.isinf(most):
        return f"> {least:.2g}"
    return f"{most:.2g}" if least == most else f"between {least:.2g} and {most:.2g}"


def equal_budgets(episodes: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """MOVE minus static at the budgets that the paper calls equally good: one row a task, a difference where computed.

    Holm's adjustment is over the rows that are computed.
    """
    noise = training_noise(episodes, ["task", "method", "timesteps"], known)
    said = published("fig4_scaling", "timesteps", condition="equally good")
    computed, missing = [], []
    for task, group in said[said.task.isin(episodes.task)].groupby("task", sort=False):
        budgets = group.set_index("method").value.astype(int)
        cells = [successes(rows) for method in ("move", "static") if len(rows := episodes[
            (episodes.task == task) & (episodes.method == method) & (episodes.timesteps == budgets[method])])]
        row = {"task": task, "move_timesteps": budgets.move, "static_timesteps": budgets.static}
        if len(cells) == 2:
            computed.append({**row, **as_columns(difference(cells[0], cells[1], noise))})
        else:
            missing.append(row)
    return pd.DataFrame(with_holm(computed) + missing, columns=EQUAL)


def spoken_equal(table: pd.DataFrame) -> str:
    """A table of `equal_budgets` in words: each pair of budgets with what came out, or that it is missing."""
    return "; ".join(
        f"{TASKS[row.task].title}, MOVE at {row.move_timesteps:,} timesteps minus static at {row.static_timesteps:,} "
        f"(the paper: equal): {spoken_difference(row) if pd.notna(row.difference) else 'not computed yet'}"
        for _, row in table.iterrows()) or "None of these tasks has budgets that the paper calls equal"


def _efficiency(row) -> Efficiency:
    return Efficiency(row.ratio, row.low, row.high, row.least, row.most)

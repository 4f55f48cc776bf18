"""Data efficiency of MOVE against static, task by task, as a table and in words."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move.paper import published
from move.report.differences import gap, spoken_gap
from move.sim.tasks import TASKS, get_task
from move.study.statistics.cells import successes, training_noise
from move.study.statistics.data_efficiency import Efficiency, data_efficiency
from move.study.statistics.estimates import UNKNOWN, TrainingNoise, difference

COLUMNS = ["task", "timesteps", "ratio", "low", "high", "least", "most"]


def efficiency_table(episodes: pd.DataFrame, most_timesteps: int, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Static's timesteps over MOVE's for MOVE's success at table 2's budget: one row a task that has both curves.

    Args:
        episodes: of static and MOVE, with the columns task and timesteps.
        most_timesteps: the cap on table 2's budgets.
        known: as for `move.report.tables.rate_table`.
    """
    noise, rows = training_noise(episodes, ["task", "method", "timesteps"], known), []
    for task, group in episodes.groupby("task", sort=False):
        curves = {method: {budget: successes(cell) for budget, cell in rows_of.groupby("timesteps")}
                  for method, rows_of in group.groupby("method")}
        budget = min(get_task(task).timesteps, most_timesteps)
        static, move = curves.get("static", {}), curves.get("move", {})
        if min(len(static), len(move)) > 1 and budget in move:
            found = data_efficiency(static, move, budget, noise)
            rows.append({"task": task, "timesteps": budget, **vars(found)})
    return pd.DataFrame(rows, columns=COLUMNS)


def spoken_efficiency(table: pd.DataFrame) -> str:
    """The table in words: each task's factor with its interval, and the median task."""
    if table.empty:
        return "No task has two budgets of both methods yet."
    each = "; ".join(f"{TASKS[row.task].title} {_efficiency(row)}" for row in table.itertuples())
    clear = int((table.low > 1).sum())
    median = np.median(table.ratio)
    told = f"{median:.2g}" if np.isfinite(median) else f"> {table.most.max():.2g}"
    return (f"Static's timesteps over MOVE's for the same success: {each}. Median task {told}; above "
            f"1 with its whole interval on {clear} of {len(table)}.")


def said_to_be_equal(episodes: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> list[str]:
    """The pairs of budgets that the paper calls equally good, one sentence each: what came out, or what is missing."""
    noise = training_noise(episodes, ["task", "method", "timesteps"], known)
    said = published("fig4_scaling", "timesteps", condition="equally good")
    lines = []
    for task, group in said[said.task.isin(episodes.task)].groupby("task", sort=False):
        budgets = group.set_index("method").value.astype(int)
        claim = f"{TASKS[task].title}, MOVE at {budgets.move:,} timesteps minus static at {budgets.static:,}"
        cells = [successes(rows) for method in ("move", "static") if len(rows := episodes[
            (episodes.task == task) & (episodes.method == method) & (episodes.timesteps == budgets[method])])]
        if len(cells) < 2:
            lines.append(f"{claim} (the paper: equal): not computed yet")
            continue
        found = difference(cells[0], cells[1], noise)
        lines.append(f"{claim} (the paper: equal): "
                     f"{spoken_gap(pd.Series({**gap(found), 'holm': found.p_value}))}")
    return lines


def _efficiency(row) -> Efficiency:
    return Efficiency(row.ratio, row.low, row.high, row.least, row.most)

"""What data cover against what their policies do: a table, and in words."""

from __future__ import annotations

from collections.abc import Callable

import pandas as pd
from scipy import stats

from move.report.tables import rate_table
from move.sim import coverage
from move.sim.tasks import get_task
from move.statistics.estimates import UNKNOWN, TrainingNoise
from move.study.results import Result
from move.study.spec import PolicyRun


def coverage_table(
    results: list[Result], episodes: pd.DataFrame, timesteps: int, known: TrainingNoise = UNKNOWN,
    on_cell: Callable[[int, int], None] | None = None,
) -> pd.DataFrame:
    """One row a task and what moves in its data: success with its interval, and shares of cells that the data visit.

    Columns task, moves, method, value, low, high; object, target, camera and joint (object position and camera angle
    together), measured on the first seed's data, of which the first `timesteps` are collected again without images.

    Args:
        results: with the labels task and moves.
        episodes: of the same results.
        on_cell: called with (cells done, cells in all).
    """
    first = {(result.spec.task, result.labels["moves"]): result.spec for result in reversed(results)
             if isinstance(result.spec, PolicyRun)}
    shares = []
    for (task, moves), spec in first.items():
        fewer = spec.collection.model_copy(update={
            "timesteps": min(timesteps, spec.collection.timesteps), "observation": "keypoints"})
        seen = coverage.configurations(fewer, spec.seed)
        shares.append({"task": task, "moves": moves, "joint": coverage.visited_joint_share(seen, get_task(task)),
                       **{part: coverage.visited_share(seen, get_task(task), part) for part in coverage.PARTS}})
        if on_cell:
            on_cell(len(shares), len(first))
    rates = rate_table(episodes, ["task", "moves", "method"], known)
    return rates.merge(pd.DataFrame(shares), on=["task", "moves"])


def spoken_coverage(table: pd.DataFrame) -> str:
    """How success goes with joint coverage, in words: within tasks, and of MOVE's gain over the tasks' gains."""
    several = table[table.groupby("task").task.transform("size") > 1]
    if len(several) < 3:
        return "Fewer than three cells are stored."
    centred = several[["joint", "value"]] - several.groupby("task")[["joint", "value"]].transform("mean")
    within = stats.spearmanr(centred.joint, centred.value)
    said = [f"Within tasks ({len(several)} cells of {several.task.nunique()}) success and joint coverage have the rank "
            f"correlation {within.statistic:+.2f} (p = {within.pvalue:.3f})"]
    ends = table[table.moves.isin(["nothing", "all"])].pivot(index="task", columns="moves", values=["joint", "value"])
    ends = ends.reindex(columns=pd.MultiIndex.from_product([["joint", "value"], ["nothing", "all"]])).dropna()
    if len(ends) > 2:
        gains = {name: ends[name]["all"] - ends[name]["nothing"] for name in ("joint", "value")}
        over = stats.spearmanr(gains["joint"], gains["value"])
        said.append(f"over {len(ends)} tasks MOVE covers {100 * gains['joint'].min():+.0f} to "
                    f"{100 * gains['joint'].max():+.0f} points more than static, and that gain and its gain in success "
                    f"({100 * gains['value'].min():+.0f} to {100 * gains['value'].max():+.0f} points) have "
                    f"{over.statistic:+.2f} (p = {over.pvalue:.3f})")
    return "; ".join(said) + "."

"""Tables that several figures share: from episodes to rates with intervals, and their costs; `differences` of them."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move import paper
from move.errors import BadInput
from move.figures.page.printed import ABSENT, readable
from move.figures.plots.style import NAMES
from move.sim.collection import METHODS
from move.sim.tasks import TASKS
from move.statistics.cells import successes, training_noise
from move.statistics.estimates import success_rate
from move.statistics.intervals import wilson_interval
from move.statistics.training_noise import UNKNOWN, TrainingNoise
from move.study.results import Result
from move.study.spec import CollectionRun, PolicyRun


def rate_table(episodes: pd.DataFrame, by: list[str], known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """One row a group: success rate, 95 % interval, each seed's own rate, episodes, what the interval knows.

    The training noise is `known`, else what the groups tell. Column `trainings` is as in
    `move.statistics.estimates.Estimate`, and "none" for an agent that is not trained.

    Args:
        episodes: rows as `move.study.results.table` gives them, with the columns `by`.
        known: the training noise of like cells elsewhere, known from more cells than this table has.
    """
    noise, rows = training_noise(episodes, by, known), []
    for key, group in episodes.groupby(by, sort=False):
        per_seed, trained = successes(group), group.method.isin(METHODS).all()
        rate = success_rate(per_seed, noise if trained else UNKNOWN)
        rows.append({**dict(zip(by, key, strict=True)), "value": rate.value, "low": rate.low, "high": rate.high,
                     "seeds": per_seed.mean(axis=1).round(4).tolist(), "episodes": rate.episodes,
                     "trainings": rate.trainings if trained else "none"})
    return pd.DataFrame(rows, columns=[*by, "value", "low", "high", "seeds", "episodes", "trainings"])


def with_paper(table: pd.DataFrame, experiment: str, on: list[str], metric: str = "success", column: str = "paper",
               **where: str) -> pd.DataFrame:
    """`table` with the paper's value in each row, NaN where the paper gives none.

    Args:
        on: the columns of `table` that tell rows apart in the paper: its task, method or baseline; one column of
            another name holds the paper's condition.
        metric: as in `move.paper.PAPER`, or "difference": MOVE's success minus that of the method in column `baseline`.
        column: the name of the new column.
        where: what else the paper's rows must be, such as condition="simulation".

    Raises:
        BadInput: the paper has no such value, or several for one row of `table`.
    """
    rows = paper.published(experiment, metric, **where)
    names = {name if name in rows else "condition": name for name in on}
    if len(names) < len(on) or rows.duplicated(list(names)).any():
        raise BadInput(f"on: {on} given; allowed are columns that tell the paper's values of {experiment} apart, with "
                       "at most one for its condition")
    values = rows.rename(columns=names).set_index(on).value.rename(column)
    return table.join(values, on=on)


def grasp_points(results: list[Result]) -> pd.DataFrame:
    """Where each demonstration of each run grasped the object: method, seed, object_x, object_y (metres)."""
    return pd.DataFrame([
        {"method": result.spec.method, "seed": result.spec.seed, "object_x": x, "object_y": y}
        for result in results if result.collection
        for x, y in result.collection["grasp_points"]
    ])


def demonstrations_made(results: list[Result], by: str) -> pd.DataFrame:
    """How many demonstrations a data set has, one row a value of the label `by` and method: the mean of the seeds."""
    rows = pd.DataFrame([{by: result.labels[by], "method": result.spec.method,
                          "demonstrations": result.collection["demonstrations"],
                          "timesteps": result.spec.collection.timesteps} for result in results
                         if isinstance(result.spec, PolicyRun) and result.collection])
    return rows.groupby([by, "method"], sort=False).mean().reset_index()


def printed_success(tasks: list[str]) -> pd.DataFrame:
    """The paper's success of table 2 at the budgets of its table 5: task, method, timesteps, value."""
    budgets = paper.published("table5_data_sizes", "timesteps").set_index("task").value.rename("timesteps")
    rates = paper.published("table2_main")[["task", "method", "value"]]
    return rates[rates.task.isin(tasks)].join(budgets, on="task")


def run_costs(results: list[Result]) -> pd.DataFrame:
    """Core-minutes of the runs' parts: one row a method and budget, the median run, and how many runs there are.

    Args:
        results: of runs that train a policy.
    """
    rows = pd.DataFrame([
        {"method": result.spec.method, "timesteps": result.spec.collection.timesteps,
         **{part: seconds / 60 for part, seconds in result.seconds.items()},
         "whole": sum(result.seconds.values()) / 60}
        for result in results if result.spec.training
    ])
    if rows.empty:
        return pd.DataFrame(columns=["timesteps", "method", "whole", "runs", "all_runs"])
    groups = rows.groupby(["timesteps", "method"], sort=False)
    return groups.median().round(1).assign(runs=groups.size(), all_runs=groups.whole.sum().round(0)).reset_index()


def collection_costs(results: list[Result]) -> pd.DataFrame:
    """One row a task, method and expert: attempts, share that succeeded with its interval, mean steps of those.

    Columns generation_rate_error and mean_steps_error are standard errors, the former with two successes and two
    failures more, so that it is never 0. Column `jumps` is the mean number of jumps of a demonstration, NaN for a
    method that has none.

    Args:
        results: of runs whose agent is "collector".
    """
    rows = []
    for result, spec in [(result, result.spec) for result in results if isinstance(result.spec, CollectionRun)]:
        attempts = len(result.rows)
        kept = [row for row in result.rows if row["success"]]
        rate, steps = len(kept) / attempts, [row["steps"] for row in kept]
        low, high = wilson_interval(rate, attempts)
        kinder = (len(kept) + 2) / (attempts + 4)
        jumps = [row["jumps"] for row in kept if "jumps" in row]
        rows.append({"task": spec.task, "method": spec.method, "expert": spec.collection.expert,
                     "attempts": attempts, "generation_rate": rate, "low": low, "high": high,
                     "generation_rate_error": float(np.sqrt(kinder * (1 - kinder) / attempts)),
                     "mean_steps": float(np.mean(steps)) if steps else np.nan,
                     "mean_steps_error": float(pd.Series(steps, dtype=float).sem()),
                     "jumps": float(np.mean(jumps)) if jumps else np.nan})
    return pd.DataFrame(rows)


def controls(episodes: pd.DataFrame) -> pd.DataFrame:
    """Success rate of each control on each task: one row a task, one column a control."""
    rows = episodes[episodes.kind == "control"]
    return rows.pivot_table("success", "task", "method", aggfunc="mean", sort=False)


def with_level(rates: pd.DataFrame, floors: pd.DataFrame) -> pd.DataFrame:
    """`rates` with a column `level`: where a rate lies from what a goal-blind expert scores (0) to the expert (1).

    A policy that ignores the target is near 0, however often that succeeds by chance; below it lies one that does not
    get so far. NaN for a task without a target, or where a control is missing.

    Args:
        rates: with the columns task and value.
        floors: as `controls` gives them.
    """
    blind, expert = (rates.task.map(floors[name] if name in floors else {}) for name in ("goal-blind", "expert"))
    return rates.assign(level=(rates.value - blind) / (expert - blind))


def task_layout(rates: pd.DataFrame, floors: pd.DataFrame, means: pd.DataFrame | None = None) -> pd.DataFrame:
    """A table for print: one row a task, for each method its rate and the paper's; floor, ceiling, mean row.

    Args:
        rates: task, method, value, low, high; paper where the paper gives any.
        floors: as `controls` gives them.
        means: method, value and, where the paper gives any, paper: the last row.
    """
    if rates.empty:
        return readable(rates)
    text = readable(rates).assign(task=rates.task, method=rates.method)
    printed = [name for name in ("Success (%)", "Paper (%)") if name in text]
    wide = text.pivot(index="task", columns="method", values=printed).reindex(rates.task.unique())
    names = {"Success (%)": "here", "Paper (%)": "paper"}
    columns = {(NAMES[method], names[kind]): wide[kind, method] for method in rates.method.unique() for kind in printed}
    for control in ("expert", "goal-blind"):
        values = floors[control].reindex(wide.index) if control in floors else pd.Series(np.nan, wide.index)
        columns[NAMES[control], ""] = values.map(lambda value: ABSENT if pd.isna(value) else f"{100 * value:.1f}")
    table = pd.DataFrame(columns).fillna(ABSENT)
    table.insert(0, ("Task", ""), [TASKS[task].title for task in table.index])
    if means is not None:
        last = readable(means).assign(method=means.method).set_index("method")
        row = {(NAMES[method], names[kind]): last.loc[method, kind] for method in last.index for kind in printed}
        table.loc["mean"] = pd.Series({("Task", ""): f"mean of {len(table)}", **row}).reindex(table.columns)
    return table.fillna(ABSENT).reset_index(drop=True)


def rates_text(rates: pd.DataFrame, column: str = "value") -> str:
    """A table of one rate a method in words: "static 79.2%, MOVE 91.7%"."""
    return ", ".join(f"{NAMES[method]} {value:.1%}" for method, value in zip(rates.method, rates[column], strict=True)
                     ) or "nothing is computed yet"


def points(difference: float) -> str:
    """A difference of rates in whole points with its sign; never "-0"."""
    return f"{round(100 * difference):+d}"

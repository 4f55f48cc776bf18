"""Figure 4: success against the amount of data, data efficiency, and the budgets that the paper calls equally good."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field

from move.figures import plots
from move.figures.page.captions import INTERVALS, POOLED, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Seeds
from move.figures.page.printed import readable
from move.figures.plots.panels import empty_panel
from move.figures.plots.style import COLUMN_WIDTH, PAGE_WIDTH, titles
from move.figures.tables import controls, printed_success, rate_table, with_level
from move.figures.tables.differences import COLUMNS, LEVEL, as_columns, clear_counts, with_holm
from move.paper import PAPER_METHODS, PAPER_TASKS, published
from move.sim.tasks import TASKS, get_task
from move.statistics.cells import by_budget, successes, training_noise
from move.statistics.data_efficiency import Efficiency, data_efficiency
from move.statistics.estimates import difference
from move.statistics.training_noise import UNKNOWN, TrainingNoise
from move.study.axes import budgets, floors_and_ceilings
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, distinct, grid
from move.study.profiles import Profile

BY = ["task", "timesteps", "method"]
EQUALLY_GOOD = published("fig4_scaling", "timesteps", condition="equally good")
EFFICIENCY = ["task", "timesteps", "ratio", "low", "high", "least", "most", "p", "holm"]
EQUAL = ["task", "move_timesteps", "static_timesteps", *COLUMNS]


def runs(
    profile: Profile, tasks: tuple[str, ...] = PAPER_TASKS,
    timesteps: tuple[Count, ...] = (5000, 10_000, 20_000, 40_000),
    short_timesteps: tuple[Count, ...] = (2500, 5000, 10_000, 20_000), seeds: Seeds = 1, table_seeds: Seeds = 3,
    pairs: Annotated[bool, Field(strict=True)] = True, episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Static and MOVE from pixels at growing budgets, all three methods at table 2's.

    A larger budget begins with the smaller one's demonstrations. `pairs` adds the budgets that the paper says do
    equally well. Each task's floor and ceiling say where a rate lies between them.

    Args:
        short_timesteps: the budgets of tasks to which table 5 gives fewer than `most_timesteps`.
        table_seeds: repetitions at table 2's own budget, `most_timesteps` at most.
    """
    base = partial(policy_run, profile, episodes=episodes)
    runs: list[LabelledRun] = []
    for task in tasks:
        short = get_task(task).timesteps < most_timesteps
        runs += grid(base, seed=range(seeds), task=[task], timesteps=short_timesteps if short else timesteps,
                     method=("static", "move"))
        runs += grid(base, seed=range(table_seeds), task=budgets([task], most_timesteps), method=PAPER_METHODS)
        for row in EQUALLY_GOOD[EQUALLY_GOOD.task == task].itertuples() if pairs and seeds else ():
            runs += grid(base, seed=[0], task=[task], timesteps=[int(row.value)], method=[row.method])
    return distinct(runs + floors_and_ceilings(tasks, episodes) * bool(runs))


def tables(data: Data, *, most_timesteps: int) -> dict[str, pd.DataFrame]:
    """Rates at every budget, data efficiency, and the differences at budgets that the paper calls equally good."""
    noise, tried = data.noise(), data.episodes[data.episodes.kind == "policy"]
    return {
        "": with_level(rate_table(tried, BY, noise), controls(data.episodes)),
        "efficiency": efficiency_table(tried[tried.method != "adc"], most_timesteps, noise),
        "equal": equal_budgets(tried, noise),
    }


def efficiency_table(episodes: pd.DataFrame, most_timesteps: int, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """Static's timesteps over MOVE's for MOVE's success at table 2's budget: one row a task that has both curves.

    `p` is of a factor that is not surely above 1, `holm` the same after Holm's adjustment over the tasks.

    Args:
        episodes: of static and MOVE, with the columns task and timesteps.
        most_timesteps: the cap on table 2's budgets.
        known: as for `move.figures.tables.rate_table`.
    """
    noise, rows = training_noise(episodes, ["task", "method", "timesteps"], known), []
    for task, group in episodes.groupby("task", sort=False):
        curves, budget = by_budget(group), get_task(task).budget(most_timesteps)
        if min(map(len, curves.values())) > 1 and budget in curves["move"]:
            found = data_efficiency(curves["static"], curves["move"], budget, noise)
            rows.append({"task": task, "timesteps": budget, **vars(found), "p": found.p_value(1.0)})
    return pd.DataFrame(with_holm(rows), columns=EFFICIENCY)


def equal_budgets(episodes: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """MOVE minus static at the budgets that the paper calls equally good: one row a task, a difference where computed.

    Holm's adjustment is over the rows that are computed.
    """
    noise = training_noise(episodes, ["task", "method", "timesteps"], known)
    computed, missing = [], []
    for task, group in EQUALLY_GOOD[EQUALLY_GOOD.task.isin(episodes.task)].groupby("task", sort=False):
        budgets = group.set_index("method").value.astype(int)
        cells = [successes(rows) for method in ("move", "static") if len(rows := episodes[
            (episodes.task == task) & (episodes.method == method) & (episodes.timesteps == budgets[method])])]
        row = {"task": task, "move_timesteps": budgets.move, "static_timesteps": budgets.static}
        if len(cells) == 2:
            computed.append({**row, **as_columns(difference(cells[0], cells[1], noise))})
        else:
            missing.append(row)
    return pd.DataFrame(with_holm(computed) + missing, columns=EQUAL)


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """Each task's factor as it is known: one beyond the budgets that were tried is "more than" their bound."""
    table = tables["efficiency"]
    text = readable(table)
    if len(table):
        text["Factor"] = [str(Efficiency(row.ratio, row.low, row.high, row.least, row.most))
                          for row in table.itertuples()]
    return {"efficiency": text}


def draw(tables: dict[str, pd.DataFrame], data: Data, *, tasks: tuple[str, ...]) -> dict[str, Figure]:
    """One panel a task: success against timesteps with the paper's values; and one line a task: data efficiency."""
    rates, printed = data.with_missing(tables[""], BY), printed_success(list(tasks))
    factors = tables["efficiency"].set_index("task").reindex(list(tasks)).rename_axis("task").reset_index()
    efficiency, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.efficiencies(factors, ax)
    return {"fig4_scaling": _curves(rates, printed), "fig4_efficiency": efficiency}


def _curves(rates: pd.DataFrame, printed: pd.DataFrame) -> Figure:
    figure, axes = plt.subplots(2, 5, figsize=(PAGE_WIDTH, 3.5), sharey=True)
    for ax, task in zip(axes.flat, PAPER_TASKS, strict=True):
        shown = rates[rates.task == task]
        if len(shown):
            plots.curve(shown, "timesteps", "timesteps", ax, log=True)
            theirs = printed[printed.task == task]
            plots.printed_points(theirs, ax)
            plots.log_ticks({*shown.timesteps, *theirs.timesteps}, ax)
        else:
            empty_panel("missing", ax)
        ax.label_outer(remove_inner_ticks=False)
        ax.tick_params(labelbottom=True)
        ax.set_ylabel("success (%)" if ax in axes[:, 0] else "")
    titles(list(axes.flat), [TASKS[task].title for task in PAPER_TASKS])
    known = plots.entries(list(rates.method.unique()), "paper, in the method's colour", bool(rates.value.isna().any()))
    figure.legend(handles=[*known, *plots.pooled_entry(rates)], ncol=6, loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The median task's factor, and on how many pairs of budgets that are said to be equal MOVE is not level."""
    return (
        "**The paper:** MOVE always ahead; data efficiency up to 2-5x on certain tasks. **Here:** "
        f"{efficiency_text(tables['efficiency'])} {equal_text(tables['equal'])}. **How sure:** {data.sample_size}")


def efficiency_text(table: pd.DataFrame) -> str:
    """The table in words: the median task's factor, and on how many tasks it is above 1."""
    if table.empty:
        return "No task has two budgets of both methods yet."
    whole, clear = int((table.low > 1).sum()), int((table.holm < LEVEL).sum())
    return (f"Static's timesteps over MOVE's: Median task {_median(table)}; above 1 with its whole interval on {whole} "
            f"of {len(table)}, after Holm's adjustment on {clear}.")


def _median(table: pd.DataFrame) -> str:
    """The median factor; of one that is "more than" nothing but that bound is known, so the median may be a bound."""
    least, most = np.median(np.minimum(table.ratio, table.most)), np.median(table.ratio)
    if np.isinf(most):
        return f"> {least:.2g}"
    return f"{most:.2g}" if least == most else f"between {least:.2g} and {most:.2g}"


def equal_text(table: pd.DataFrame) -> str:
    """A table of `equal_budgets` in words: how many of the computed pairs differ."""
    there = table.dropna(subset="difference")
    counts = clear_counts(there)
    return f"Budgets called equal: {counts['above']} of {len(there)} are above 0, {counts['below']} below"


WORDS = Words(
    title="Figure 4. Success against the amount of data",
    shown=(
        f"Success of each method against the timesteps of demonstrations, one panel a task, at table 2's "
        f"configurations. {INTERVALS} Diamonds are the paper's values at its own budgets, question marks "
        f"budgets that are not computed yet. {POOLED}"),
    alt="Ten small panels, one a task, each with a curve a method over the budget.",
    tables={
        "": f"Figure 4: success against the amount of data. {RATES}",
        "efficiency": (
            "Figure 4: static's timesteps over MOVE's for the success that MOVE has at table 2's "
            "budget, with 95 % intervals, and the least and most that could have been found."),
        "equal": (
            "Figure 4: MOVE minus static at the budgets that the paper calls equally good; in points, "
            "with 95 % intervals."),
    },
    others={
        "fig4_efficiency": Words(
            title="Figure 4, as one number: data efficiency",
            shown=(
                "How many times the timesteps static needs to succeed as often as MOVE does at table 2's budget, with "
                "95 % intervals. A hollow point with an arrow says more than: static does not get there with the data "
                "it was given."),
            alt="One line a task with a point and an interval on a logarithmic axis of factors from a quarter to four.",
        ),
    },
)

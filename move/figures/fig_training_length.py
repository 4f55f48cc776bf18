"""Does MOVE minus static depend on how long one trains? The recipe's gradient steps, fewer and more."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Multiple, Repeats
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import COLUMNS, as_columns, difference_brief, differences_at, largest, with_holm
from move.sim.tasks import TASKS
from move.statistics.cells import successes, training_noise
from move.statistics.estimates import contrast, mean_contrast
from move.statistics.training_noise import UNKNOWN, TrainingNoise
from move.study.axes import budgets
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

BY = ["task", "length", "method"]
CHANGE = (1.0, -1.0, -1.0, 1.0)  # of MOVE and static late, MOVE and static early


def runs(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "push", "window-open"),
    lengths: tuple[Multiple, ...] = (1 / 3, 1, 3), seeds: Repeats = 2, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Policies of table 2 from pixels, trained for the recipe's gradient steps times each of `lengths`.

    Nothing is chosen by the answer.
    """
    return grid(partial(policy_run, profile, episodes=episodes),
                length={round(length, 3): {"length": length} for length in lengths}, seed=range(seeds),
                task=budgets(tasks, most_timesteps), method=("static", "move"))


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates and differences at each length, and how the difference changes over all lengths and beyond the recipe's."""
    noise, trained = data.noise(), data.episodes
    return {
        "": rate_table(trained, BY, noise),
        "differences": differences_at(trained, "length", "task", noise),
        "depends": length_matters(trained, noise),
        "beyond": length_matters(trained[trained.length >= 1], noise),
    }


def length_matters(episodes: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """MOVE minus static at the longest training minus the same at the shortest: one row a task, and their mean.

    Columns task ("mean of n" last), then `COLUMNS`, of that change.

    Args:
        episodes: of static and MOVE, with the label `length` of their experiment.
    """
    noise = training_noise(episodes, ["task", "method", "length"], known)
    ends = [(method, length) for length in (episodes.length.max(), episodes.length.min())
            for method in ("move", "static")]
    cells_of: dict[str, list[np.ndarray]] = {}
    for task, group in episodes.groupby("task", sort=False):
        cells = {key: successes(part) for key, part in group.groupby(["method", "length"])}
        if set(ends) <= set(cells):
            cells_of[task] = [cells[end] for end in ends]
    rows = with_holm([{"task": task, **as_columns(contrast(cells, CHANGE, noise))} for task, cells in cells_of.items()])
    if len(cells_of) > 1:
        mean = mean_contrast(list(cells_of.values()), CHANGE, noise)
        rows.append({"task": f"mean of {len(cells_of)}", **as_columns(mean), "holm": mean.p_value})
    return pd.DataFrame(rows, columns=["task", *COLUMNS])


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """One panel a task: success against the length of training."""
    rates = data.with_missing(tables[""], BY)
    tasks = list(rates.task.unique())
    figure, axes = plt.subplots(1, len(tasks), figsize=(PAGE_WIDTH, 2.3), squeeze=False, sharey=True)
    for ax, task in zip(axes.flat, tasks, strict=True):
        plots.curve(rates[rates.task == task], "length", "gradient steps / the recipe's", ax, log=True)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
    titles(list(axes.flat), [TASKS[task].title for task in tasks])
    figure.legend(handles=[*plots.entries(list(rates.method.unique()), missing=bool(rates.value.isna().any())),
                           *plots.pooled_entry(rates)], ncol=4,
                  loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How MOVE minus static changes with the length of training, on the mean of the tasks and where it does most."""
    change, after = (f"{difference_brief(tables[suffix].iloc[-1])}" if len(tables[suffix]) else "not computed yet"
                     for suffix in ("depends", "beyond"))
    of = tables["depends"].task.iloc[-1] if len(tables["depends"]) else "tasks"
    return (
        f"**The paper** trains every policy for 220,000 steps. **Here**, {getattr(TASKS.get(of), 'title', of)}, MOVE "
        f"minus static changes from the shortest to the longest training by {change} points, from the recipe's length "
        f"to the longest by {after}{most_changed(tables['beyond'])}. **How sure:** {data.sample_size}")


def most_changed(table: pd.DataFrame) -> str:
    """Of a table as `length_matters` gives it the task that changes most, in words; none where there is one task."""
    tasks = table[table.task.isin(TASKS)]
    row = largest(tasks)
    return "" if row is None or len(tasks) < 2 else f", most on {TASKS[row.task].title} by {difference_brief(row)}"


WORDS = Words(
    title="Does the comparison depend on how long one trains?",
    shown=(
        f"Success against the number of gradient steps, in multiples of the recipe's, one panel a task. {INTERVALS} "
        f"Question marks are trainings that are not computed yet."),
    alt="One panel a task with a curve a method over the length of training.",
    tables={
        "": f"Length of training. {RATES}",
        "depends": (
            "MOVE minus static at the longest training, minus the same at the shortest; in "
            "points, with 95 % intervals."),
        "beyond": (
            "MOVE minus static at the longest training, minus the same at the recipe's own "
            "length; in points, with 95 % intervals."),
        "differences": f"At each length of training. {DIFFERENCES}",
    },
)

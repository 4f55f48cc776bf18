"""Failing to learn, to generalise, or to follow? Policies of table 2 at their own grasps, elsewhere, and in motion."""

from __future__ import annotations

import math
from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import DIFFERENCES, INTERVALS, POOLED, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, MethodName, Seeds
from move.figures.page.printed import readable
from move.figures.plots.style import NAMES, PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import above_text, difference_table
from move.learn.evaluation import Evaluation
from move.paper import PAPER_METHODS
from move.sim.tasks import TASKS
from move.sim.tasks.task import EPISODE_STEPS
from move.study.axes import budgets
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile
from move.study.spec import PolicyRun

TRIED = {"grasp": "own", "random": "elsewhere", "moving": "in_motion"}


def runs(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "push", "window-open"),
    methods: tuple[MethodName, ...] = PAPER_METHODS, seeds: tuple[Seeds, ...] = (1,), own_episodes: Count = 60,
    episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Policies of table 2 from pixels: where table 2 tries them, the same in motion, and at their own grasps.

    In motion everything moves as in demonstrations of MOVE. Every method's demonstrations show the scene as it is at
    the grasp, so the rates mean the same for all. A policy is trained once for all. No more of its own configurations
    are tried than its budget is sure to hold.
    """
    runs = grid(partial(policy_run, profile, episodes=episodes), seed=seeds, task=budgets(tasks, most_timesteps),
                method=methods)
    moving = Evaluation(starts="moving", episodes=episodes)
    return runs + [run.tried(tried) for run in runs for tried in (_own(run, own_episodes), moving)]


def _own(run: LabelledRun, episodes: int) -> Evaluation:
    assert isinstance(run.spec, PolicyRun)
    sure = max(1, run.spec.collection.timesteps // EPISODE_STEPS)
    return Evaluation(starts="grasp", episodes=min(episodes, sure))


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates side by side, with their intervals, and MOVE minus the others in motion."""
    noise = data.noise()
    rates = rate_table(data.episodes, ["task", "method", "group"], noise)
    moving = data.episodes[data.episodes.group == "moving"]
    return {"": own_and_elsewhere(rates), "rates": rates, "differences": difference_table(moving, "task", noise)}


def own_and_elsewhere(rates: pd.DataFrame) -> pd.DataFrame:
    """One row a task and method: rates at its own grasps, elsewhere (what is `lost`), and elsewhere in motion.

    Args:
        rates: as `rate_table` gives them by task, method and group ("grasp", "random" or "moving"); a missing one
            becomes NaN.
    """
    keys = ["task", "method"]
    wide = rates.pivot(index=keys, columns="group", values="value").reindex(columns=list(TRIED))
    wide = rates[keys].drop_duplicates().join(wide, on=keys).rename(columns=TRIED)
    return wide.assign(lost=wide.own - wide.elsewhere).reset_index(drop=True)


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """Each method's means over the tasks, and the task on which it has learnt least."""
    rows = [{"method": method, "tasks": len(rows), **rows[["own", "elsewhere", "lost", "in_motion"]].mean(),
             "Lowest at its own grasps": f"{TASKS[rows.task[rows.own.idxmin()]].title} ({100 * rows.own.min():.0f} %)"}
            for method, rows in tables[""].dropna().groupby("method", sort=False)]
    return {"means": readable(pd.DataFrame(rows))}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """One panel a task: each method's rates at its own grasps, elsewhere and in motion."""
    rates, tasks = tables["rates"], list(tables[""].task.unique())
    columns = min(len(tasks), 3)
    rows = math.ceil(len(tasks) / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(PAGE_WIDTH, 0.4 + 2.2 * rows), squeeze=False, sharey=True)
    for ax, task in zip(axes.flat, tasks, strict=False):
        plots.own_and_elsewhere(rates[rates.task == task], ax)
        ax.set_ylabel("success (%)" if ax in axes[:, 0] else "")
    for ax in axes.flat[len(tasks):]:
        ax.remove()
    titles(list(axes.flat[:len(tasks)]), [TASKS[task].title for task in tasks])
    figure.legend(handles=[*plots.entries(list(rates.method.unique())), *plots.pooled_entry(rates)], ncol=4,
                  loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Each method's means at its own grasps, elsewhere and in motion, and where MOVE is above the others in motion."""
    there = tables[""].dropna()
    each = "; ".join(f"{NAMES[method]} {rows.own.mean():.0%}, {rows.elsewhere.mean():.0%}, {rows.in_motion.mean():.0%}"
                     for method, rows in there.groupby("method", sort=False))
    return (
        "**The paper:** MOVE grasps moving targets; no numbers. **Here**, means of "
        f"{there.task.nunique()} tasks at own grasps, elsewhere, and in motion: {each or 'not computed yet'}. In "
        f"motion MOVE is {above_text(tables['differences'])} tasks. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Failing to learn, to generalise, or to follow?",
    shown=(
        f"Success of each policy at the grasps of its own demonstrations (fewer configurations than elsewhere, fewest "
        f"where a budget is small), at configurations that no training used, and at the same with everything in "
        f"motion. {INTERVALS} {POOLED}"),
    alt="One panel a task with a line a method over three places: its own grasps, elsewhere, in motion.",
    tables={
        "": (
            "Success in per cent at a policy's own grasps, elsewhere, and elsewhere in motion; what is lost "
            "from own grasps to elsewhere in points."),
        "rates": f"The same with intervals. {RATES}",
        "differences": f"In motion. {DIFFERENCES}",
    },
)

"""Ten tasks from keypoints, where perception is given, between each task's floor and ceiling."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.keypoint_control import UNUSED_IMAGE_SIZE
from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Seeds
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import controls, rate_table, rates_text, task_layout
from move.figures.tables.differences import (
    above_text,
    difference_means,
    difference_table,
    means_text,
    summary,
    tasks_table,
)
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.study.axes import floors_and_ceilings
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

REPEATED = True


def runs(
    profile: Profile, tasks: tuple[str, ...] = PAPER_TASKS, timesteps: Count = 2500, seeds: Seeds = 3,
    episodes: Count = 100, larger: Count = 10_000, larger_tasks: tuple[str, ...] = ("assembly", "hammer", "basketball"),
) -> list[LabelledRun]:
    """Each task, three methods at one budget, and each task's floor and ceiling.

    The tasks that stay near their floor, `larger_tasks`, get a `larger` budget as well, alike for all methods.
    """
    base = partial(policy_run, profile, observation="keypoints", image_size=UNUSED_IMAGE_SIZE, episodes=episodes)
    policies = [run for seed in range(seeds) for budget, some in ((timesteps, tasks), (larger, larger_tasks))
                for run in grid(base, seed=[seed], timesteps=[budget], task=some, method=PAPER_METHODS)]
    return policies + floors_and_ceilings(tasks, episodes)


def tables(data: Data, *, timesteps: int, larger: int) -> dict[str, pd.DataFrame]:
    """Rates at both budgets; at the smaller one differences, their mean, and the tasks as a sample."""
    noise = data.noise("keypoints")
    policies, more = (data.episodes[data.episodes.timesteps == budget] for budget in (timesteps, larger))
    return {
        "": rate_table(policies, ["task", "method"], noise),
        "larger": rate_table(more, ["task", "method"], noise),
        "differences": difference_table(policies, "task", noise),
        "differences_mean": difference_means(policies, "task", noise),
        "over_tasks": tasks_table(policies),
    }


def _means(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    return tables[""].groupby("method", sort=False, as_index=False).value.mean()


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """One row a task: each method's rate, floor, ceiling; the mean; and MOVE against each method in a row."""
    return {"": task_layout(tables[""], controls(data.episodes), _means(tables)),
            "summary": summary(tables["differences"], tables["differences_mean"], tables["over_tasks"])}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Ten tasks from keypoints between floor and ceiling."""
    figure, ax = plt.subplots(figsize=(PAGE_WIDTH, 2.7))
    plots.task_rates(tables[""], controls(data.episodes), ax)
    handles, _ = ax.get_legend_handles_labels()
    figure.legend(handles=[*handles, *plots.pooled_entry(tables[""])], ncol=6, loc="outside upper center")
    titles([ax], ["ten tasks, from keypoints"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Means over the tasks, MOVE minus the others on the mean, and where it is above them."""
    return (
        f"**The paper** has no results from keypoints. **Here, from keypoints:** means over "
        f"{tables[''].task.nunique()} tasks {rates_text(_means(tables))}; {means_text(tables['differences_mean'])}. "
        f"Single tasks: {above_text(tables['differences'])}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Ten tasks from keypoints, between floor and ceiling",
    shown=(
        f"Success from keypoints, where perception is given, at the smaller budget; solid lines are the expert, dashed "
        f"lines an expert that is told a wrong goal. {INTERVALS}"),
    alt="Points with intervals for ten tasks and three methods.",
    tables={
        "": (
            "From keypoints, perception given: success in per cent with 95 % intervals, the expert "
            "(ceiling) and an expert that is told a wrong goal (floor)."),
        "differences": f"From keypoints. {DIFFERENCES}",
        "differences_mean": f"From keypoints, mean of the tasks. {DIFFERENCES}",
        "over_tasks": (
            "From keypoints with the task as the unit: means and interquartile means in "
            "points and per cent, and the probability that MOVE is better on a task, in "
            "per cent."),
        "larger": f"From keypoints, perception given, at the larger budget. {RATES}",
    },
)

"""Table 2: ten tasks, static, ADC and MOVE from pixels, and the same table with perception given."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import COSTS, DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Seeds
from move.figures.page.printed import ABSENT, readable
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import controls, rate_table, rates_text, run_costs, task_layout, with_level, with_paper
from move.figures.tables.differences import (
    difference_means,
    difference_table,
    interval_text,
    means_text,
    summary,
    tasks_table,
)
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.sim.tasks import TASKS
from move.study.axes import budgets, floors_and_ceilings
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

REPEATED = True
SUFFIXES = {
    "rgb": ("", "differences", "differences_mean", "over_tasks"),
    "keypoints": ("keypoints", "differences_keypoints", "differences_keypoints_mean", "over_tasks_keypoints"),
}
"""The tables of each observation: rates, differences, their mean, and the tasks as a sample."""


def runs(
    profile: Profile, tasks: tuple[str, ...] = PAPER_TASKS, seeds: Seeds = 3, control_seeds: Seeds = 3,
    episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Each task, three methods, at the paper's budget but at `most_timesteps`; its floor and its ceiling.

    `seeds` from pixels and `control_seeds` from keypoints.
    """
    base = partial(policy_run, profile, episodes=episodes)
    policies = [run for observation, count in (("rgb", seeds), ("keypoints", control_seeds))
                for run in grid(partial(base, observation=observation), seed=range(count),
                                task=budgets(tasks, most_timesteps), method=PAPER_METHODS)]
    return policies + floors_and_ceilings(tasks, episodes)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """For each observation rates, differences, their mean, and the tasks as a sample; costs from pixels."""
    found: dict[str, pd.DataFrame] = {}
    for observation, suffixes in SUFFIXES.items():
        episodes, noise = data.episodes[data.episodes.observation == observation], data.noise(observation)
        rates = rate_table(episodes, ["task", "method"], noise)
        compared = difference_table(episodes, "task", noise)
        means = difference_means(episodes, "task", noise)
        if observation == "rgb":
            rates = with_paper(rates, "table2_main", on=["task", "method"])
            compared = with_paper(compared, "table2_main", on=["task", "baseline"], metric="difference")
            means = means.join(compared.groupby("baseline").paper.mean(), on="baseline")  # the paper's, of these tasks
        parts = with_level(rates, controls(data.episodes)), compared, means, tasks_table(episodes)
        found |= dict(zip(suffixes, parts, strict=True))
    found["costs"] = run_costs([result for result in data.results if result.spec.observation == "rgb"])
    return found


def _has_all_tasks(tables: dict[str, pd.DataFrame]) -> bool:
    return tables[""].task.nunique() == len(PAPER_TASKS)


def _means(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Each method's mean over the tasks, and the paper's: its own number of all ten, of fewer its tasks' mean."""
    if not _has_all_tasks(tables):
        return tables[""].groupby("method", sort=False, as_index=False)[["value", "paper"]].mean()
    means = tables[""].groupby("method", sort=False, as_index=False).value.mean()
    return with_paper(means, "table2_main", on=["method"], metric="mean_success")


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """One row a task, for each method its rate and the paper's; and MOVE against each method in a row, from both."""
    parts = {seen: [tables[suffix] for suffix in suffixes[1:]]
             for seen, suffixes in zip(("pixels", "keypoints"), SUFFIXES.values(), strict=True)}
    rows = [summary(*three).assign(From=seen) for seen, three in parts.items() if len(three[0])]
    together = pd.concat(rows).fillna(ABSENT) if rows else readable(pd.DataFrame())
    return {"": task_layout(tables[""], controls(data.episodes), _means(tables)),
            "summary": together[sorted(together, key=lambda name: name != "From")]}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Ten tasks from pixels and from keypoints, and the differences from pixels."""
    floors, differences = controls(data.episodes), tables["differences"]
    figure, axes = plt.subplots(3, 1, figsize=(PAGE_WIDTH, 7.2), height_ratios=[1, 0.85, 1.35])
    plots.task_rates(tables[""], floors, axes[0])
    plots.task_rates(tables["keypoints"], floors, axes[1])
    axes[0].tick_params(labelbottom=False)
    handles, _ = axes[0].get_legend_handles_labels()
    figure.legend(handles=[*handles, *plots.pooled_entry(pd.concat([tables[""], tables["keypoints"]]))], ncol=7,
                  loc="outside upper center")
    plots.differences(differences, "task", [TASKS[name].title for name in differences.task.unique()], axes[2],
                      tables["differences_mean"])
    handles, _ = axes[2].get_legend_handles_labels()
    handles = sorted(handles, key=lambda handle: handle.get_label().endswith("paper"))
    axes[2].legend(handles=handles, ncol=2, loc="lower right", bbox_to_anchor=(1, 1))  # above: bars fill the panel
    titles(axes, ["from pixels", "from keypoints: perception given", "from pixels: MOVE minus the others"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Means in the paper and here, MOVE minus the others on the mean, and how trainings differ."""
    means, noise = _means(tables), {seen: data.noise(seen) for seen in ("rgb", "keypoints")}
    ours, theirs = rates_text(means), rates_text(means, "paper")
    keypoints = tables["differences_keypoints_mean"].itertuples()
    given = " and ".join(map(interval_text, keypoints)) or "not computed yet"
    which = "ten" if _has_all_tasks(tables) else "these"
    return (
        f"**The paper:** {which} tasks' mean {theirs}. **Here, from pixels:** {ours}; "
        f"{means_text(tables['differences_mean'])}; from keypoints {given}. **How sure:** trainings differ by "
        f"{100 * noise['rgb'].deviation:.0f} points (keypoints {100 * noise['keypoints'].deviation:.0f}). "
        f"{data.sample_size}")


WORDS = Words(
    title="Table 2. Ten tasks: static, ADC and MOVE",
    shown=(
        f"(a) Success from pixels, (b) success from keypoints, where perception is given, each between the expert and "
        f"an expert that is told a wrong target. (c) MOVE minus the others from pixels, paired by configuration, and "
        f"the mean of the tasks. {INTERVALS} Diamonds are the paper's values. Box-Close has 20,000 timesteps here and "
        f"100,000 in the paper."),
    alt="Two panels of points with intervals for ten tasks and three methods, and a panel of differences.",
    tables={
        "": (
            "Table 2: success in per cent from pixels with 95 % intervals, the paper's beside it, the expert "
            "(ceiling) and an expert that is told a wrong target (floor)."),
        "keypoints": f"Table 2 from keypoints, perception given. {RATES}",
        "differences": f"Table 2 from pixels. {DIFFERENCES}",
        "differences_mean": f"Table 2 from pixels, mean of the tasks. {DIFFERENCES}",
        "differences_keypoints": f"Table 2 from keypoints. {DIFFERENCES}",
        "differences_keypoints_mean": f"Table 2 from keypoints, mean of the tasks. {DIFFERENCES}",
        "over_tasks": (
            "Table 2 from pixels with the task as the unit: means and interquartile means in points "
            "and per cent, and the probability that MOVE is better on a task, in per cent."),
        "over_tasks_keypoints": "Table 2 from keypoints with the task as the unit, as above.",
        "costs": f"Table 2 from pixels. {COSTS}",
    },
)

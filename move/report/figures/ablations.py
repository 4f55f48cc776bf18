"""Against one thing that is varied: the budget, what moves, how fast, by which law."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.paper import PAPER_TASKS
from move.report import plots
from move.report.figures.panels import empty_panel, methods_and_seeds
from move.report.style import COLUMN_WIDTH, PAGE_WIDTH, titles
from move.sim.tasks import TASKS


def fig4_scaling(rates: pd.DataFrame, printed: pd.DataFrame) -> Figure:
    """One panel a task: success against timesteps with the paper's values.

    Args:
        rates: task, and what `plots.curve` takes with the column timesteps.
        printed: task, method, timesteps, value of the paper.
    """
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
    figure.legend(handles=plots.entries(list(rates.method.unique()), "paper, in the method's colour",
                                        bool(rates.value.isna().any())), ncol=5, loc="outside upper center")
    return figure


def fig4_efficiency(factors: pd.DataFrame, tasks: Sequence[str]) -> Figure:
    """Static's timesteps over MOVE's for the same success, one line for each of `tasks`."""
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.efficiencies(factors.set_index("task").reindex(list(tasks)).rename_axis("task").reset_index(), ax)
    return figure


def fig6_dimensions(rates: pd.DataFrame) -> Figure:
    """One ladder a task.

    Args:
        rates: task, and what `plots.ladder` takes with the column moves.
    """
    tasks = list(rates.task.unique())
    bars = [int((rates.task == task).sum()) for task in tasks]
    figure, axes = plt.subplots(1, len(tasks), figsize=(PAGE_WIDTH, 2.5), squeeze=False, sharey=True, width_ratios=bars)
    for ax, task in zip(axes.flat, tasks, strict=True):
        plots.ladder(rates[rates.task == task], "moves", ax)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
        ax.set_xlabel("what moves in the demonstrations")
    titles(list(axes.flat), [TASKS[task].title for task in tasks])
    methods_and_seeds(figure, rates)
    return figure


def fig7_speed(rates: pd.DataFrame) -> Figure:
    """One row a task, one column a part whose speed is varied; static as a dashed line with its band.

    Args:
        rates: task, part ("nothing": static), speed, and what `plots.curve` takes.
    """
    units = {"object": "object's speed (m per step)", "target": "target's speed (m per step)",
             "camera": "camera's speed (degrees per step)"}
    tasks, parts = list(rates.task.unique()), [part for part in units if part in set(rates.part)]
    still = rates[(rates.part == "nothing") & rates.value.notna()]
    figure, axes = plt.subplots(len(tasks), max(len(parts), 1), figsize=(PAGE_WIDTH, 1.75 * len(tasks) + 0.4),
                                squeeze=False, sharey=True)
    for row, task in zip(axes, tasks, strict=True):
        here = rates[rates.task == task]
        for ax, part in zip(row, parts, strict=False):
            if len(moved := here[here.part == part]):
                plots.curve(moved, "speed", units[part], ax)
                for static in still[still.task == task].itertuples():
                    plots.reference(static, ax)
            else:
                empty_panel("not part of this study", ax)
            ax.set_ylabel("success (%)" if ax is row[0] else "")
    titles(list(axes.flat), [f"{TASKS[task].title}, {part}" for task in tasks for part in parts or ["nothing"]])
    shown = [plots.reference_entry("static")] if len(still) else []
    figure.legend(handles=[*shown, *plots.entries(["move"], missing=bool(rates.value.isna().any()))], ncol=3,
                  loc="outside upper center")
    return figure


def fig_speed_law(rates: pd.DataFrame, task: str) -> Figure:
    """Static, and MOVE under each law of the speeds.

    Args:
        rates: law, and what `plots.ladder` takes.
    """
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.ladder(rates, "law", ax)
    ax.set_xlabel("how the speeds are drawn, all with one mean")
    titles([ax], [TASKS[task].title])
    methods_and_seeds(figure, rates)
    return figure

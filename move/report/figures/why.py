"""Why it works: shares of MOVE, length of training, equal demonstrations, coverage, perception."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.report import plots
from move.report.figures.panels import SEEN, methods_and_seeds
from move.report.style import COLUMN_WIDTH, PAGE_WIDTH, titles
from move.sim.tasks import TASKS


def fig_mixture(rates: pd.DataFrame, task: str) -> Figure:
    """One bar a share of MOVE in the data.

    Args:
        rates: share, and what `plots.ladder` takes.
    """
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.ladder(rates.assign(percent=[f"{100 * share:.0f}" for share in rates.share]), "percent", ax)
    ax.set_xlabel("timesteps by MOVE (%), the rest static")
    titles([ax], [TASKS[task].title])
    methods_and_seeds(figure, rates)
    return figure


def fig_training_length(rates: pd.DataFrame) -> Figure:
    """One panel a task: success against the length of training.

    Args:
        rates: task, and what `plots.curve` takes with the column length.
    """
    tasks = list(rates.task.unique())
    figure, axes = plt.subplots(1, len(tasks), figsize=(PAGE_WIDTH, 2.3), squeeze=False, sharey=True)
    for ax, task in zip(axes.flat, tasks, strict=True):
        plots.curve(rates[rates.task == task], "length", "gradient steps / the recipe's", ax, log=True)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
    titles(list(axes.flat), [TASKS[task].title for task in tasks])
    figure.legend(handles=plots.entries(list(rates.method.unique()), missing=bool(rates.value.isna().any())), ncol=4,
                  loc="outside upper center")
    return figure


def equal_demonstrations(rates: pd.DataFrame, task: str) -> Figure:
    """Static and MOVE with as many timesteps, and with as many demonstrations.

    Args:
        rates: equal, and what `plots.grouped_rates` takes.
    """
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.grouped_rates(rates.assign(paper=np.nan), "equal", [f"equal {name}" for name in rates.equal.unique()], ax)
    titles([ax], [TASKS[task].title])
    methods_and_seeds(figure, rates)
    return figure


def fig_coverage(cells: pd.DataFrame) -> Figure:
    """Success against what the data cover: of the object, of the camera, of both together.

    Args:
        cells: as `move.report.covered.coverage_table` gives it.
    """
    figure, axes = plt.subplots(1, 3, figsize=(PAGE_WIDTH, 2.6), sharey=True)
    for ax, column in zip(axes, ("object", "camera", "joint"), strict=True):
        plots.covered(cells, column, ax)
        ax.set_ylabel("success (%)" if ax is axes[0] else "")
    titles(list(axes), ["object", "camera", "both together"])
    figure.legend(*axes[0].get_legend_handles_labels(), ncol=4, loc="outside upper center")
    return figure


def fig_perception(rates: pd.DataFrame) -> Figure:
    """Static beside MOVE in several experiments, from pixels and from keypoints.

    Args:
        rates: observation, experiment, and what `plots.grouped_rates` takes.
    """
    kinds = list(rates.observation.unique())
    figure, axes = plt.subplots(1, len(kinds), figsize=(PAGE_WIDTH, 2.6), sharey=True, squeeze=False)
    for ax, kind in zip(axes.flat, kinds, strict=True):
        rows = rates[rates.observation == kind]
        labels = [name.replace(", ", "\n").replace("+", "\n+ ") for name in rows.experiment.unique()]
        plots.grouped_rates(rows.assign(paper=np.nan), "experiment", labels, ax)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
    titles(list(axes.flat), [SEEN[kind] for kind in kinds])
    methods_and_seeds(figure, rates)
    return figure

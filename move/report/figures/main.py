"""The main result and what stands beside it: ten tasks, readings of ADC, keypoints, own grasps and elsewhere."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.report import plots
from move.report.figures.panels import SEEN
from move.report.style import COLUMN_WIDTH, NAMES, PAGE_WIDTH, titles
from move.sim.tasks import TASKS


def table2_main(rates: pd.DataFrame, given: pd.DataFrame, controls: pd.DataFrame, differences: pd.DataFrame,
                means: pd.DataFrame) -> Figure:
    """Ten tasks from pixels and from keypoints, and the differences from pixels.

    Args:
        rates, given: as `plots.task_rates` takes them, from pixels and from keypoints.
        differences, means: as `plots.differences` takes them, from pixels.
    """
    figure, axes = plt.subplots(3, 1, figsize=(PAGE_WIDTH, 7.2), height_ratios=[1, 0.85, 1.35])
    plots.task_rates(rates, controls, axes[0])
    plots.task_rates(given, controls, axes[1])
    axes[0].tick_params(labelbottom=False)
    handles, _ = axes[0].get_legend_handles_labels()
    figure.legend(handles=handles, ncol=6, loc="outside upper center")
    plots.differences(differences, "task", [TASKS[name].title for name in differences.task.unique()], axes[2], means)
    handles, _ = axes[2].get_legend_handles_labels()
    handles = sorted(handles, key=lambda handle: handle.get_label().endswith("paper"))
    axes[2].legend(handles=handles, ncol=2, loc="lower right", bbox_to_anchor=(1, 1))  # above: bars fill the panel
    titles(axes, ["from pixels", "from keypoints: perception given", "from pixels: MOVE minus the others"])
    return figure


def table_adc(rates: pd.DataFrame) -> Figure:
    """The readings of ADC, one panel a kind of observation.

    Args:
        rates: observation, and what `plots.readings` takes with the column jumping.
    """
    kinds = list(rates.observation.unique())
    figure, axes = plt.subplots(len(kinds), 1, figsize=(PAGE_WIDTH, 2.1 * len(kinds) + 0.3), squeeze=False)
    for ax, kind in zip(axes.flat, kinds, strict=True):
        plots.readings(rates[rates.observation == kind], "jumping", ax)
    handles, _ = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles=handles, ncol=3, loc="outside upper center")
    titles(list(axes.flat), [SEEN[kind] for kind in kinds])
    return figure


def table_keypoint_control(rates: pd.DataFrame, controls: pd.DataFrame) -> Figure:
    """Ten tasks from keypoints between floor and ceiling."""
    figure, ax = plt.subplots(figsize=(PAGE_WIDTH, 2.7))
    plots.task_rates(rates, controls, ax)
    handles, _ = ax.get_legend_handles_labels()
    figure.legend(handles=handles, ncol=5, loc="outside upper center")
    titles([ax], ["ten tasks, from keypoints"])
    return figure


def keypoint_control(rates: pd.DataFrame, controls: Mapping[str, float], printed: pd.DataFrame) -> Figure:
    """Success from keypoints against the budget, between floor and ceiling; the paper's values from images beside it.

    Args:
        rates: as `plots.curve` takes it, with the column timesteps.
        controls: "expert" and "goal-blind" -> their success.
        printed: method, timesteps, value of the paper, from images.
    """
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.7))
    plots.curve(rates, "timesteps", "timesteps of demonstrations", ax, log=True)
    plots.printed_points(printed, ax)
    plots.log_ticks({*rates.timesteps, *printed.timesteps}, ax)
    for name in ("expert", "goal-blind"):
        if name in controls:
            plots.level(controls[name], NAMES[name], ax)
    ax.set_ylim(-0.03, 1.12)
    titles([ax], ["Pick-Place, from keypoints"])
    figure.legend(handles=plots.entries(list(rates.method.unique()), "paper, from images"), ncol=4,
                  loc="outside upper center", columnspacing=0.8, handletextpad=0.4)
    return figure


def generalization(rates: pd.DataFrame) -> Figure:
    """For each task and method its rates at its own grasps, elsewhere and in motion."""
    figure, ax = plt.subplots(figsize=(PAGE_WIDTH, 2.6))
    plots.own_and_elsewhere(rates, ax)
    figure.legend(handles=plots.own_and_elsewhere_entries(rates), ncol=6, loc="outside upper center")
    return figure

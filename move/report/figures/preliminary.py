"""The preliminaries: grasp points at nine places, everywhere and on a circle, and what is random."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from move.report import maps, plots
from move.report.figures.panels import empty_panel, legend_below, seed_dot
from move.report.style import PAGE_WIDTH, titles
from move.sim.grasp_points import CIRCLE


def fig1_sparse(episodes: pd.DataFrame, by_hand: pd.DataFrame) -> Figure:
    """Two maps, and the rates over the whole space by where the hand starts.

    Args:
        episodes: of static and MOVE with the hand anywhere, on a grid and at the grasp points.
        by_hand: as `plots.grouped_rates` takes it, with the column hand.
    """
    figure, axes = plt.subplots(1, 3, figsize=(PAGE_WIDTH, 2.3), width_ratios=[1, 1, 1.1])
    _maps(episodes, axes[:2])
    _by_hand(by_hand, axes[2])
    titles(axes, ["static", "MOVE", "whole space, by the hand's start"])
    return figure


def _maps(episodes: pd.DataFrame, axes: Sequence[Axes]) -> None:
    """One map a method with one colour bar; a method that has none on the grid leaves its panel empty and says so."""
    mesh = None
    for ax, method in zip(axes, ("static", "move"), strict=True):
        rows = episodes[episodes.method == method]
        if (rows.group == "grid").any():
            mesh = maps.heatmap(rows, ax)
            ax.set_anchor("N")
        else:
            empty_panel("missing", ax)
    axes[1].set_ylabel("")
    if mesh is not None:
        maps.seeds_bar(mesh, axes, episodes.seed.nunique())


def _by_hand(rates: pd.DataFrame, ax: Axes) -> None:
    names = {"anywhere": "any-\nwhere", "within 3 cm": "within\n3 cm", "one place": "one\nplace"}
    plots.grouped_rates(rates, "hand", [names[hand] for hand in rates.hand.unique()], ax)
    legend_below(ax, [seed_dot()], 2, lines=2)


def few_demonstrations(at_points: pd.DataFrame, whole: pd.DataFrame) -> Figure:
    """Success at the nine points and over the whole space, against the budget.

    Args:
        at_points, whole: as `plots.curve` takes them, with the column timesteps.
    """
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.3), sharey=True)
    for ax, rates in zip(axes, (at_points, whole), strict=True):
        plots.curve(rates, "timesteps", "timesteps of demonstrations", ax, log=True)
    axes[1].set_ylabel("")
    titles(axes, ["at the nine points", "whole space"])
    missing = bool(pd.concat([at_points, whole]).value.isna().any())
    figure.legend(handles=plots.entries(["static", "move"], missing=missing), ncol=3, loc="outside upper center")
    return figure


def fig3_dense(episodes: pd.DataFrame, grasped: pd.DataFrame, by_hand: pd.DataFrame, by_budget: pd.DataFrame) -> Figure:
    """Two maps with the grasps over them, the rates by where the hand starts, and the rates at smaller budgets.

    Args:
        grasped: method, object_x, object_y of the demonstrations' grasps (metres).
        by_hand: as `plots.grouped_rates` takes it, with the column hand.
        by_budget: as `plots.curve` takes it, with the column timesteps.
    """
    figure, axes = plt.subplots(1, 4, figsize=(PAGE_WIDTH, 2.1), width_ratios=[1, 1, 0.9, 0.8])
    _maps(episodes, axes[:2])
    for ax, method in zip(axes, ("static", "move"), strict=False):
        if ax.axison:  # there is a map
            maps.grasps(grasped[grasped.method == method], ax)
    _by_hand(by_hand, axes[2])
    plots.curve(by_budget, "timesteps", "timesteps", axes[3], log=True)
    axes[3].set_ylabel("")
    axes[3].legend(loc="lower right")
    titles(axes, ["static", "MOVE", "by the hand's start", "by budget"])
    return figure


def fig5_circle(episodes: pd.DataFrame, by_hand: pd.DataFrame) -> Figure:
    """Two maps with the circle over them, and the rates inside and outside of it by where the hand starts.

    Args:
        by_hand: as `plots.grouped_rates` takes it, with the columns hand and where (NaN where both are missing).
    """
    figure, axes = plt.subplots(1, 4, figsize=(PAGE_WIDTH, 2.1), width_ratios=[1, 1, 0.8, 0.8])
    _maps(episodes, axes[:2])
    for ax in axes[:2]:
        if ax.axison:  # there is a map
            maps.circle(CIRCLE, ax)
    for ax, where in zip(axes[2:], ("inside", "outside"), strict=True):
        _by_hand(by_hand[(by_hand["where"] == where) | by_hand["where"].isna()], ax)
    axes[3].set_ylabel("")
    titles(axes, ["static", "MOVE", "inside", "outside"])
    return figure


def table1_spatial_factors(rates: pd.DataFrame, differences: pd.DataFrame, labels: Mapping[str, str]) -> Figure:
    """Static beside MOVE as more is random, and their difference.

    Args:
        rates: as `plots.grouped_rates` takes it, with the column factors.
        labels: what to call the values of factors.
    """
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.4), width_ratios=[1.2, 1])
    plots.grouped_rates(rates, "factors", [labels[name] for name in rates.factors.unique()], axes[0])
    axes[0].set_xlabel("what is random")
    handles, _ = axes[0].get_legend_handles_labels()
    figure.legend(handles=[*handles, seed_dot()], ncol=4, loc="outside upper center")
    plots.differences(differences, "factors", [labels[name] for name in differences.factors.unique()], axes[1])
    titles(axes, ["success", "MOVE minus static"])
    return figure

"""Whole figures of the real-robot data, as wide as a page; simulated data are headed as such."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from os.path import commonprefix

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from move.figures.plots import maps, style
from move.figures.plots import real as real_plots
from move.figures.plots.style import COLOURS, NAMES, PAGE_WIDTH, in_order
from move.statistics.places import Table

JOINTS_A_ROW = 6
SIMULATED_TEXT = "Simulated data in the layout of real data: no robot was involved"


def cells_figure(table: pd.DataFrame, compared: pd.DataFrame) -> Figure:
    """Lay out success and score of the four cells side by side.

    Args:
        table: `trials.real_table`.
        compared: `trials.comparisons`.
    """
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.7))
    real_plots.success_cells(table, axes[0])
    real_plots.brackets(table, compared, axes[0])
    real_plots.score_cells(table, axes[1])
    style.titles(axes, [f"successes in {table['trials'].iloc[0]} trials; p of Barnard's test", "score"])
    methods = [Patch(color=COLOURS[name], alpha=0.85, label=NAMES[name]) for name in dict.fromkeys(table["method"])]
    figure.legend(handles=methods, ncol=2, loc="outside upper center")
    return figure


def object_figure(places: pd.DataFrame, speeds: pd.DataFrame, *, simulated: bool) -> Figure:
    """Lay out where the object was seen by each method's camera, and how fast it moved.

    Args:
        places: `tracking.object_places`.
        speeds: `tracking.object_speeds`.
    """
    methods = in_order(places["method"])
    figure, axes = plt.subplots(1, len(methods) + 1, figsize=(PAGE_WIDTH, 2.0), squeeze=False,
                                width_ratios=[1.5] * len(methods) + [1])
    for method, ax in zip(methods, axes[0], strict=False):
        real_plots.object_map(places[places["method"] == method], ax, colour=COLOURS[method])
    real_plots.speed_dots(speeds, axes[0, -1])
    counts = [len(places[places["method"] == method].groupby(["part", "index"])) for method in methods]
    style.titles(list(axes[0]), [*(f"{NAMES[method]}: the orange (n = {count})"
                                   for method, count in zip(methods, counts, strict=True)), "its speed"])
    if simulated:
        style.heading(figure, SIMULATED_TEXT)
    return figure


def grasp_figure(places: Mapping[str, np.ndarray], proposed: Mapping[str, np.ndarray], *, simulated: bool = False,
                 table: Table | None = None) -> Figure:
    """Lay out where demonstrations grasp, and in which holes the next ones should be put, a panel a method.

    Args:
        places: method, or "" for one that is not known -> (N, 2) m.
        proposed: the same method -> (K, 2) m, in order.
        simulated: whether to say so on the figure.
        table: a part of the table to draw the sides of, m.
    """
    width = PAGE_WIDTH if len(places) > 1 else style.COLUMN_WIDTH
    figure, axes = plt.subplots(1, len(places), figsize=(width, 3.2), squeeze=False)
    for (method, points), ax in zip(places.items(), axes[0], strict=True):
        real_plots.grasp_map(points, proposed[method], ax, method=method, table=table)
    style.titles(list(axes[0]), [f"{NAMES.get(method, '')}: {len(points)} grasps".removeprefix(": ")
                                 + "; numbers: what is next" * (not method) for method, points in places.items()])
    if simulated:
        style.heading(figure, SIMULATED_TEXT)
    return figure


def setup_figure(cells: pd.DataFrame, steps: pd.DataFrame, strips: Mapping[str, tuple[np.ndarray, Sequence[str]]], *,
                 simulated: bool, joints: pd.DataFrame | None = None, lacking: str = "") -> Figure:
    """Lay out Figure 8: for each method its trajectories, the cells visited, and below all of them frames.

    Of an arm whose hand's way is not known its joints over time are drawn.

    Args:
        cells: `workspace.coverage_by_method`.
        steps: `workspace.path_table`.
        strips: method -> frames (k, height, width, 3) and their titles; may be empty.
        simulated: whether to say so on the figure.
        joints: `workspace.joint_table`, of episodes without a trajectory.
        lacking: why some episodes have no trajectory (`workspace.why_no_positions`), said in a panel of its own.
    """
    methods = in_order(cells["method"])
    shown = in_order(strips)
    shapes = [strips[method][0].shape for method in shown]
    heights = [0.95 * PAGE_WIDTH * h / (k * w) + 0.28 for k, h, w, _ in shapes]
    if not shown:
        lacking = "; ".join(filter(None, (lacking, "no camera whose frames can be read")))
    parts = [] if joints is None else list(joints.groupby("joint", sort=False))
    prefix = commonprefix([name for name, _ in parts]) if len(parts) > 1 else ""
    prefix = prefix[:max(prefix.rfind("_"), prefix.rfind(".")) + 1]  # such as "main_"
    short = {name: name.removeprefix(prefix) or name for name, _ in parts}
    rows = [parts[first:first + JOINTS_A_ROW] for first in range(0, len(parts), JOINTS_A_ROW)]
    heights = [0.5 * PAGE_WIDTH * 0.5 + 0.35] * len(methods) + heights + [1.5] * len(rows) + [0.5] * bool(lacking)
    figure = plt.figure(figsize=(PAGE_WIDTH, sum(heights)))
    grid = figure.add_gridspec(len(heights), 2, height_ratios=heights)
    axes, texts = [], []
    for row, method in enumerate(methods):
        mine, way = cells[cells["method"] == method], steps[steps["method"] == method]
        left, right = figure.add_subplot(grid[row, 0]), figure.add_subplot(grid[row, 1])
        real_plots.paths(way, left, colour=COLOURS[method])
        shades = real_plots.coverage_map(mine, right, colour=COLOURS[method])
        figure.colorbar(shades, ax=right, fraction=0.03, label="timesteps in a cell")
        grasped = way.groupby(["part", "index"])["grasped"].any()
        axes += [left, right]
        texts += [f"{NAMES[method]}: {len(grasped)} demonstrations, {grasped.sum()} grasps",
                  f"{NAMES[method]}: {100 * (mine['visits'] > 0).mean():.0f} % of cells visited by the hand"]
    for number, method in enumerate(shown):
        axes.append(figure.add_subplot(grid[len(methods) + number, :]))
        frames, times = strips[method]
        maps.strip(frames, times, axes[-1])
        texts.append(f"{NAMES[method]}: frames of one demonstration")
    for number, row_parts in enumerate(rows, len(methods) + len(shown)):
        panels = grid[number, :].subgridspec(1, JOINTS_A_ROW).subplots(sharex=True, squeeze=False)[0]
        for (name, part), panel in zip(row_parts, panels, strict=False):
            real_plots.joint_lines(part, short[name], panel)
        for panel in panels[len(row_parts):]:
            panel.remove()
        panels[0].set_ylabel("degrees")
        axes, texts = [*axes, panels[0]], [*texts, "joints over time, a line a demonstration\n"]
    style.titles(axes, texts)
    if lacking:
        panel = figure.add_subplot(grid[-1, :])
        panel.set_axis_off()
        panel.text(0.5, 0.5, textwrap.fill(lacking, 110), ha="center", va="center", parse_math=False)
    if simulated:
        style.heading(figure, SIMULATED_TEXT)
    return figure

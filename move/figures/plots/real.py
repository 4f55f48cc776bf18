"""Plots of the real-robot table and data: functions of tidy tables and an Axes that read no disk."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, PowerNorm
from matplotlib.patches import Patch, Rectangle, Wedge

from move.figures.plots.axes import errors, per_cent
from move.figures.plots.style import COLOURS, LEAST_POINTS, MARKERS, NAMES, in_order
from move.paper import REAL_RADIUS_M
from move.statistics.places import Table

GOLDEN = 0.6180339887498949  # multiples of it spread evenly between 0 and 1


def success_cells(table: pd.DataFrame, ax: Axes) -> None:
    """Draw one bar a cell with its exact interval and its count.

    Args:
        table: columns timesteps, method, successes, trials, rate, low, high (`trials.real_table`).
    """
    for place, row in enumerate(table.itertuples()):
        ax.bar(place, row.rate, width=0.65, color=COLOURS[row.method], alpha=0.85, zorder=2)
        ax.errorbar(place, row.rate, errors(row, "rate"), color="black", capsize=3, linewidth=1, zorder=3)
        ax.text(place, row.high + 0.015, f"{row.successes}/{row.trials}", ha="center", va="bottom")
    _cells_axis(ax, table, "success (%)")


def brackets(table: pd.DataFrame, compared: pd.DataFrame, ax: Axes) -> None:
    """Join the cells of each budget over their intervals, with p of Barnard's exact test between them.

    Args:
        table: as `success_cells` takes it.
        compared: columns first, second, barnard (`trials.comparisons`), cells named as "static 35k".
    """
    cells = table.reset_index(drop=True)
    names = cells["method"] + " " + (cells["timesteps"] // 1000).astype(str) + "k"
    for _, pair in cells.groupby("timesteps"):
        two = set(names[pair.index])
        (p,) = compared["barnard"][[{first, second} == two for first, second in
                                   zip(compared["first"], compared["second"], strict=True)]]
        left, right, height = pair.index.min(), pair.index.max(), pair["high"].max() + 0.11
        ax.plot([left, left, right, right], [height, height + 0.02, height + 0.02, height], color="black", lw=0.9)
        ax.annotate(f"p = {p:.3f}", ((left + right) / 2, height + 0.03), ha="center", va="bottom")


def score_cells(table: pd.DataFrame, ax: Axes) -> None:
    """Draw the normalised score of each cell over the range its successes alone would allow.

    Args:
        table: columns timesteps, method, normalised, score_low, score_high (`trials.real_table`).
    """
    for place, row in enumerate(table.itertuples()):
        ax.bar(place, row.score_high - row.score_low, bottom=row.score_low, width=0.65, color="0.90", edgecolor="0.75",
               linewidth=0.8, zorder=1)
        ax.plot(place, row.normalised, marker="D", markersize=6, markerfacecolor="white", color=COLOURS[row.method],
                zorder=3)
        ax.annotate(f"{100 * row.normalised:.1f}", (place, row.normalised), xytext=(0, 6), textcoords="offset points",
                    ha="center", va="bottom", zorder=4)
    _cells_axis(ax, table, "score (% of three points a trial)")
    ax.legend(handles=[Patch(facecolor="0.90", edgecolor="0.75", label="range the successes alone allow")],
              loc="upper left")


def _cells_axis(ax: Axes, table: pd.DataFrame, title: str) -> None:
    ax.set_xticks(range(len(table)), [f"{NAMES[row.method]}\n{row.timesteps:,}" for row in table.itertuples()])
    ax.yaxis.set_major_formatter(per_cent)
    ax.set(ylim=(0, 1), ylabel=title, xlim=(-0.6, len(table) - 0.4), xlabel="method and timesteps of demonstrations")


def half_disc(ax: Axes) -> Wedge:
    """Prepare an Axes as a view from above: the arm's base at the lower middle, x up, y to the left; its outline."""
    outline = Wedge((0, 0), REAL_RADIUS_M, 0, 180, facecolor="none", edgecolor="0.4", linewidth=1, zorder=3)
    ax.add_patch(outline)
    ax.plot(0, 0, marker="s", color="black", markersize=5, zorder=4, clip_on=False)
    ax.annotate("base", (0, 0), xytext=(5, 3), textcoords="offset points")
    edge = REAL_RADIUS_M * 1.03
    ax.set(xlim=(edge, -edge), ylim=(-0.02, edge), aspect="equal")
    ax.set(xlabel="y (m), to the arm's left", ylabel="x (m)", xticks=[0.5, 0.25, 0, -0.25, -0.5], yticks=[0, 0.25, 0.5])
    return outline


def coverage_map(cells: pd.DataFrame, ax: Axes, *, colour: str) -> ScalarMappable:
    """Fill the cells of the half disc by how often they were visited (square root, so that few visits still show).

    Args:
        cells: columns x_m, y_m, visits, of one method (`workspace.coverage`).
        colour: full colour, for the most visited cell.

    Returns:
        What a colour bar needs.
    """
    from move.realworld.workspace import CELL_M  # the room reads data: slow to import, and of no other figure

    outline = half_disc(ax)
    most = max(int(cells["visits"].max()), 1) if len(cells) else 1
    shades = ScalarMappable(PowerNorm(0.5, 0, most), LinearSegmentedColormap.from_list("visits", ["white", colour]))
    for cell in cells.itertuples():
        square = Rectangle((cell.y_m - CELL_M / 2, cell.x_m - CELL_M / 2), CELL_M, CELL_M, edgecolor="0.9",
                           facecolor=shades.to_rgba(cell.visits), linewidth=0.4, zorder=1)
        ax.add_patch(square)
        square.set_clip_path(outline)
        square.set_in_layout(False)  # the half disc is: 200 cells would take most of a layout's time
    return shades


def paths(table: pd.DataFrame, ax: Axes, *, colour: str) -> None:
    """Draw the end effector's way of each episode up to the grasp, and the grasp as a dot.

    Args:
        table: columns part, index, x_m, y_m, grasped, of one method (`workspace.path_table`).
    """
    half_disc(ax)
    for _, steps in table.groupby(["part", "index"], sort=True):
        before = steps[~steps["grasped"]]
        ax.plot(before["y_m"], before["x_m"], color=colour, linewidth=0.8, alpha=0.6, zorder=2)
        if steps["grasped"].any():
            ax.plot(before["y_m"].iloc[-1], before["x_m"].iloc[-1], marker="o", markersize=3.5, color=colour, zorder=5)


def grasp_map(places: np.ndarray, proposed: np.ndarray, ax: Axes, *, method: str = "", table: Table | None = None
              ) -> None:
    """Draw the places of grasps from above in the method's mark, and those proposed next as numbers, in centimetres.

    Args:
        places: (N, 2) m.
        proposed: (K, 2) m, in order.
        table: a part of the table to draw the sides of, m.
    """
    if table:
        (x, y), (far_x, far_y) = 100 * np.array(table)
        ax.add_patch(Rectangle((x, y), far_x - x, far_y - y, fill=False, ls="--", lw=0.8, color="#444444"))
    ax.plot(*(100 * places.T), ls="none", marker=MARKERS.get(method, "o"), ms=4, alpha=0.6, mec="none",
            color=COLOURS.get(method, "#444444"))
    for number, (x, y) in enumerate(100 * proposed, 1):
        ax.text(x, y, str(number), ha="center", va="center", zorder=5,
                bbox={"boxstyle": "circle,pad=0.15", "fc": "white", "ec": "black", "lw": 0.6})
    ax.update_datalim(100 * proposed)
    ax.margins(0.12)
    ax.set(xlabel="x (cm)", ylabel="y (cm)")
    ax.set_aspect("equal", adjustable="datalim")


def joint_lines(table: pd.DataFrame, name: str, ax: Axes) -> None:
    """Draw one joint's angle over time, a line an episode in its method's colour, with the joint's name.

    Args:
        table: columns method, part, index, time_s, degrees, of one joint (`workspace.joint_table`).
        name: of the joint; shown as it is, for it is a data set's.
    """
    for (method, _, _), steps in table.groupby(["method", "part", "index"], sort=True):
        ax.plot(steps["time_s"], steps["degrees"], color=COLOURS[method], linewidth=0.8, alpha=0.6)
    ax.annotate(name, (0.0, 1.0), xycoords="axes fraction", xytext=(3, 1), textcoords="offset points",
                fontsize=LEAST_POINTS, parse_math=False)
    ax.set_xlabel("time (s)")


def speed_dots(table: pd.DataFrame, ax: Axes) -> None:
    """Draw the object's mean speed before the grasp, one dot an episode, by method.

    Args:
        table: columns method, mean_speed, unit (`tracking.object_speeds`).
    """
    methods = in_order(table["method"])
    for place, method in enumerate(methods):
        values = table.loc[table["method"] == method, "mean_speed"].dropna()
        if values.empty:  # a line without points would take the whole figure in its layout
            continue
        spread = 0.4 * (np.arange(len(values)) * GOLDEN % 1 - 0.5)  # sideways, in no order of the speeds
        ax.plot(place + spread, values, marker="o", linestyle="none", markersize=3.5, color=COLOURS[method], alpha=0.7,
                clip_on=False)
    ax.set_xticks(range(len(methods)), [f"{NAMES[name]}\nn = {(table['method'] == name).sum()}" for name in methods])
    unit = table["unit"].iloc[0] if len(table) else "px"
    ax.set(ylabel=f"object's speed ({unit}/s)", xlim=(-0.6, len(methods) - 0.4))
    ax.set_ylim(bottom=0)


def object_map(places: pd.DataFrame, ax: Axes, *, colour: str) -> None:
    """Draw where the orange was seen in the image, joined within an episode.

    Args:
        places: columns part, index, row, column, height, width, of one method (`tracking.object_places`).
    """
    for _, seen in places.groupby(["part", "index"], sort=True):
        ax.plot(seen["column"], seen["row"], color=colour, linewidth=0.8, alpha=0.6, marker="o", markersize=2)
    if len(places):
        ax.set(xlim=(0, places["width"].iloc[0]), ylim=(places["height"].iloc[0], 0), aspect="equal")
    ax.set(xlabel="column of the image (px)", ylabel="row (px)")

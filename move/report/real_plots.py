"""Pictures of the real-robot table and data: functions of tidy tables and an Axes that read no disk.

success_cells   success of the four cells with exact intervals, beside each other
score_cells     normalised scores, with the range that the successes alone leave open
coverage_map    which cells of the half disc were visited
paths           trajectories of the end effector over the half disc
frames_strip    frames of one episode in a row
speed_dots      speed of the moved object, one dot an episode
object_map      where the object was seen in the image before its grasp
"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Wedge

from move.paper import REAL_RADIUS_M
from move.report.style import COLOURS, NAMES


def success_cells(table: pd.DataFrame, ax: Axes) -> None:
    """Draw one bar a cell with its exact interval and its count.

    Args:
        table: columns timesteps, method, successes, trials, rate, low, high (`trials.real_table`).
    """
    for place, row in enumerate(table.itertuples()):
        ax.bar(place, row.rate, width=0.65, color=COLOURS[row.method], zorder=2)
        ax.errorbar(place, row.rate, yerr=[[row.rate - row.low], [row.high - row.rate]], color="black", capsize=3,
                    linewidth=1, zorder=3)
        ax.text(place, row.high + 0.015, f"{row.successes}/{row.trials}", ha="center", va="bottom")
    _cells_axis(ax, table, "success rate")


def score_cells(table: pd.DataFrame, ax: Axes) -> None:
    """Draw the normalised score of each cell over the range its successes alone would allow.

    Args:
        table: columns timesteps, method, normalised, score_low, score_high (`trials.real_table`).
    """
    for place, row in enumerate(table.itertuples()):
        ax.bar(place, row.score_high - row.score_low, bottom=row.score_low, width=0.65, color="0.90", edgecolor="0.75",
               linewidth=0.8, zorder=1)
        ax.plot(place, row.normalised, marker="D", markersize=7, color=COLOURS[row.method], zorder=3)
        ax.text(place + 0.14, row.normalised, f"{row.normalised:.3f}", va="center", zorder=4)
    _cells_axis(ax, table, "normalised score")
    ax.legend(handles=[Patch(facecolor="0.90", edgecolor="0.75", label="range the successes alone allow")],
              loc="upper left")


def _cells_axis(ax: Axes, table: pd.DataFrame, title: str) -> None:
    ax.set_xticks(range(len(table)), [f"{NAMES[row.method]}\n{row.timesteps // 1000}k" for row in table.itertuples()])
    ax.set(ylim=(0, 1), ylabel=title, xlim=(-0.6, len(table) - 0.3))
    ax.grid(axis="y", color="0.9", zorder=0)


def half_disc(ax: Axes, *, radius_m: float = REAL_RADIUS_M) -> None:
    """Prepare an Axes as a view from above: the arm's base at the lower middle, x up, y to the left."""
    ax.add_patch(Wedge((0, 0), radius_m, 0, 180, facecolor="none", edgecolor="0.4", linewidth=1, zorder=3))
    ax.plot(0, 0, marker="s", color="black", markersize=5, zorder=4, clip_on=False)
    ax.set(xlim=(radius_m * 1.03, -radius_m * 1.03), ylim=(-0.02, radius_m * 1.03), aspect="equal")
    ax.set(xlabel="y (m)", ylabel="x (m)", xticks=[0.5, 0.25, 0, -0.25, -0.5], yticks=[0, 0.25, 0.5])


def coverage_map(cells: pd.DataFrame, ax: Axes, *, cell_m: float = 0.05, colour: str = COLOURS["move"]) -> None:
    """Fill the cells of the half disc by how often they were visited (square root, so that few visits still show).

    Args:
        cells: columns x_m, y_m, visits, of one method (`workspace.coverage`).
        colour: full colour, for the most visited cell.
    """
    half_disc(ax)
    most = max(int(cells["visits"].max()), 1) if len(cells) else 1
    for cell in cells.itertuples():
        face = (colour, 0.12 + 0.88 * np.sqrt(cell.visits / most)) if cell.visits else "white"
        ax.add_patch(
            plt.Rectangle((cell.y_m - cell_m / 2, cell.x_m - cell_m / 2), cell_m, cell_m, facecolor=face,
                          edgecolor="0.9", linewidth=0.4, zorder=1))


def paths(table: pd.DataFrame, ax: Axes, *, colour: str = COLOURS["move"]) -> None:
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


def frames_strip(frames: np.ndarray, ax: Axes, *, titles: Sequence[str] = ()) -> None:
    """Draw frames in a row.

    Args:
        frames: (k, height, width, 3) uint8.
        titles: one a frame, written above it.
    """
    count, height, width, _ = frames.shape
    gap_px = max(1, width // 40)
    strip = np.full((height, count * (width + gap_px) - gap_px, 3), 255, np.uint8)
    for number, frame in enumerate(frames):
        strip[:, number * (width + gap_px):number * (width + gap_px) + width] = frame
    ax.imshow(strip, interpolation="auto")
    for number, title in enumerate(titles):
        ax.text(number * (width + gap_px) + width / 2, -0.04 * height, title, ha="center", va="bottom")
    ax.set_axis_off()


def speed_dots(table: pd.DataFrame, ax: Axes) -> None:
    """Draw the object's mean speed before the grasp, one dot an episode, by method.

    Args:
        table: columns method, mean_speed, unit (`tracking.object_speeds`).
    """
    methods = [method for method in COLOURS if method in set(table["method"])]
    for place, method in enumerate(methods):
        values = table.loc[table["method"] == method, "mean_speed"].dropna().sort_values()
        spread = np.linspace(-0.2, 0.2, len(values)) if len(values) > 1 else np.zeros(len(values))
        ax.plot(place + spread, values, marker="o", linestyle="none", markersize=4, color=COLOURS[method], alpha=0.8)
    ax.set_xticks(range(len(methods)), [NAMES[method] for method in methods])
    unit = table["unit"].iloc[0] if len(table) else "px"
    ax.set(ylabel=f"object's speed ({unit}/s)", xlim=(-0.6, len(methods) - 0.4))
    ax.set_ylim(bottom=0)
    ax.grid(axis="y", color="0.9")


def object_map(places: pd.DataFrame, ax: Axes, *, colour: str = COLOURS["move"]) -> None:
    """Draw where the orange was seen in the image, joined within an episode.

    Args:
        places: columns part, index, row, column, height, width, of one method (`tracking.object_places`).
    """
    for _, seen in places.groupby(["part", "index"], sort=True):
        ax.plot(seen["column"], seen["row"], color=colour, linewidth=0.8, alpha=0.6, marker="o", markersize=2)
    if len(places):
        ax.set(xlim=(0, places["width"].iloc[0]), ylim=(places["height"].iloc[0], 0), aspect="equal")
    ax.set(xticks=[], yticks=[])

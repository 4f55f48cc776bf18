"""Maps of places, and frames in a row: data and an Axes in, marks on the Axes out; nothing is read from disk."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import QuadMesh
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle

from move.figures.plots.style import COLOURS, LEAST_POINTS
from move.sim.configuration import Disc

AROUND = [patheffects.withStroke(linewidth=2.2, foreground="white")]  # keeps black visible on dark and on light


GRASP_POINT = Line2D([], [], ls="none", marker="o", ms=4.7, color="black", mfc="#FFE945", mew=0.9,
                     label="grasp point, in the colour of its own success")
GRASP = Line2D([], [], ls="none", marker="o", ms=2.2, color="black", mfc="white", mew=0.4,
               label="where a demonstration grasped")


def heatmap(episodes: pd.DataFrame, ax: Axes) -> QuadMesh:
    """Success over the object's place: one cell a grid configuration, one colour a number of seeds that succeed.

    Args:
        episodes: rows with object_x, object_y (metres), seed, success and group; group "point" marks grasp points.
    """
    seeds = episodes.seed.nunique()  # rates are multiples of 1 / seeds
    colours: dict[str, Any] = {"cmap": mpl.colormaps["cividis"].resampled(seeds + 1),
                               "norm": Normalize(-0.5 / seeds, 1 + 0.5 / seeds)}
    mesh = _draw_cells(_cells(episodes), colours, ax)
    points = episodes[episodes.group == "point"].groupby(["object_x", "object_y"], as_index=False).success.mean()
    places = points.object_x * 100, points.object_y * 100
    ax.scatter(*places, s=38, color="white", zorder=3, clip_on=False)
    ax.scatter(*places, c=points.success, **colours, s=22, edgecolor="black", linewidth=0.9, zorder=4, clip_on=False)
    return mesh


def difference(episodes: pd.DataFrame, ax: Axes) -> QuadMesh:
    """MOVE minus static over the object's place: one cell a grid configuration, from static's colour to MOVE's.

    Args:
        episodes: as `heatmap` takes them, of both methods; seeds are compared as means.
    """
    cells = {method: _cells(rows) for method, rows in episodes.groupby("method")}
    steps = 2 * episodes.seed.nunique() + 1
    shades = LinearSegmentedColormap.from_list("difference", [COLOURS["static"], "#F0F0F0", COLOURS["move"]], N=steps)
    half = 1 / (steps - 1)
    return _draw_cells(cells["move"] - cells["static"], {"cmap": shades, "norm": Normalize(-1 - half, 1 + half)}, ax)


def _cells(episodes: pd.DataFrame) -> pd.DataFrame:
    """Mean success of the seeds at each place of the grid: one row a y, one column an x (metres)."""
    return episodes[episodes.group == "grid"].pivot_table("success", "object_y", "object_x", aggfunc="mean")


def _draw_cells(cells: pd.DataFrame, colours: dict, ax: Axes) -> QuadMesh:
    edges = [_edges(axis.to_numpy() * 100) for axis in (cells.columns, cells.index)]
    mesh = ax.pcolormesh(*edges, cells.to_numpy(dtype=float), **colours, edgecolor="white", linewidth=0.2)
    ax.set(xlabel="object x (cm)", ylabel="object y (cm)", aspect="equal")
    return mesh


def seeds_bar(mesh: QuadMesh, axes: Sequence[Axes], seeds: int, least: int = 0, label: str = "") -> None:
    """The colour bar of maps of `seeds` seeds: one colour a number of seeds that succeed.

    Args:
        least: the smallest number there can be, below 0 of a difference.
        label: by default that of successes.
    """
    counts = np.arange(least, seeds + 1)
    bar = plt.colorbar(ScalarMappable(mesh.norm, mesh.cmap), ax=list(axes), panchor=False,
                       fraction=0.04 if len(axes) > 1 else 0.08, ticks=counts / seeds,
                       label=label or f"seeds that succeed, of {seeds}")
    bar.ax.set_yticklabels([f"{count:+d}".replace("-", "\N{MINUS SIGN}") if least and count else str(count)
                            for count in counts])
    bar.ax.minorticks_off()
    bar.outline.set_linewidth(0.6)


def _edges(centres: np.ndarray) -> np.ndarray:
    half = (centres[1] - centres[0]) / 2 if len(centres) > 1 else 1.0
    return np.append(centres - half, centres[-1] + half)


def grasps(points: pd.DataFrame, ax: Axes) -> None:
    """Where the demonstrations grasped, as small dots.

    Args:
        points: object_x, object_y (metres).
    """
    ax.scatter(points.object_x * 100, points.object_y * 100, s=3.5, color="white", edgecolor="black", lw=0.4, zorder=3,
               clip_on=False)


def circle(disc: Disc, ax: Axes) -> None:
    """The outline of a disc given in metres, on axes in centimetres."""
    outline = Circle((disc.centre[0] * 100, disc.centre[1] * 100), disc.radius * 100, fill=False, color="black",
                     ls="--", lw=0.8, clip_on=False)
    outline.set_path_effects([patheffects.withStroke(linewidth=2.0, foreground="white"), patheffects.Normal()])
    ax.add_patch(outline)


def coverage(seen: pd.DataFrame, part: str, low: tuple, high: tuple, ax: Axes, label: str = "") -> None:
    """Every place in the plane that `part` ("object" or "target") had at some timestep, in its labelled range (m)."""
    method = seen.method.iloc[0]
    ax.annotate(label or part, (high[0] * 100, (low[1] + high[1]) * 50), xytext=(3, 0), textcoords="offset points",
                rotation=90, va="center", fontsize=LEAST_POINTS, color="#666666")
    ax.plot(seen[f"{part}_x"] * 100, seen[f"{part}_y"] * 100, "o", color=COLOURS[method], ms=2, alpha=0.5, mew=0,
            clip_on=False)
    ax.add_patch(Rectangle((low[0] * 100, low[1] * 100), (high[0] - low[0]) * 100, (high[1] - low[1]) * 100,
                           fill=False, color="#888888", lw=0.8))
    ax.set(aspect="equal", xlabel="x (cm)", ylabel="y (cm)")


def strip(frames: np.ndarray, labels: Sequence[str], ax: Axes) -> None:
    """Frames in a row with a gap between them, each with a label in its upper left corner.

    Args:
        frames: (count, height, width, 3) uint8.
        labels: one a frame, such as its timestep.
    """
    count, height, width, _ = frames.shape
    gap = max(2, width // 30)
    row = np.full((height, count * (width + gap) - gap, 3), 255, np.uint8)
    for number, frame in enumerate(frames):
        row[:, number * (width + gap):number * (width + gap) + width] = frame
    ax.imshow(row, interpolation="auto")
    for number, label in enumerate(labels):
        ax.annotate(label, (number * (width + gap), 0), xytext=(2.5, -2.5), textcoords="offset points", ha="left",
                    va="top", fontsize=LEAST_POINTS, color="black", path_effects=AROUND)
    ax.set_axis_off()

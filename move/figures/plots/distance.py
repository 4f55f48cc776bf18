"""Success against the distance to what training saw, rates that were predicted from it, and what MOVE has besides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from move.figures.plots.axes import errors, lines_axis, per_cent, points_axis, success_axis
from move.figures.plots.style import COLOURS, GREY, NAMES
from move.sim.methods import METHODS
from move.statistics.distance import Curve


def by_distance(table: pd.DataFrame, ax: Axes) -> None:
    """Success in bins of distance, one marker a method.

    Args:
        table: method, distance (centimetres), value, low, high.
    """
    for method, rows in table.groupby("method", sort=False):
        ax.errorbar(rows.distance, rows.value, errors(rows), lw=1, fmt=METHODS[method].marker, ms=4, capsize=1.5,
                    color=COLOURS[method])
    success_axis(ax)
    ax.set(xlabel="distance to the nearest place seen (cm)", xlim=(0, None))


def fitted(top: float, radius: float, steepness: float, ends: tuple[float, float], ax: Axes) -> None:
    """The curve of success against distance, and the radius (centimetres) at which half of its top is left."""
    far = np.linspace(0, ax.get_xlim()[1], 200)
    ax.plot(far, top * Curve(top, (radius,), steepness).left(far), color="black", lw=1.1, zorder=1)
    if radius < far[-1]:
        ax.axvspan(ends[0], min(ends[1], far[-1]), color="#999999", alpha=0.25, lw=0)
        ax.axvline(radius, color="#444444", lw=0.8, ls="--")
        ax.set_xlim(0, far[-1])


def predicted(table: pd.DataFrame, margin: float, ax: Axes) -> None:
    """Measured rates over those predicted without them, one marker a method, hollow from keypoints.

    Args:
        table: method, observation, predicted, value, low, high.
        margin: half the height of the band around equality.
    """
    ax.fill_between([0, 1], [-margin, 1 - margin], [margin, 1 + margin], color="#999999", alpha=0.25, lw=0)
    ax.plot([0, 1], [0, 1], color="black", lw=0.8)
    for (method, observation), rows in table.groupby(["method", "observation"], sort=False):
        ax.errorbar(rows.predicted, rows.value, errors(rows), lw=0.7, fmt=METHODS[method].marker, ms=4,
                    color=COLOURS[method], mfc=COLOURS[method] if observation == "rgb" else "white")
    success_axis(ax)
    ax.xaxis.set_major_formatter(per_cent)
    ax.xaxis.set_major_locator(MultipleLocator(0.2))
    ax.set(xlabel="predicted success (%)", xlim=(0, 1))


def leads(table: pd.DataFrame, labels: Sequence[str], margin: float, ax: Axes) -> None:
    """MOVE minus static of each setting, over all places (grey) and at equal distance (black).

    Args:
        table: setting, observation, compared, difference, low, high.
        labels: what to call the settings, in their order.
        margin: within which two methods count as the same.
    """
    ax.axvspan(-margin, margin, color="#999999", alpha=0.25, lw=0)
    styles = ((-0.15, "x", GREY), (0.15, "D", "black"))
    for (shift, marker, colour), (compared, rows) in zip(styles, table.groupby("compared", sort=False), strict=False):
        ax.errorbar(rows.difference, np.arange(len(rows)) + shift, xerr=errors(rows, "difference"), capsize=1.5, ms=4,
                    lw=1, fmt=marker, color=colour, label=compared)
    lines_axis(labels, ax)
    points_axis(ax, "MOVE minus static (points)")


def entries(methods: Sequence[str]) -> list[Line2D]:
    """What a legend shows: a marker a method, and that hollow ones are from keypoints."""
    return [*[Line2D([], [], ls="none", marker=METHODS[name].marker, ms=4, color=COLOURS[name], label=NAMES[name])
              for name in METHODS if name in methods],
            Line2D([], [], ls="none", marker="o", ms=4, color="#444444", mfc="white", label="from keypoints")]

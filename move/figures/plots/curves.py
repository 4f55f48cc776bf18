"""Curves over a number: budgets, speeds, lengths of training, seeds; and what is drawn next to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from move.figures.plots.axes import kept_apart, log_ticks, per_cent, rate_points, short, success_axis
from move.figures.plots.style import COLOURS, LEAST_POINTS, MARKERS, NAMES, in_order

REFERENCE: dict[str, Any] = {"ls": "--", "lw": 1.0}


def curve(table: pd.DataFrame, x: str, label: str, ax: Axes, log: bool = False, dots: bool = False) -> None:
    """Success rate against column `x`, one line a method, bars for the 95 % interval, "?" where a rate is missing.

    Args:
        table: method, `x` (numbers), value (NaN where it is missing), low, high.
        label: of the horizontal axis.
        dots: draw a white dot a seed, of the column seeds.
    """
    ticks = sorted(table[x].unique())
    places = np.log(ticks) if log else np.array(ticks, float)
    apart = min([0.035 * (places[-1] - places[0]), *0.2 * np.diff(places)])  # nearer to their own tick than to another
    methods = in_order(table.method)
    for method, shift in zip(methods, apart * np.linspace(-1, 1, len(methods)) * (len(methods) > 1), strict=True):
        rows = table[table.method == method].sort_values(x)
        rows = rows.assign(place=rows[x] * np.exp(shift) if log else rows[x] + shift)
        there, missing = rows[rows.value.notna()], rows[rows.value.isna()]
        rate_points(there.place, there, method, ax, NAMES[method], "-")
        for row in there.itertuples() if dots else ():
            ax.scatter([row.place + apart / 2] * len(row.seeds), row.seeds, s=8, color="white", lw=0.6, zorder=4,
                       edgecolor=COLOURS[method], clip_on=False)
        height = 0.03 + 0.09 * methods.index(method)
        ax.plot(missing[x], np.full(len(missing), height), ls="none", marker="$?$", ms=5, mew=0.3,
                color=COLOURS[method], label="_missing")
    if log:
        log_ticks(ticks, ax)
    else:
        ax.set_xticks(ticks, [short(tick) for tick in ticks])
    ax.set_xlabel(label)
    success_axis(ax)


def printed_points(points: pd.DataFrame, ax: Axes) -> None:
    """The paper's success at its own budgets, a hollow diamond in each method's colour.

    Args:
        points: method, timesteps, value.
    """
    for row in points.itertuples():
        ax.plot(row.timesteps, row.value, "D", ms=3.5, mew=1.0, color=COLOURS[row.method], mfc="none", zorder=4,
                clip_on=False)


def level(value: float, label: str, ax: Axes) -> None:
    """A horizontal line, a floor or a ceiling, whose label ends at the axis's right end."""
    ax.axhline(value, color="#666666", lw=0.9, ls="--")
    ax.annotate(label, (1.0, value), xycoords=("axes fraction", "data"), xytext=(-2, 2), textcoords="offset points",
                ha="right", fontsize=LEAST_POINTS, color="#444444")


def reference(rate: Any, ax: Axes) -> None:
    """The rate of a method that knows nothing of the axis: a dashed line in its colour, its interval as a band.

    Args:
        rate: a row with method, value, low, high.
    """
    ax.axhspan(rate.low, rate.high, color=COLOURS[rate.method], alpha=0.13, lw=0)
    ax.axhline(rate.value, **REFERENCE, color=COLOURS[rate.method])


def reference_entry(method: str) -> Line2D:
    """What a legend shows of such a line."""
    return Line2D([], [], **REFERENCE, color=COLOURS[method], label=NAMES[method])


def entries(methods: Sequence[str], paper: str = "", missing: bool = False) -> list[Line2D]:
    """What a legend shows of curves and points: a line a method, and in grey what diamonds and question marks are."""
    handles = [Line2D([], [], color=COLOURS[name], marker=MARKERS[name], ms=3.4, lw=1.0, label=NAMES[name])
               for name in in_order(methods)]
    handles += [Line2D([], [], ls="none", marker="D", ms=3.5, color="#444444", mfc="white", label=paper)] * bool(paper)
    handles += [Line2D([], [], ls="none", marker="$?$", ms=5, mew=0.3, color="#444444", label="missing")] * missing
    return handles


def coverages(table: pd.DataFrame, ax: Axes) -> None:
    """How often intervals hold the truth: one group a deviation of trainings, one mark a number of seeds.

    Args:
        table: as `move.statistics.simulation.coverage` gives it.
    """
    deviations, counts = sorted(table.deviation.unique()), sorted(table.seeds.unique())
    shifts = dict(zip(counts, np.linspace(-0.22, 0.22, len(counts)) * (len(counts) > 1), strict=True))
    for (name, count), rows in table.groupby(["interval", "seeds"], sort=False):
        places = [deviations.index(value) + shifts[count] for value in rows.deviation]
        ours = name == "ours"
        ax.plot(places, rows.covered, "os^D"[counts.index(count) % 4], ms=4, color="black" if ours else "#999999",
                mfc="black" if ours else "white", label=f"{name}, {count} seed{'s' * (count > 1)}")
    ax.axhspan(0.93, 0.97, color="#999999", alpha=0.25, lw=0)
    ax.set_xticks(range(len(deviations)), [f"{100 * value:.0f}" for value in deviations])
    success_axis(ax)
    ax.set(xlabel="trainings differ by (points, standard deviation)", ylabel="intervals that hold the truth (%)")


def half_widths(table: pd.DataFrame, ax: Axes) -> None:
    """How wide the intervals are against the number of seeds: one line a deviation of trainings.

    Args:
        table: seeds, deviation, half_width, of one kind of interval.
    """
    most, apart = table.deviation.max(), 0.06 * table.half_width.max()  # names of lines do not touch
    for deviation, rows in table.groupby("deviation"):
        ax.plot(rows.seeds, rows.half_width, "o-", color="black", alpha=0.35 + 0.65 * deviation / most, ms=3.5)
    ends = table[table.seeds == table.seeds.max()].sort_values(["half_width", "deviation"])
    for last, height in zip(ends.itertuples(), kept_apart(ends.half_width.to_numpy(), apart), strict=True):
        ax.annotate(f"{100 * last.deviation:.0f} points", (last.seeds, height), xytext=(4, -2),
                    textcoords="offset points", fontsize=LEAST_POINTS)
    ax.yaxis.set_major_formatter(per_cent)
    ax.yaxis.set_major_locator(MultipleLocator(0.05))
    ax.set(xlabel="seeds", ylabel="half width of the interval (points)", xticks=sorted(table.seeds.unique()),
           xlim=(None, table.seeds.max() + 1), ylim=(0, None))

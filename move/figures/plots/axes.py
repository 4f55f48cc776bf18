"""What plots of rates share: axes in per cent and in points, ticks, points with their intervals."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from move.figures.plots.style import COLOURS, MARKERS

PRINTED: dict[str, Any] = {"color": "black", "ls": ":", "lw": 1.4}  # the paper's value on a bar

POOLED = "like cells"  # what an interval knows of trainings where there is a single one, see `Estimate`


def errors(rows, column: str = "value") -> np.ndarray:
    """How far intervals go below and above the values of a column, (2, rows), as `Axes.errorbar` takes it.

    Args:
        rows: a table with the column, low and high; or one row of it.
    """
    values = getattr(rows, column)
    return np.reshape([values - rows.low, rows.high - values], (2, -1))


def per_cent(share: float, _: object = None) -> str:
    """How ticks of shares are written."""
    return f"{100 * share:.0f}"


def lines_axis(labels: Sequence[str], ax: Axes) -> None:
    """A vertical axis of lines with their names, the first one at the top."""
    ax.set_yticks(range(len(labels)), labels)
    ax.set_ylim(max(len(labels), 1) - 0.5, -0.5)


def rate_points(places: Sequence[float] | np.ndarray, rows: pd.DataFrame, method: str, ax: Axes,
                label: str | None = None, line: str = "", colour: str = "") -> None:
    """A method's rates with their intervals, in its colour and with its marker; open where an interval is pooled.

    Args:
        places: on the horizontal axis, one a row.
        rows: value, low, high; and, where it is known, trainings, see `is_pooled`.
        line: style of a line that joins them; by default none.
        colour: in place of the method's.
    """
    colour, spots = colour or COLOURS[method], np.asarray(places, float)
    ax.errorbar(spots, rows.value, errors(rows), fmt=MARKERS[method] + line, ms=3.4, lw=1.0, capsize=1.5, color=colour,
                label=label)
    pooled = is_pooled(rows)
    ax.plot(spots[pooled], rows.value[pooled], MARKERS[method], ms=3.4, mew=0.9, color=colour, mfc="white", zorder=3,
            label="_pooled")


def is_pooled(rows: pd.DataFrame) -> np.ndarray:
    """Whether the interval of each row comes from a single training and how like cells differ, (rows,) bool."""
    return np.asarray(rows["trainings"] == POOLED) if "trainings" in rows else np.zeros(len(rows), bool)


def pooled_entry(table: pd.DataFrame) -> list[Line2D]:
    """What a legend shows of the open points of `table`; nothing where it has none."""
    return [Line2D([], [], ls="none", marker="o", ms=3.4, mew=0.9, color="#444444", mfc="white",
                   label="open: one seed, spread of like cells")] * bool(is_pooled(table).any())


def success_axis(ax: Axes, bars: bool = False) -> None:
    """A vertical axis of success rates, written in per cent; bars stand on its lower end."""
    ax.yaxis.set_major_formatter(per_cent)
    ax.yaxis.set_major_locator(MultipleLocator(0.2))
    ax.set(ylabel="success (%)", ylim=(0 if bars else -0.03, 1.05))


def points_axis(ax: Axes, label: str) -> None:
    """A horizontal axis of differences of rates, written in points, with 0 marked."""
    ax.axvline(0, color="black", lw=0.8)
    ax.xaxis.set_major_formatter(lambda value, _: f"{100 * value:+.0f}".replace("-", "\N{MINUS SIGN}")
                                 if round(100 * value) else "0")
    ax.set_xlabel(label)


def kept_apart(places: np.ndarray, least: float) -> np.ndarray:
    """Increasing places moved as little as it takes (least squares) to be `least` apart.

    >>> kept_apart(np.array([0.0, 1.0, 1.0]), 0.5).tolist()
    [0.0, 0.75, 1.25]
    """
    from scipy.optimize import isotonic_regression  # slow to import

    steps = least * np.arange(len(places))
    return isotonic_regression(places - steps).x + steps


def log_ticks(ticks: Iterable[float], ax: Axes) -> None:
    """A logarithmic horizontal axis with these ticks; one too near to the last named one has no name."""
    places = sorted(ticks)
    apart, names, last = 0.16 * np.log(places[-1] / places[0]), [], -np.inf
    for place in places:
        near = np.log(place) - last < apart
        names.append("" if near else short(place))
        last = last if near else np.log(place)
    ax.set_xscale("log")
    ax.set_xticks(places, names)
    ax.minorticks_off()


def short(number: float) -> str:
    """A tick in few letters.

    >>> short(2500), short(0.333)
    ('2.5k', '0.33')
    """
    if number >= 100:
        return f"{number / 1000:g}k" if number >= 1000 else f"{number:.0f}"
    return f"{number:.2g}"

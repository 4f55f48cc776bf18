"""What plots of rates share: axes in per cent and in points, ticks, tasks' names, ends of error bars."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MultipleLocator

from move.sim.tasks import TASKS

PRINTED: dict[str, Any] = {"color": "black", "ls": ":", "lw": 1.4}  # the paper's value on a bar

GREY = "#777777"


def errors(row) -> list[list[float]]:
    """How far an interval goes below and above its value, as `Axes.errorbar` takes it."""
    return [[row.value - row.low], [row.high - row.value]]


def success_axis(ax: Axes, bars: bool = False) -> None:
    """A vertical axis of success rates, written in per cent; bars stand on its lower end."""
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    ax.yaxis.set_major_locator(MultipleLocator(0.2))
    ax.set(ylabel="success (%)", ylim=(0 if bars else -0.03, 1.05))


def points_axis(ax: Axes, label: str) -> None:
    """A horizontal axis of differences of rates, written in points, with 0 marked."""
    ax.axvline(0, color="black", lw=0.8)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:+.0f}".replace("-", "\N{MINUS SIGN}")
                                               if round(100 * value) else "0"))
    ax.set_xlabel(label)


def task_axis(tasks: Sequence[str], ax: Axes) -> None:
    """A horizontal axis of tasks by their titles, broken at hyphens where many stand side by side."""
    names = [TASKS[task].title for task in tasks]
    ax.set_xticks(range(len(tasks)), [name.replace("-", "-\n") for name in names] if len(tasks) > 4 else names)
    ax.set_xlim(-0.6, len(tasks) - 0.4)
    success_axis(ax)


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

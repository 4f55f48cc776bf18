"""Bars: rates in groups, one thing after the other, and costs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from move.figures.plots.axes import PRINTED, errors, success_axis
from move.figures.plots.style import COLOURS, GREY, LEAST_POINTS, NAMES, in_order

NORMAL = 1.96  # half width of a 95 % interval in standard deviations, where these are known


def grouped_rates(table: pd.DataFrame, by: str, labels: list[str], ax: Axes) -> None:
    """Success rates of the methods side by side for each value of `by`, with intervals, seeds and the paper's values.

    Args:
        table: `by`, method, value, low, high, seeds (list of single seeds' rates), paper (NaN where it gives none);
            any row may be missing.
        labels: what to call the values of `by`, in their order.
    """
    groups, methods = list(table[by].unique()), in_order(table.method)
    width, named = 0.8 / len(methods), set()
    for row in table.itertuples():
        place = groups.index(getattr(row, by)) + (methods.index(row.method) - (len(methods) - 1) / 2) * width
        _bar(place, row, 0.9 * width, ax, label=None if row.method in named else NAMES[row.method])
        _printed_line(place, row.paper, width, ax)
        named |= set() if np.isnan(row.value) else {row.method}
    ax.set_xticks(range(len(groups)), labels)
    ax.set_xlim(-0.5, len(groups) - 0.5)
    success_axis(ax, bars=True)


def ladder(table: pd.DataFrame, by: str, ax: Axes) -> None:
    """Success as one thing after the other moves, or alone: one bar a value of `by`, with interval and seeds.

    Args:
        table: `by`, method, value, low, high, seeds (list of single seeds' rates).
    """
    for place, row in enumerate(table.itertuples()):
        _bar(place, row, 0.66, ax, alpha=0.45 if "alone" in getattr(row, by) else 0.85)
    ax.set_xticks(range(len(table)), [name.replace(" + ", "\n+ ").replace(" alone", "\nalone") for name in table[by]])
    ax.set_xlim(-0.6, len(table) - 0.4)
    success_axis(ax, bars=True)


def _bar(place: float, row, width: float, ax: Axes, label: str | None = None, alpha: float = 0.85) -> None:
    """One method's rate as a bar with its interval and a white dot a seed, or the word "missing"."""
    if np.isnan(row.value):
        ax.annotate("missing", (place, 0.02), ha="center", va="bottom", rotation=90, color=GREY, fontsize=LEAST_POINTS)
        return
    ax.bar(place, row.value, width=width, color=COLOURS[row.method], alpha=alpha, label=label)
    ax.errorbar(place, row.value, errors(row), color="black", capsize=2, lw=0.9)
    spread = 0.3 * width + 0.06 * width * np.arange(len(row.seeds))
    ax.scatter(place + spread - spread.mean() + 0.3 * width, row.seeds, s=8, color="white", edgecolor="black", lw=0.6,
               zorder=4, clip_on=False)


def _printed_line(place: float, value: float, width: float, ax: Axes) -> None:
    """The paper's value as a dotted line over a bar; in the legend once."""
    if not np.isnan(value):
        known = "paper" in ax.get_legend_handles_labels()[1]
        ax.plot([place - width / 2, place + width / 2], [value, value], **PRINTED, label=None if known else "paper")


def costs(table: pd.DataFrame, value: str, paper: dict[str, float], ax: Axes, share: bool = False) -> None:
    """Mean over the tasks of `value` for each method, one bar an expert, single tasks as dots, the paper dotted.

    The error bar is a 95 % interval of the mean over these same tasks, from the demonstrations of each.

    Args:
        table: task, method, expert, the column `value`, and `value` with "_error", its standard error.
        paper: the paper's value for each method that it has.
        share: whether the values are shares of 1, written in per cent.
    """
    methods, experts = list(table.method.unique()), list(table.expert.unique())
    for place, method in enumerate(methods):
        for expert, shift in zip(experts, (-0.2, 0.2), strict=False):
            rows = table[(table.method == method) & (table.expert == expert)]
            values, errors_of = rows[value], rows[f"{value}_error"].dropna()
            half = NORMAL * float(np.hypot.reduce(errors_of)) / max(len(errors_of), 1)
            ax.bar(place + shift, values.mean(), width=0.36, color=COLOURS[method], alpha=0.85 if shift < 0 else 0.45)
            low, high = np.clip(values.mean() + [-half, half], *((0, 1) if share else (-np.inf, np.inf)))
            ax.errorbar(place + shift, values.mean(), [[values.mean() - low], [high - values.mean()]], color="black",
                        capsize=2, lw=0.9)
            ax.plot(np.full(len(values), place + shift + 0.1), values, ".", color="#444444", ms=3, clip_on=False)
        if method in paper:
            ax.plot([place - 0.42, place + 0.42], [paper[method]] * 2, **PRINTED)
    ax.set_xticks(range(len(methods)), [NAMES[method] for method in methods])
    if share:
        success_axis(ax, bars=True)


def cost_entries(experts: Sequence[str]) -> list[Patch | Line2D]:
    """What a legend of `costs` shows: which bars are whose, and the paper's line."""
    names = {"phase": "phase expert (ours)", "metaworld": "Meta-World's expert"}
    bars = [Patch(color="#444444", alpha=alpha, label=names.get(expert, expert))
            for expert, alpha in zip(experts, (0.85, 0.45), strict=False)]
    dot = Line2D([], [], ls="none", marker=".", ms=4, color="#444444", label="a task")
    return [*bars, dot, Line2D([], [], **PRINTED, label="paper")]

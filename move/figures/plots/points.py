"""Points with intervals: differences, factors, tasks side by side, one policy in several places, coverage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter

from move.figures.plots.axes import GREY, errors, points_axis, success_axis, task_axis
from move.figures.plots.style import COLOURS, DIFFERENCES, LEAST_POINTS, NAMES
from move.paper import PAPER_TASKS
from move.sim.tasks import TASKS

VERDICT_COLOURS = {
    "reproduced": "#009E73", "reproduced, smaller": "#56B4E9", "reproduced, larger": "#56B4E9",
    "direction only": "#0072B2", "undecided": "#999999", "at the ceiling": "#E69F00", "refuted here": "#D55E00",
    "not computed yet": "#BBBBBB",
}
"""Of `move.statistics.verdicts.VERDICTS` those that a claim with a number can have."""
READINGS = {"as printed": "#999999", "mended": "#56B4E9", "periodic": "#CC79A7"}


def differences(table: pd.DataFrame, by: str, labels: list[str], ax: Axes, means: pd.DataFrame | None = None) -> None:
    """Differences MOVE minus another method with intervals, 0 marked; a column `paper` as diamonds.

    Args:
        table: as `move.figures.tables.difference_table` gives it.
        labels: what to call the values of `by`, in their order.
        means: as `move.figures.tables.difference_means` gives them: drawn below the last item, under a line.
    """
    if means is not None and len(means):
        names = [f"mean of {items}" for items in means["items"]]
        ax.axhline(table[by].nunique() - 0.5, color="#BBBBBB", lw=0.8)
        table = pd.concat([table, means.drop(columns="items").assign(**{by: names})], ignore_index=True)
        labels = [*labels, *dict.fromkeys(names)]
    values, others = list(table[by].unique()), list(table.baseline.unique())
    for place, other in enumerate(others):
        rows = table[table.baseline == other]
        places = np.array([values.index(value) for value in rows[by]]) + (place - (len(others) - 1) / 2) * 0.4
        colour, marker = DIFFERENCES[other]
        ends = [rows.difference - rows.low, rows.high - rows.difference]
        ax.errorbar(rows.difference, places, xerr=ends, fmt=marker, ms=3.5, lw=1, capsize=1.5, color=colour,
                    label=f"MOVE \N{MINUS SIGN} {NAMES[other]}")
        if "paper" in rows:
            ax.plot(rows.paper, places, "D", ms=3.5, mew=0.9, color=colour, mfc="white", zorder=4, clip_on=False,
                    label=f"MOVE \N{MINUS SIGN} {NAMES[other]}, paper")
    ax.set_yticks(range(len(values)), labels)
    ax.set_ylim(max(len(values), 1) - 0.5, -0.5)
    points_axis(ax, "difference of success (points)")


def forest(table: pd.DataFrame, ax: Axes) -> None:
    """Claims with their numbers, one line each: ours with its interval in the verdict's colour, the paper's a diamond.

    Args:
        table: as `move.claims.ledger.numbers` gives it; of several numbers the single ones are drawn small.
    """
    listed = table[["number", "claim", "figure"]].drop_duplicates().reset_index(drop=True)
    place_of = {number: place for place, number in enumerate(listed.number)}
    for row in table.itertuples():
        place, colour = place_of[row.number], VERDICT_COLOURS.get(row.verdict, GREY)
        if not row.whole:
            ax.plot(row.value, place, "|", ms=5, mew=0.8, color=colour, alpha=0.6)
            continue
        ax.errorbar(row.value, place, xerr=[[row.value - row.low], [row.high - row.value]], fmt="o", ms=3.5, lw=1.1,
                    capsize=1.5, color=colour)
        ax.plot(row.paper, place, "D", ms=3.5, mew=0.9, color="#444444", mfc="white", zorder=4)
    for place in np.flatnonzero(listed.figure != listed.figure.shift())[1:]:
        ax.axhline(place - 0.5, color="#DDDDDD", lw=0.7)
    ax.set_yticks(range(len(listed)), [f"{row.claim if len(row.claim) <= 52 else row.claim[:50].rstrip() + ' ...'}  "
                                       f"{row.number}" for row in listed.itertuples()])
    ax.set_ylim(max(len(listed), 1) - 0.5, -0.5)
    ax.axvline(0, color="black", lw=0.8)


def forest_entries(verdicts: Sequence[str]) -> list[Line2D]:
    """What a legend of `forest` shows: a colour a verdict that is there, and the paper's diamond."""
    there = [Line2D([], [], marker="o", ms=3.5, lw=1.1, color=colour, label=name)
             for name, colour in VERDICT_COLOURS.items() if name in verdicts]
    return [*there, Line2D([], [], ls="none", marker="D", ms=3.5, mew=0.9, color="#444444", mfc="white", label="paper")]


def efficiencies(table: pd.DataFrame, ax: Axes) -> None:
    """How many times MOVE's timesteps static needs, one line a task; an arrow where static does not reach MOVE.

    Args:
        table: as `move.figures.fig4_scaling.efficiency_table` gives it; a ratio of NaN is missing.
    """
    for place, row in enumerate(table.itertuples()):
        if np.isnan(row.ratio):
            ax.annotate("missing", (1.06, place), va="center", color=GREY, fontsize=LEAST_POINTS)
            continue
        value, low, high = (min(number, row.most) for number in (row.ratio, row.low, row.high))
        ax.errorbar(value, place, xerr=[[value - low], [high - value]], fmt="o", ms=3.5, lw=1, capsize=1.5,
                    color="black", mfc="white" if row.ratio > row.most else "black")
        if row.high > row.most:
            ax.plot(row.most, place, ">", ms=4, color="black")
    ax.axvline(1, color="black", lw=0.8)
    ax.set_xscale("log", base=2)
    ax.set_xticks([0.25, 0.5, 1, 2, 4], ["1/4", "1/2", "1", "2", "4"])
    ax.set_xlim(0.22, 4.6)
    ax.set_yticks(range(len(table)), [TASKS[task].title for task in table.task])
    ax.set_ylim(max(len(table), 1) - 0.5, -0.5)
    ax.set_xlabel("static's timesteps / MOVE's, same success")


def task_rates(table: pd.DataFrame, controls: pd.DataFrame, ax: Axes) -> None:
    """One group for each of the paper's tasks: the methods' rates with intervals, between its floor and its ceiling.

    A task that the table does not hold is marked as missing.

    Args:
        table: task, method, value, low, high; and, where the paper gives any, paper: hollow diamonds in the method's
            colour next to its point.
        controls: one row a task; columns "expert" (ceiling) and, where it exists, "goal-blind" (floor).
    """
    tasks, methods = list(PAPER_TASKS), [name for name in COLOURS if name in set(table.method)]
    for place, task in enumerate(tasks):
        if task not in set(table.task):
            ax.annotate("missing", (place, 0.5), ha="center", va="center", rotation=90, fontsize=LEAST_POINTS,
                        color=GREY)
    for method, shift in zip(methods, np.linspace(-0.28, 0.24, len(methods)), strict=True):
        rows = table[table.method == method].set_index("task").reindex(tasks)
        _rates_at(np.arange(len(tasks)) + shift, rows, COLOURS[method], NAMES[method], ax)
        if "paper" in table:
            ax.plot(np.arange(len(tasks)) + shift + 0.1, rows.paper, "D", color=COLOURS[method], mfc="white", ms=3,
                    mew=0.9, zorder=4)
    if "paper" in table:
        ax.plot([], [], "D", color="#444444", mfc="white", ms=3, label="paper")
    for name, style in (("expert", "-"), ("goal-blind", "--")):
        if name in controls:
            ax.hlines(controls[name].reindex(tasks), np.arange(len(tasks)) - 0.42, np.arange(len(tasks)) + 0.42,
                      color="#444444", ls=style, lw=0.9, label=NAMES[name])
    task_axis(tasks, ax)


def readings(table: pd.DataFrame, column: str, ax: Axes) -> None:
    """One group for each task: the rates of the variants of one method, named in `column`, with intervals.

    Args:
        table: task, the column, value, low, high.
    """
    tasks = [task for task in TASKS if task in set(table.task)]
    for (name, colour), shift in zip(READINGS.items(), (-0.2, 0.0, 0.2), strict=True):
        rows = table[table[column] == name].set_index("task").reindex(tasks)
        _rates_at(np.arange(len(tasks)) + shift, rows, colour, name, ax)
    task_axis(tasks, ax)


def _rates_at(places: np.ndarray, rows: pd.DataFrame, colour: str, label: str, ax: Axes) -> None:
    ax.errorbar(places, rows.value, [rows.value - rows.low, rows.high - rows.value], fmt="o", ms=3.2, lw=0.9,
                capsize=1.5, color=colour, label=label)


def own_and_elsewhere(table: pd.DataFrame, ax: Axes) -> None:
    """One group for each task: a policy's rate at its own grasps (hollow), elsewhere (filled), in motion (triangle).

    Args:
        table: task, method, group ("grasp", "random" or "moving"), value, low, high; any group may be missing.
    """
    tasks, methods = list(table.task.unique()), [name for name in COLOURS if name in set(table.method)]
    shifts = dict(zip(methods, np.linspace(-0.26, 0.26, len(methods)) * (len(methods) > 1), strict=True))
    aside = {"grasp": -0.08, "random": 0.0, "moving": 0.08}
    for (task, method), rows in table.groupby(["task", "method"], sort=False):
        place = tasks.index(task) + shifts[method]
        rows = rows.set_index("group").reindex([group for group in aside if group in set(rows.group)]).reset_index()
        ax.plot([place + aside[group] for group in rows.group], rows.value, color=COLOURS[method], lw=2, alpha=0.35)
        for row in rows.itertuples():
            ax.errorbar(place + aside[row.group], row.value, errors(row), fmt="^" if row.group == "moving" else "o",
                        ms=3.5, lw=0.8, capsize=1.5, color=COLOURS[method],
                        mfc="white" if row.group == "grasp" else COLOURS[method])
    task_axis(tasks, ax)


def own_and_elsewhere_entries(table: pd.DataFrame) -> list[Line2D | Patch]:
    """What a legend of `own_and_elsewhere` shows: a colour a method, and in grey the three shapes."""
    methods = [Patch(color=COLOURS[name], label=NAMES[name]) for name in COLOURS if name in set(table.method)]
    shapes = (("o", "white", "at its own grasps"), ("o", "#444444", "elsewhere"),
              ("^", "#444444", "elsewhere, in motion"))
    return methods + [Line2D([], [], ls="none", marker=marker, ms=4, color="#444444", mfc=filling, label=name)
                      for marker, filling, name in shapes]


def changes(table: pd.DataFrame, ax: Axes) -> None:
    """Success of the recipe with one change at a time, one line a row with its interval.

    Args:
        table: as `move.figures.tables.rates.recipe_table` gives it.
    """
    _change_lines(table, table.value, table.low, table.high, ax)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    ax.set(xlabel="success (%)", xlim=(0.4, 1.03))


def gains(table: pd.DataFrame, ax: Axes) -> None:
    """What one change at a time gains over the chosen recipe, one line a row with its interval and training's minutes.

    Args:
        table: as `move.figures.tables.rates.recipe_table` gives it; a gain of NaN is left out.
    """
    _change_lines(table, table.gain, table.gain_low, table.gain_high, ax)
    for place, minutes in enumerate(table.train_minutes):
        ax.annotate(f"{minutes:.1f} min", (1, place), xycoords=("axes fraction", "data"), xytext=(3, 0), va="center",
                    textcoords="offset points", fontsize=LEAST_POINTS, color="#444444")
    points_axis(ax, "gain (points)")


def _change_lines(table: pd.DataFrame, values: pd.Series, lows: pd.Series, highs: pd.Series, ax: Axes) -> None:
    for place, (change, value, low, high) in enumerate(zip(table.change, values, lows, highs, strict=True)):
        ax.errorbar(value, place, xerr=[[value - low], [high - value]], fmt="o", ms=3.5, lw=1, capsize=1.5,
                    color="black" if change == "chosen" else GREY, clip_on=False)
    ax.set_yticks(range(len(table)), table.change)
    ax.set_ylim(len(table) - 0.5, -0.5)


def covered(table: pd.DataFrame, column: str, ax: Axes) -> None:
    """Success against the share of cells in `column`, one mark a task and what moves; a line joins those of a task.

    Args:
        table: as `move.figures.fig_coverage.seen` gives it.
    """
    for _, rows in table.groupby("task", sort=False):
        rows = rows.sort_values(column)
        ax.plot(rows[column], rows.value, color="#bbbbbb", lw=0.7, zorder=1)
    for method, rows in table.groupby("method", sort=False):
        part = ~rows.moves.isin(["nothing", "jumps", "all"])
        ax.errorbar(rows[column], rows.value, [rows.value - rows.low, rows.high - rows.value], fmt="none", lw=0.6,
                    ecolor=COLOURS[method], alpha=0.5, zorder=2)
        for shown, marker, name in ((rows[~part], "o", NAMES[method]), (rows[part], "^", f"{NAMES[method]}, in part")):
            if len(shown):
                ax.plot(shown[column], shown.value, marker, ms=4, color=COLOURS[method], label=name, zorder=3)
    success_axis(ax)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    ax.set(xlabel="cells that the data visit (%)", xlim=(-0.02, 1.04))

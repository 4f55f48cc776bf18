"""Points with intervals: differences, factors, tasks side by side, one policy in several places, coverage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from move.figures.plots.axes import errors, kept_apart, lines_axis, per_cent, points_axis, rate_points, success_axis
from move.figures.plots.style import COLOURS, DIFFERENCES, GREY, LEAST_POINTS, MARKERS, NAMES, in_order
from move.paper import PAPER_TASKS
from move.sim.tasks import TASKS

VERDICT_COLOURS = {
    "reproduced": "#009E73", "reproduced, smaller": "#56B4E9", "reproduced, larger": "#56B4E9",
    "direction only": "#0072B2", "undecided": "#999999", "at the ceiling": "#E69F00", "refuted here": "#D55E00",
    "not computed yet": "#BBBBBB",
}
"""Of `move.statistics.verdicts.VERDICTS` those that a claim with a number can have."""
PLACES = {"grasp": "at its own\ngrasps", "random": "elsewhere", "moving": "elsewhere,\nin motion"}
"""Where a policy is tried, by the group of its episodes."""
READINGS = {"as printed": "#999999", "mended": "#56B4E9", "periodic": "#CC79A7"}


def differences(table: pd.DataFrame, by: str, labels: list[str], ax: Axes, means: pd.DataFrame | None = None) -> None:
    """Differences MOVE minus another method with intervals, 0 marked; a column `paper` as diamonds.

    Args:
        table: as `move.figures.tables.differences.difference_table` gives it.
        labels: what to call the values of `by`, in their order.
        means: as `difference_means` there gives them: drawn below the last item, under a line.
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
        ax.errorbar(rows.difference, places, xerr=errors(rows, "difference"), fmt=marker, ms=3.5, lw=1, capsize=1.5,
                    color=colour, label=f"MOVE \N{MINUS SIGN} {NAMES[other]}")
        if "paper" in rows:
            ax.plot(rows.paper, places, "D", ms=3.5, mew=0.9, color=colour, mfc="white", zorder=4, clip_on=False,
                    label=f"MOVE \N{MINUS SIGN} {NAMES[other]}, paper")
    lines_axis(labels, ax)
    points_axis(ax, "difference of success (points)")


def forest(table: pd.DataFrame, ax: Axes, above: bool = False) -> None:
    """Claims with their numbers, one line each: ours with its interval in the verdict's colour, the paper's a diamond.

    Args:
        table: as `move.claims.ledger.numbers` gives it; of several numbers the single ones are drawn small, and those
            without an upper end as an arrow from the lower one. Black strokes are the edges of what is claimed.
        above: whether a claim's words are above its line, as where there is no room beside it.
    """
    listed = table[["number", "claim", "figure"]].drop_duplicates().reset_index(drop=True)
    place_of = {number: place for place, number in enumerate(listed.number)}
    beside = table.groupby(["number", "whole"]).cumcount()  # several intervals of a claim stand one below the other
    of_claim = table.groupby(["number", "whole"]).number.transform("size")
    for row, shift in zip(table.itertuples(), 0.24 * (beside - (of_claim - 1) / 2), strict=True):
        place, colour = place_of[row.number] + shift * row.whole, VERDICT_COLOURS.get(row.verdict, GREY)
        if not row.whole:
            endless = np.isnan(row.value)
            ax.plot(row.low if endless else row.value, place, ">" if endless else "|", ms=4 if endless else 5, mew=0.8,
                    color=colour, alpha=0.6)
            continue
        ax.errorbar(row.value, place, xerr=errors(row), fmt="o", ms=3.5, lw=1.1, capsize=1.5, color=colour)
        ax.plot(row.paper, place, "D", ms=3.5, mew=0.9, color="#444444", mfc="white", zorder=4)
    for number, rows in table.groupby("number"):
        edges = [edge for edge in {*rows.above, *rows.below} if np.isfinite(edge)]
        ax.vlines(edges, place_of[number] - 0.32, place_of[number] + 0.32, color="black", lw=0.8)
    for place in np.flatnonzero(listed.figure != listed.figure.shift())[1:]:
        ax.axhline(place - 0.5 - 0.28 * above, color="#DDDDDD", lw=0.7)
    if above:
        ax.set_yticks([])
        ax.spines["left"].set_visible(False)
        for place, row in enumerate(listed.itertuples()):
            ax.text(0, place - 0.4, f"{row.number}  {row.claim}", transform=ax.get_yaxis_transform(), va="center",
                    fontsize=LEAST_POINTS, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
    else:
        ax.set_yticks(range(len(listed)), [f"{row.claim}  {row.number}" for row in listed.itertuples()])
        for label, figure in zip(ax.get_yticklabels(), listed.figure, strict=True):
            label.set_url(f"{figure}.pdf")
    ax.set_ylim(max(len(listed), 1) - 0.5, -0.5 - 0.4 * above)
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
            ax.plot(1.08 * row.most, place, ">", ms=4, color="black")
    ax.axvline(1, color="black", lw=0.8)
    ax.set_xscale("log", base=2)
    ax.set_xticks([0.25, 0.5, 1, 2, 4], ["1/4", "1/2", "1", "2", "4"])
    ax.set_xlim(0.22, 4.6)
    lines_axis([TASKS[task].title for task in table.task], ax)
    ax.set_xlabel("static's timesteps / MOVE's, same success")


def task_rates(table: pd.DataFrame, controls: pd.DataFrame, ax: Axes) -> None:
    """One group for each of the paper's tasks: the methods' rates with intervals, between its floor and its ceiling.

    A task that the table does not hold is marked as missing.

    Args:
        table: task, method, value, low, high; and, where the paper gives any, paper: hollow diamonds in the method's
            colour next to its point.
        controls: one row a task; columns "expert" (ceiling) and, where it exists, "goal-blind" (floor).
    """
    tasks, methods = list(PAPER_TASKS), in_order(table.method)
    for place, task in enumerate(tasks):
        if task not in set(table.task):
            ax.annotate("missing", (place, 0.5), ha="center", va="center", rotation=90, fontsize=LEAST_POINTS,
                        color=GREY)
    for method, shift in zip(methods, np.linspace(-0.28, 0.24, len(methods)), strict=True):
        rows = table[table.method == method].set_index("task").reindex(tasks)
        rate_points(np.arange(len(tasks)) + shift, rows, method, ax, NAMES[method])
        if "paper" in table:
            ax.plot(np.arange(len(tasks)) + shift + 0.1, rows.paper, "D", color=COLOURS[method], mfc="white", ms=3,
                    mew=0.9, zorder=4)
    if "paper" in table:
        ax.plot([], [], "D", color="#444444", mfc="white", ms=3, label="paper")
    for name, style in (("expert", "-"), ("goal-blind", "--")):
        if name in controls:
            ax.hlines(controls[name].reindex(tasks), np.arange(len(tasks)) - 0.42, np.arange(len(tasks)) + 0.42,
                      color="#444444", ls=style, lw=0.9, label=NAMES[name])
    _task_axis(tasks, ax)


def _task_axis(tasks: Sequence[str], ax: Axes) -> None:
    """A horizontal axis of tasks by their titles, broken at hyphens where many stand side by side."""
    names = [TASKS[task].title for task in tasks]
    ax.set_xticks(range(len(tasks)), [name.replace("-", "-\n") for name in names] if len(tasks) > 4 else names)
    ax.set_xlim(-0.6, len(tasks) - 0.4)
    success_axis(ax)


def readings(table: pd.DataFrame, column: str, ax: Axes) -> None:
    """One group for each task: the rates of the variants of one method, named in `column`, with intervals.

    Args:
        table: task, the column, value, low, high.
    """
    tasks = [task for task in TASKS if task in set(table.task)]
    for (name, colour), shift in zip(READINGS.items(), (-0.2, 0.0, 0.2), strict=True):
        rows = table[table[column] == name].set_index("task").reindex(tasks)
        rate_points(np.arange(len(tasks)) + shift, rows, "adc", ax, name, colour=colour)
    _task_axis(tasks, ax)


def own_and_elsewhere(table: pd.DataFrame, ax: Axes) -> None:
    """A line for each method's policy: its rate at its own grasps, elsewhere, and elsewhere in motion.

    Args:
        table: method, group ("grasp", "random" or "moving"), value, low, high; any group may be missing.
    """
    methods = in_order(table.method)
    for method, shift in zip(methods, np.linspace(-0.12, 0.12, len(methods)) * (len(methods) > 1), strict=True):
        rows = table[table.method == method].set_index("group").reindex(list(PLACES)).dropna(subset="value")
        rate_points(np.array([list(PLACES).index(group) for group in rows.index]) + shift, rows, method, ax,
                    NAMES[method], "-")
    ax.set_xticks(range(len(PLACES)), list(PLACES.values()))
    ax.set_xlim(-0.4, len(PLACES) - 0.6)
    success_axis(ax)


def changes(table: pd.DataFrame, ax: Axes) -> None:
    """Success of the recipe with one change at a time, one line a row with its interval.

    Args:
        table: as `move.figures.table_recipe.tables` gives it.
    """
    _change_lines(table, ax)
    ax.xaxis.set_major_formatter(per_cent)
    ax.set(xlabel="success (%)", xlim=(0.4, 1.03))


def gains(table: pd.DataFrame, ax: Axes) -> None:
    """What one change at a time gains over the chosen recipe, one line a row with its interval and training's minutes.

    The chosen recipe is drawn at 0, without an interval: it is what the others are compared with.

    Args:
        table: as `move.figures.table_recipe.tables` gives it; a gain of NaN is left out.
    """
    chosen = table.change == "chosen"
    low, high = (ends.mask(chosen, table.gain) for ends in (table.gain_low, table.gain_high))
    _change_lines(table.assign(value=table.gain, low=low, high=high), ax)
    ax.annotate("training", (1, 1), xycoords="axes fraction", xytext=(3, 2), textcoords="offset points", va="bottom",
                fontsize=LEAST_POINTS, color="#444444")
    for place, minutes in enumerate(table.train_minutes):
        ax.annotate(f"{minutes:.1f} min", (1, place), xycoords=("axes fraction", "data"), xytext=(3, 0), va="center",
                    textcoords="offset points", fontsize=LEAST_POINTS, color="#444444")
    points_axis(ax, "gain (points)")


def _change_lines(table: pd.DataFrame, ax: Axes) -> None:
    for place, row in enumerate(table.itertuples()):
        ax.errorbar(row.value, place, xerr=errors(row), fmt="o", ms=3.5, lw=1, capsize=1.5,
                    color="black" if row.change == "chosen" else GREY, clip_on=False)
    lines_axis(table.change, ax)


def covered(table: pd.DataFrame, column: str, ax: Axes, named: bool = False) -> None:
    """Success against the share of cells in `column`, one mark a task and what moves; a line joins those of a task.

    The horizontal axis begins a little below the least share, at a multiple of 20 %.

    Args:
        table: as `move.figures.fig_coverage.seen` gives it.
        named: write each task's name next to its line.
    """
    for _, rows in table.groupby("task", sort=False):
        rows = rows.sort_values(column)
        ax.plot(rows[column], rows.value, color="#bbbbbb", lw=0.8, zorder=1)
    for method, rows in table.groupby("method", sort=False):
        part = ~rows.moves.isin(["nothing", "jumps", "all"])
        ax.errorbar(rows[column], rows.value, errors(rows), fmt="none", lw=0.6,
                    ecolor=COLOURS[method], alpha=0.4, zorder=2)
        for shown, size, strength, name in ((rows[~part], 4.2, 1.0, NAMES[method]),
                                            (rows[part], 3.4, 0.5, f"{NAMES[method]}, some of its motions only")):
            if len(shown):
                ax.plot(shown[column], shown.value, MARKERS[method], ms=size, mew=0, color=COLOURS[method],
                        alpha=strength, label=name, zorder=3)
    success_axis(ax)
    if named:
        _name_lines(table.sort_values(column).groupby("task").tail(1), column, ax)
    ax.xaxis.set_major_formatter(per_cent)
    ax.xaxis.set_major_locator(MultipleLocator(0.1 if table[column].min() >= 0.6 else 0.2))
    low = np.floor(table[column].min() / 0.2) * 0.2
    ax.set(xlabel="cells that the data visit (%)", xlim=(low - 0.02 * (1 - low), 1 + 0.04 * (1 - low)))


def _name_lines(ends: pd.DataFrame, column: str, ax: Axes) -> None:
    """Write the names of tasks to the right of where their lines end, none over another."""
    ends, right = ends.sort_values("value"), ends[column].max() + 0.03
    for row, height in zip(ends.itertuples(), kept_apart(ends.value.to_numpy(), 0.07), strict=True):
        ax.plot([getattr(row, column), right], [row.value, height], color="#bbbbbb", lw=0.4, zorder=1, clip_on=False)
        ax.annotate(TASKS[row.task].title, (right, height), va="center", fontsize=LEAST_POINTS, color="#444444")

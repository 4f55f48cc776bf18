"""Plot functions of rates: a tidy DataFrame and an Axes in, marks on the Axes out; nothing is read from disk.

Rates and differences are shares of 1 in the tables and on the axes, and are written in per cent and in points. A row
whose value is NaN is drawn as missing. Maps and frames are in `move.report.maps`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MultipleLocator

from move.intervals import student_half_width, wilson_interval
from move.paper import PAPER_TASKS
from move.report.style import COLOURS, DIFFERENCES, LEAST_POINTS, NAMES
from move.sim.tasks import TASKS

READINGS = {"as printed": "#999999", "mended": "#56B4E9", "periodic": "#CC79A7"}
PRINTED: dict[str, Any] = {"color": "black", "ls": ":", "lw": 1.4}  # the paper's value on a bar
GREY = "#777777"
NORMAL = 1.96  # half width of a 95 % interval in standard deviations, where these are known


def rates(table: pd.DataFrame, ax: Axes) -> None:
    """Success rates side by side, one a row of `table`, with intervals, single seeds and the paper's value.

    Args:
        table: method, value, low, high, seeds (list of single seeds' rates), paper (NaN where it gives none).
    """
    for place, row in enumerate(table.itertuples()):
        _bar(place, row, 0.62, ax)
        _printed_line(place, row.paper, 0.8, ax)
    ax.set_xticks(range(len(table)), [NAMES[name] for name in table.method])
    _success(ax, bars=True)
    ax.set_xlim(-0.6, len(table) - 0.4)


def grouped_rates(table: pd.DataFrame, by: str, labels: list[str], ax: Axes) -> None:
    """Success rates of the methods side by side for each value of `by`, with intervals, seeds and the paper's values.

    Args:
        table: `by`, method, value, low, high, seeds, paper (NaN where it gives none); any row may be
            missing.
        labels: what to call the values of `by`, in their order.
    """
    groups, methods = list(table[by].unique()), [name for name in COLOURS if name in set(table.method)]
    width, named = 0.8 / len(methods), set()
    for row in table.itertuples():
        place = groups.index(getattr(row, by)) + (methods.index(row.method) - (len(methods) - 1) / 2) * width
        _bar(place, row, 0.9 * width, ax, label=None if row.method in named else NAMES[row.method])
        _printed_line(place, row.paper, width, ax)
        named.add(row.method)
    ax.set_xticks(range(len(groups)), labels)
    ax.set_xlim(-0.5, len(groups) - 0.5)
    _success(ax, bars=True)


def ladder(table: pd.DataFrame, by: str, ax: Axes) -> None:
    """Success as one thing after the other moves, or alone: one bar a value of `by`, with interval and seeds.

    Args:
        table: `by`, method, value, low, high, seeds (list of single seeds' rates).
    """
    for place, row in enumerate(table.itertuples()):
        _bar(place, row, 0.66, ax, alpha=0.45 if "alone" in getattr(row, by) else 0.85)
    ax.set_xticks(range(len(table)), [name.replace(" + ", "\n+ ").replace(" alone", "\nalone") for name in table[by]])
    ax.set_xlim(-0.6, len(table) - 0.4)
    _success(ax, bars=True)


def _bar(place: float, row, width: float, ax: Axes, label: str | None = None, alpha: float = 0.85) -> None:
    """One method's rate as a bar with its interval and a white dot a seed, or the word "missing"."""
    if np.isnan(row.value):
        ax.annotate("missing", (place, 0.02), ha="center", va="bottom", rotation=90, color=GREY, fontsize=LEAST_POINTS)
        return
    ax.bar(place, row.value, width=width, color=COLOURS[row.method], alpha=alpha, label=label)
    ax.errorbar(place, row.value, _errors(row), color="black", capsize=2, lw=0.9)
    spread = 0.3 * width + 0.06 * width * np.arange(len(row.seeds))
    ax.scatter(place + spread - spread.mean() + 0.3 * width, row.seeds, s=8, color="white", edgecolor="black", lw=0.6,
               zorder=4, clip_on=False)


def _errors(row) -> list[list[float]]:
    return [[row.value - row.low], [row.high - row.value]]


def _printed_line(place: float, value: float, width: float, ax: Axes) -> None:
    """The paper's value as a dotted line over a bar; in the legend once."""
    if not np.isnan(value):
        known = "paper" in ax.get_legend_handles_labels()[1]
        ax.plot([place - width / 2, place + width / 2], [value, value], **PRINTED, label=None if known else "paper")


def _success(ax: Axes, bars: bool = False) -> None:
    """A vertical axis of success rates, written in per cent; bars stand on its lower end."""
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    ax.yaxis.set_major_locator(MultipleLocator(0.2))
    ax.set(ylabel="success (%)", ylim=(0 if bars else -0.03, 1.05))


def _points(ax: Axes, label: str) -> None:
    """A horizontal axis of differences of rates, written in points, with 0 marked."""
    ax.axvline(0, color="black", lw=0.8)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:+.0f}".replace("-", "\N{MINUS SIGN}")
                                               if round(100 * value) else "0"))
    ax.set_xlabel(label)


def gaps(table: pd.DataFrame, by: str, labels: list[str], ax: Axes, means: pd.DataFrame | None = None) -> None:
    """Differences MOVE minus another method with intervals, 0 marked; a column `paper` as diamonds.

    Args:
        table: as `move.report.differences.gap_table` gives it.
        labels: what to call the values of `by`, in their order.
        means: as `move.report.differences.gap_means` gives them: drawn below the last item, under a line.
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
        ax.errorbar(rows.gap, places, xerr=[rows.gap - rows.low, rows.high - rows.gap], fmt=marker, ms=3.5, lw=1,
                    capsize=1.5, color=colour, label=f"MOVE \N{MINUS SIGN} {NAMES[other]}")
        if "paper" in rows:
            ax.plot(rows.paper, places, "D", ms=3.5, mew=0.9, color=colour, mfc="white", zorder=4, clip_on=False,
                    label=f"MOVE \N{MINUS SIGN} {NAMES[other]}, paper")
    ax.set_yticks(range(len(values)), labels)
    ax.set_ylim(max(len(values), 1) - 0.5, -0.5)
    _points(ax, "difference of success (points)")


def curve(table: pd.DataFrame, x: str, label: str, ax: Axes, log: bool = False) -> None:
    """Success rate against column `x`, one line a method, bars for the 95 % interval, "?" where a rate is missing.

    Args:
        table: method, `x` (numbers), value (NaN where it is missing), low, high.
        label: of the horizontal axis.
    """
    ticks = sorted(table[x].unique())
    apart = 0.025 * (np.log(ticks[-1] / ticks[0]) if log else ticks[-1] - ticks[0])
    methods = [name for name in COLOURS if name in set(table.method)]
    for method, shift in zip(methods, apart * np.linspace(-1, 1, len(methods)) * (len(methods) > 1), strict=True):
        rows = table[table.method == method].sort_values(x)
        rows = rows.assign(place=rows[x] * np.exp(shift) if log else rows[x] + shift)
        there, missing = rows[rows.value.notna()], rows[rows.value.isna()]
        ax.errorbar(there.place, there.value, [there.value - there.low, there.high - there.value], fmt="o-", ms=3,
                    lw=1.1, capsize=1.5, color=COLOURS[method], label=NAMES[method])
        height = 0.03 + 0.09 * methods.index(method)
        ax.plot(missing[x], np.full(len(missing), height), ls="none", marker="$?$", ms=5, mew=0.3,
                color=COLOURS[method], label="_missing")
    if log:
        log_ticks(ticks, ax)
    else:
        ax.set_xticks(ticks, [short(tick) for tick in ticks])
    ax.set_xlabel(label)
    _success(ax)


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
    return f"{number / 1000:g}k" if number >= 1000 else f"{number:.2g}"


def printed_points(points: pd.DataFrame, ax: Axes) -> None:
    """The paper's success at its own budgets, a hollow diamond in each method's colour, a little to the right.

    Args:
        points: method, timesteps, value.
    """
    for row in points.itertuples():
        ax.plot(1.15 * row.timesteps, row.value, "D", ms=3.5, mew=1.0, color=COLOURS[row.method], mfc="white", zorder=4,
                clip_on=False)


def entries(methods: Sequence[str], paper: str = "", missing: bool = False) -> list[Line2D]:
    """What a legend shows of curves and points: a line a method, and in grey what diamonds and question marks are."""
    handles = [Line2D([], [], color=COLOURS[name], marker="o", ms=3, lw=1.1, label=NAMES[name])
               for name in COLOURS if name in methods]
    handles += [Line2D([], [], ls="none", marker="D", ms=3.5, color="#444444", mfc="white", label=paper)] * bool(paper)
    handles += [Line2D([], [], ls="none", marker="$?$", ms=5, mew=0.3, color="#444444", label="missing")] * missing
    return handles


def efficiencies(table: pd.DataFrame, ax: Axes) -> None:
    """How many times MOVE's timesteps static needs, one line a task; an arrow where static does not reach MOVE.

    Args:
        table: as `move.report.efficiency.efficiency_table` gives it; a ratio of NaN is missing.
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


def coverages(table: pd.DataFrame, ax: Axes) -> None:
    """How often intervals hold the truth: one group a deviation of trainings, one mark a number of seeds.

    Args:
        table: as `move.study.statistics.simulation.coverage` gives it.
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
    _success(ax)
    ax.set(xlabel="trainings differ by (points, standard deviation)", ylabel="intervals that hold the truth (%)")


def half_widths(table: pd.DataFrame, ax: Axes) -> None:
    """How wide the intervals are against the number of seeds: one line a deviation of trainings.

    Args:
        table: seeds, deviation, half_width, of one kind of interval.
    """
    most = table.deviation.max()
    for deviation, rows in table.groupby("deviation"):
        ax.plot(rows.seeds, rows.half_width, "o-", color="black", alpha=0.35 + 0.65 * deviation / most, ms=3.5)
        ax.annotate(f"{100 * deviation:.0f} points", (rows.seeds.iloc[-1], rows.half_width.iloc[-1]), xytext=(4, -2),
                    textcoords="offset points", fontsize=LEAST_POINTS)
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    ax.set(xlabel="seeds", ylabel="half width of the interval (points)", xticks=sorted(table.seeds.unique()),
           xlim=(None, table.seeds.max() + 1), ylim=(0, None))


def level(value: float, label: str, ax: Axes, style: str = "--") -> None:
    """A labelled horizontal line: a floor, a ceiling or a value of the paper."""
    ax.axhline(value, color="#666666", lw=0.9, ls=style)
    ax.annotate(label, (1, value), xycoords=("axes fraction", "data"), xytext=(-2, 2), textcoords="offset points",
                ha="right", fontsize=LEAST_POINTS, color="#444444")


def task_rates(table: pd.DataFrame, controls: pd.DataFrame, ax: Axes) -> None:
    """One group for each of the paper's tasks: the methods' rates with intervals, between its floor and its ceiling.

    A task that the table does not hold is marked as missing.

    Args:
        table: task, method, value, low, high; and, where the paper gives any, paper: hollow diamonds in the method's
            colour beside its point.
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
    _task_axis(tasks, ax)


def readings(table: pd.DataFrame, column: str, ax: Axes) -> None:
    """One group for each task: the rates of the variants of one method, named in `column`, with intervals.

    Args:
        table: task, the column, value, low, high.
    """
    tasks = [task for task in TASKS if task in set(table.task)]
    for (name, colour), shift in zip(READINGS.items(), (-0.2, 0.0, 0.2), strict=True):
        rows = table[table[column] == name].set_index("task").reindex(tasks)
        _rates_at(np.arange(len(tasks)) + shift, rows, colour, name, ax)
    _task_axis(tasks, ax)


def _rates_at(places: np.ndarray, rows: pd.DataFrame, colour: str, label: str, ax: Axes) -> None:
    ax.errorbar(places, rows.value, [rows.value - rows.low, rows.high - rows.value], fmt="o", ms=3.2, lw=0.9,
                capsize=1.5, color=colour, label=label)


def _task_axis(tasks: Sequence[str], ax: Axes) -> None:
    """A horizontal axis of tasks by their titles, broken at hyphens where many stand side by side."""
    names = [TASKS[task].title for task in tasks]
    ax.set_xticks(range(len(tasks)), [name.replace("-", "-\n") for name in names] if len(tasks) > 4 else names)
    ax.set_xlim(-0.6, len(tasks) - 0.4)
    _success(ax)


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
            ax.errorbar(place + aside[row.group], row.value, _errors(row), fmt="^" if row.group == "moving" else "o",
                        ms=3.5, lw=0.8, capsize=1.5, color=COLOURS[method],
                        mfc="white" if row.group == "grasp" else COLOURS[method])
    _task_axis(tasks, ax)


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
        table: as `move.report.tables.recipe_table` gives it.
    """
    _change_lines(table, table.value, table.low, table.high, ax)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    ax.set(xlabel="success (%)", xlim=(0.4, 1.03))


def gains(table: pd.DataFrame, ax: Axes) -> None:
    """What one change at a time gains over the chosen recipe, one line a row with its interval and training's minutes.

    Args:
        table: as `move.report.tables.recipe_table` gives it; a gain of NaN is left out.
    """
    _change_lines(table, table.gain, table.gain_low, table.gain_high, ax)
    for place, minutes in enumerate(table.train_minutes):
        ax.annotate(f"{minutes:.1f} min", (1, place), xycoords=("axes fraction", "data"), xytext=(3, 0), va="center",
                    textcoords="offset points", fontsize=LEAST_POINTS, color="#444444")
    _points(ax, "gain (points)")


def _change_lines(table: pd.DataFrame, values: pd.Series, lows: pd.Series, highs: pd.Series, ax: Axes) -> None:
    for place, (change, value, low, high) in enumerate(zip(table.change, values, lows, highs, strict=True)):
        ax.errorbar(value, place, xerr=[[value - low], [high - value]], fmt="o", ms=3.5, lw=1, capsize=1.5,
                    color="black" if change == "chosen" else GREY, clip_on=False)
    ax.set_yticks(range(len(table)), table.change)
    ax.set_ylim(len(table) - 0.5, -0.5)


def costs(table: pd.DataFrame, value: str, paper: dict[str, float], ax: Axes, share: bool = False) -> None:
    """Mean over the tasks of `value` for each method, one bar an expert, single tasks as dots, the paper dotted.

    The error bar is a 95 % interval of the mean from the spread of the tasks: Student's, or for a share Wilson's with
    as many trials as this spread is worth, which stays within 0 and 1.

    Args:
        table: task, method, expert and the column `value`.
        paper: the paper's value for each method that it has.
        share: whether the values are shares of 1, written in per cent.
    """
    methods, experts = list(table.method.unique()), list(table.expert.unique())
    for place, method in enumerate(methods):
        for expert, shift in zip(experts, (-0.2, 0.2), strict=False):
            values = table[(table.method == method) & (table.expert == expert)][value]
            ax.bar(place + shift, values.mean(), width=0.36, color=COLOURS[method], alpha=0.85 if shift < 0 else 0.45)
            low, high = share_interval(values) if share else _mean_interval(values)
            ax.errorbar(place + shift, values.mean(), [[values.mean() - low], [high - values.mean()]], color="black",
                        capsize=2, lw=0.9)
            ax.plot(np.full(len(values), place + shift + 0.1), values, ".", color="#444444", ms=3, clip_on=False)
        if method in paper:
            ax.plot([place - 0.42, place + 0.42], [paper[method]] * 2, **PRINTED)
    ax.set_xticks(range(len(methods)), [NAMES[method] for method in methods])
    if share:
        _success(ax, bars=True)


def cost_entries(experts: Sequence[str]) -> list[Patch | Line2D]:
    """What a legend of `costs` shows: which bars are whose, and the paper's line."""
    names = {"phase": "phase expert (ours)", "metaworld": "Meta-World's expert"}
    bars = [Patch(color="#444444", alpha=alpha, label=names.get(expert, expert))
            for expert, alpha in zip(experts, (0.85, 0.45), strict=False)]
    dot = Line2D([], [], ls="none", marker=".", ms=4, color="#444444", label="a task")
    return [*bars, dot, Line2D([], [], **PRINTED, label="paper")]


def _mean_interval(values: pd.Series) -> tuple[float, float]:
    half = student_half_width(values.std(), len(values))
    return values.mean() - half, values.mean() + half


def share_interval(shares: pd.Series) -> tuple[float, float]:
    """Wilson's 95 % interval of a mean share, with as many trials as the spread of the shares is worth.

    >>> low, high = share_interval(pd.Series([1.0, 1.0, 0.9]))
    >>> low < 0.9 < high <= 1
    True
    """
    mean, deviation = shares.mean(), student_half_width(shares.std(), len(shares)) / NORMAL
    trials = mean * (1 - mean) / deviation**2 if deviation > 0 else float(len(shares))
    return wilson_interval(mean, trials)


def verdicts(table: pd.DataFrame, order: Sequence[str], ax: Axes) -> None:
    """How many claims have which verdict, one bar a verdict.

    Args:
        table: one row a claim with its `verdict`.
        order: of the verdicts, from the top.
    """
    counts = table.verdict.value_counts().reindex(order, fill_value=0)
    ax.barh(range(len(order)), counts, color=GREY, height=0.66)
    for place, count in enumerate(counts):
        ax.annotate(str(count), (count, place), xytext=(3, 0), textcoords="offset points", va="center",
                    fontsize=LEAST_POINTS)
    ax.set_yticks(range(len(order)), order)
    ax.invert_yaxis()
    ax.set_xlabel("claims of the paper")


def covered(table: pd.DataFrame, column: str, ax: Axes) -> None:
    """Success against the share of cells in `column`, one mark a task and what moves; a line joins those of a task.

    Args:
        table: as `move.report.covered.coverage_table` gives it.
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
    _success(ax)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    ax.set(xlabel="cells that the data visit (%)", xlim=(-0.02, 1.04))

"""Plot functions: a tidy DataFrame and an Axes in, marks on the Axes out; nothing is read from disk."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.patches import Circle, Rectangle

from move.intervals import student_half_width
from move.paper import PAPER_TASKS
from move.report.style import COLOURS, NAMES
from move.sim.configuration import Disc
from move.sim.tasks import TASKS


def heatmap(episodes: pd.DataFrame, ax: Axes) -> QuadMesh:
    """Success rate over the object's place: one cell a grid configuration, the mean of all seeds.

    Args:
        episodes: rows with object_x, object_y (metres), success and group; group "point" marks grasp points.
    """
    cells = episodes[episodes.group == "grid"].pivot_table("success", "object_y", "object_x", aggfunc="mean")
    edges = [_edges(axis.to_numpy() * 100) for axis in (cells.columns, cells.index)]
    mesh = ax.pcolormesh(*edges, cells.to_numpy(dtype=float), cmap="cividis", vmin=0, vmax=1, edgecolor="white",
                         linewidth=0.2)
    points = episodes[episodes.group == "point"].groupby(["object_x", "object_y"], as_index=False).success.mean()
    ax.scatter(points.object_x * 100, points.object_y * 100, c=points.success, cmap="cividis", vmin=0, vmax=1, s=22,
               edgecolor="white", linewidth=1.0, zorder=3)
    ax.set(xlabel="object x (cm)", ylabel="object y (cm)", aspect="equal")
    return mesh


def grasps(points: pd.DataFrame, ax: Axes) -> None:
    """Where the demonstrations grasped, as small dots.

    Args:
        points: object_x, object_y (metres).
    """
    ax.scatter(points.object_x * 100, points.object_y * 100, s=2.5, color="white", edgecolor="black", lw=0.3, zorder=3)


def circle(disc: Disc, ax: Axes) -> None:
    """The outline of a disc given in metres, on axes in centimetres."""
    ax.add_patch(Circle((disc.centre[0] * 100, disc.centre[1] * 100), disc.radius * 100, fill=False, color="white",
                        ls="--", lw=1.0))


def _edges(centres: np.ndarray) -> np.ndarray:
    half = (centres[1] - centres[0]) / 2 if len(centres) > 1 else 1.0
    return np.append(centres - half, centres[-1] + half)


def rates(table: pd.DataFrame, ax: Axes) -> None:
    """Success rates side by side, one a row of `table`, with intervals, single seeds and the paper's value.

    Args:
        table: method, value, low, high, seeds (list of single seeds' rates), paper (NaN where it gives none).
    """
    for place, row in enumerate(table.itertuples()):
        colour = COLOURS[row.method]
        ax.bar(place, row.value, width=0.62, color=colour, alpha=0.85)
        ax.errorbar(place, row.value, [[row.value - row.low], [row.high - row.value]], color="black", capsize=3, lw=1)
        ax.scatter(np.full(len(row.seeds), place) + 0.2, row.seeds, s=9, color="white", edgecolor="black", lw=0.6,
                   zorder=4)
        ax.plot([place - 0.4, place + 0.4], [row.paper, row.paper], color="black", ls=":", lw=1.4)
    ax.set_xticks(range(len(table)), [NAMES[name] for name in table.method])
    ax.set(ylabel="success rate", ylim=(0, 1.03), xlim=(-0.6, len(table) - 0.4))


def grouped_rates(table: pd.DataFrame, by: str, labels: list[str], ax: Axes) -> None:
    """Success rates of the methods side by side for each value of `by`, with intervals and the paper's values.

    Args:
        table: `by`, method, value, low, high, paper (NaN where it gives none); a method may be missing somewhere.
        labels: what to call the values of `by`, in their order.
    """
    groups, methods = list(table[by].unique()), [name for name in COLOURS if name in set(table.method)]
    width = 0.8 / len(methods)
    for row in table.itertuples():
        place = groups.index(getattr(row, by)) + (methods.index(row.method) - (len(methods) - 1) / 2) * width
        first = getattr(row, by) == groups[0]
        ax.bar(place, row.value, width=0.9 * width, color=COLOURS[row.method], alpha=0.85,
               label=NAMES[row.method] if first else None)
        ax.errorbar(place, row.value, [[row.value - row.low], [row.high - row.value]], color="black", capsize=1.5,
                    lw=0.8)
        ax.plot([place - width / 2, place + width / 2], [row.paper, row.paper], color="black", ls=":", lw=1.3)
    ax.set_xticks(range(len(groups)), labels)
    ax.set(ylabel="success rate", ylim=(0, 1.02))


def gaps(table: pd.DataFrame, by: str, labels: list[str], ax: Axes, means: pd.DataFrame | None = None) -> None:
    """Differences MOVE minus another method with intervals, 0 marked; a column `paper` as crosses.

    Args:
        table: as `move.report.differences.gap_table` gives it.
        labels: what to call the values of `by`, in their order.
        means: as `move.report.differences.gap_means` gives them: drawn below the last item.
    """
    if means is not None and len(means):
        names = [f"mean of {items}" for items in means["items"]]
        table = pd.concat([table, means.drop(columns="items").assign(**{by: names})], ignore_index=True)
        labels = [*labels, *dict.fromkeys(names)]
    values, others = list(table[by].unique()), list(table.than.unique())
    for place, other in enumerate(others):
        shift = (place - (len(others) - 1) / 2) * 0.3
        rows = table[table.than == other]
        places = np.array([values.index(value) for value in rows[by]]) + shift
        ax.errorbar(rows.gap, places, xerr=[rows.gap - rows.low, rows.high - rows.gap], fmt="o", ms=3.5, lw=1,
                    capsize=1.5, color=COLOURS[other], label=f"MOVE - {NAMES[other]}")
        if "paper" in rows:
            ax.plot(rows.paper, places, "x", ms=4, mew=1, color="black")
    ax.axvline(0, color="black", lw=0.8)
    ax.set_yticks(range(len(values)), labels)
    ax.set_ylim(max(len(values), 1) - 0.5, -0.5)
    ax.set_xlabel("difference of success rates")


def scaling(table: pd.DataFrame, ax: Axes) -> None:
    """Success rate against timesteps, one line a method, with a band for the 95 % interval.

    Args:
        table: method, timesteps, value, low, high.
    """
    for method, rows in table.groupby("method", sort=False):
        rows = rows.sort_values("timesteps")
        ax.plot(rows.timesteps, rows.value, "o-", color=COLOURS[method], label=NAMES[method], ms=3.5, lw=1.4)
        ax.fill_between(rows.timesteps, rows.low, rows.high, color=COLOURS[method], alpha=0.18, lw=0)
    ticks = sorted(table.timesteps.unique())
    ax.set_xscale("log")
    ax.set_xticks(ticks, [f"{tick:,}" for tick in ticks])
    ax.minorticks_off()
    ax.set(xlabel="timesteps of demonstrations", ylabel="success rate", ylim=(0, 1.02))


def curve(table: pd.DataFrame, x: str, label: str, ax: Axes, log: bool = False) -> None:
    """Success rate against column `x`, one line a method, bars for the 95 % interval.

    Args:
        table: method, `x` (numbers), value, low, high.
        label: of the horizontal axis.
    """
    ticks = sorted(table[x].unique())
    apart = 0.02 * (np.log(ticks[-1] / ticks[0]) if log else ticks[-1] - ticks[0])
    methods = [name for name in COLOURS if name in set(table.method)]
    for method, shift in zip(methods, apart * np.linspace(-0.5, 0.5, len(methods)), strict=True):
        rows = table[table.method == method].sort_values(x)
        places = rows[x] * np.exp(shift) if log else rows[x] + shift
        ax.errorbar(places, rows.value, [rows.value - rows.low, rows.high - rows.value], fmt="o-", ms=3.5, lw=1.2,
                    capsize=1.5, color=COLOURS[method], label=NAMES[method])
    if log:
        ax.set_xscale("log")
    ax.set_xticks(ticks, [_short(tick) for tick in ticks])
    ax.minorticks_off()
    ax.set(xlabel=label, ylabel="success rate", ylim=(-0.03, 1.03))


def _short(number: float) -> str:
    return f"{number / 1000:g}k" if number >= 1000 else f"{number:.2g}"


def printed_points(points: pd.DataFrame, ax: Axes) -> None:
    """The paper's success at its own budgets, a cross in each method's colour.

    Args:
        points: method, timesteps, value.
    """
    for row in points.itertuples():
        ax.plot(row.timesteps, row.value, "x", ms=4.5, mew=1.2, color=COLOURS[row.method],
                label=f"{NAMES[row.method]}, paper")


def efficiencies(table: pd.DataFrame, ax: Axes) -> None:
    """How many times MOVE's timesteps static needs, one line a task; an arrow where static does not reach MOVE.

    Args:
        table: as `move.report.efficiency.efficiency_table` gives it.
    """
    for place, row in enumerate(table.itertuples()):
        value, low, high = (min(number, row.most) for number in (row.ratio, row.low, row.high))
        ax.errorbar(value, place, xerr=[[value - low], [high - value]], fmt="o", ms=3.5, lw=1, capsize=1.5,
                    color="black", mfc="white" if row.ratio > row.most else "black")
        if row.high > row.most:
            ax.plot(row.most, place, ">", ms=4, color="black")
    ax.axvline(1, color="black", lw=0.8)
    ax.set_xscale("log", base=2)
    ax.set_xticks([0.25, 0.5, 1, 2, 4], ["1/4", "1/2", "1", "2", "4"])
    ax.set_yticks(range(len(table)), [TASKS[task].title for task in table.task])
    ax.set_ylim(max(len(table), 1) - 0.5, -0.5)
    ax.set_xlabel("static's timesteps / MOVE's, same success")


def ladder(table: pd.DataFrame, by: str, ax: Axes) -> None:
    """Success as one thing after the other moves, or alone: one bar a value of `by`, with interval and seeds.

    Args:
        table: `by`, method, value, low, high, seeds (list of single seeds' rates).
    """
    for place, row in enumerate(table.itertuples()):
        alone = "alone" in getattr(row, by)
        ax.bar(place, row.value, width=0.66, color=COLOURS[row.method], alpha=0.45 if alone else 0.85)
        ax.errorbar(place, row.value, [[row.value - row.low], [row.high - row.value]], color="black", capsize=2, lw=0.9)
        ax.scatter(np.full(len(row.seeds), place) + 0.2, row.seeds, s=8, color="white", edgecolor="black", lw=0.6,
                   zorder=4)
    ax.set_xticks(range(len(table)), [name.replace(" + ", "\n+ ") for name in table[by]], fontsize=7)
    ax.set(ylabel="success rate", ylim=(0, 1.03))


def coverages(table: pd.DataFrame, ax: Axes) -> None:
    """How often intervals hold the truth: one group a deviation of trainings, one mark a number of seeds.

    Args:
        table: as `move.study.simulation.coverage` gives it.
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
    ax.set(xlabel="trainings differ by (points, standard deviation)", ylabel="intervals that hold the truth",
           ylim=(0, 1.03))


def level(value: float, label: str, ax: Axes, style: str = "--") -> None:
    """A labelled horizontal line: a floor, a ceiling or a value of the paper."""
    ax.axhline(value, color="#666666", lw=0.9, ls=style)
    ax.annotate(label, (1, value), xycoords=("axes fraction", "data"), xytext=(-2, 2), textcoords="offset points",
                ha="right", fontsize=6, color="#444444")


def task_rates(table: pd.DataFrame, controls: pd.DataFrame, ax: Axes) -> None:
    """One group for each of the paper's tasks: the methods' rates with intervals, between its floor and its ceiling.

    A task that the table does not hold is marked as missing.

    Args:
        table: task, method, value, low, high; and, where the paper gives any, paper: drawn as crosses.
        controls: one row a task; columns "expert" (ceiling) and, where it exists, "goal-blind" (floor).
    """
    tasks, methods = list(PAPER_TASKS), list(table.method.unique())
    for place, task in enumerate(tasks):
        if task not in set(table.task):
            ax.annotate("missing", (place, 0.5), ha="center", va="center", rotation=90, fontsize=6, color="#777777")
    for method, shift in zip(methods, np.linspace(-0.24, 0.24, len(methods)), strict=True):
        rows = table[table.method == method].set_index("task").reindex(tasks)
        errors = [rows.value - rows.low, rows.high - rows.value]
        ax.errorbar(np.arange(len(tasks)) + shift, rows.value, errors, fmt="o", ms=3.5, lw=1, capsize=1.5,
                    color=COLOURS[method], label=NAMES[method])
        if "paper" in table:
            ax.plot(np.arange(len(tasks)) + shift, rows.paper, "x", color="black", ms=3.5, mew=0.8, zorder=4)
    for name, style in (("expert", "-"), ("goal-blind", "--")):
        if name in controls:
            ax.hlines(controls[name].reindex(tasks), np.arange(len(tasks)) - 0.4, np.arange(len(tasks)) + 0.4,
                      color="#444444", ls=style, lw=0.9, label=NAMES[name])
    ax.set_xticks(range(len(tasks)), [TASKS[task].title for task in tasks], rotation=25, ha="right")
    ax.set(ylabel="success rate", ylim=(-0.03, 1.05))


READINGS = {"as printed": "#999999", "mended": "#56B4E9", "periodic": "#CC79A7"}


def readings(table: pd.DataFrame, column: str, ax: Axes) -> None:
    """One group for each task: the rates of the variants of one method, named in `column`, with intervals.

    Args:
        table: task, the column, value, low, high.
    """
    tasks = [task for task in TASKS if task in set(table.task)]
    for (name, colour), shift in zip(READINGS.items(), (-0.2, 0.0, 0.2), strict=True):
        rows = table[table[column] == name].set_index("task").reindex(tasks)
        ax.errorbar(np.arange(len(tasks)) + shift, rows.value, [rows.value - rows.low, rows.high - rows.value], fmt="o",
                    ms=3.5, lw=1, capsize=1.5, color=colour, label=name)
    ax.set_xticks(range(len(tasks)), [TASKS[task].title for task in tasks], rotation=25, ha="right")
    ax.set(ylabel="success rate", ylim=(-0.03, 1.05))


def own_and_elsewhere(table: pd.DataFrame, ax: Axes) -> None:
    """One group for each task: a policy's rate at its own grasps (hollow), elsewhere (filled), in motion (triangle).

    Args:
        table: task, method, group ("grasp", "random" or "moving"), value, low, high; any group may be missing.
    """
    tasks, methods = list(table.task.unique()), [name for name in COLOURS if name in set(table.method)]
    shifts = dict(zip(methods, np.linspace(-0.26, 0.26, len(methods)) * (len(methods) > 1), strict=True))
    aside = {"grasp": -0.08, "random": 0.0, "moving": 0.08}
    names = {"grasp": "at its own grasps", "random": "elsewhere", "moving": "elsewhere, in motion"}
    for (task, method), rows in table.groupby(["task", "method"], sort=False):
        place = tasks.index(task) + shifts[method]
        rows = rows.set_index("group").reindex([group for group in aside if group in set(rows.group)]).reset_index()
        ax.plot([place + aside[group] for group in rows.group], rows.value, color=COLOURS[method], lw=2, alpha=0.35)
        for row in rows.itertuples():
            ax.errorbar(place + aside[row.group], row.value, [[row.value - row.low], [row.high - row.value]],
                        fmt="^" if row.group == "moving" else "o", ms=3.5, lw=0.8, capsize=1.5, color=COLOURS[method],
                        mfc="white" if row.group == "grasp" else COLOURS[method],
                        label=f"{NAMES[method]}, {names[row.group]}" if task == tasks[0] else None)
    ax.set_xticks(range(len(tasks)), [TASKS[task].title for task in tasks], rotation=25, ha="right")
    ax.set(ylabel="success rate", ylim=(-0.03, 1.05))


def changes(table: pd.DataFrame, ax: Axes) -> None:
    """Success of the recipe with one change at a time, one line a row with its interval and minutes of training.

    Args:
        table: as `move.report.tables.recipe_table` gives it.
    """
    for place, row in enumerate(table.itertuples()):
        colour = "black" if row.change == "chosen" else "#777777"
        ax.errorbar(row.value, place, xerr=[[row.value - row.low], [row.high - row.value]], fmt="o", ms=4, lw=1,
                    capsize=1.5, color=colour)
    ax.set_yticks(range(len(table)), [f"{row.change}, {row.train_minutes:.1f} min" for row in table.itertuples()])
    ax.invert_yaxis()
    ax.set(xlabel="success where it learnt", xlim=(-0.02, 1.02))


def costs(table: pd.DataFrame, value: str, paper: dict[str, float], ax: Axes) -> None:
    """Mean over the tasks of `value` for each method, one bar an expert, single tasks as dots, the paper dotted.

    The error bar is Student's 95 % interval of the mean, from the spread of the tasks.

    Args:
        table: task, method, expert and the column `value`.
        paper: the paper's value for each method that it has.
    """
    methods, experts = list(table.method.unique()), list(table.expert.unique())
    for place, method in enumerate(methods):
        for expert, shift in zip(experts, (-0.2, 0.2), strict=True):
            values = table[(table.method == method) & (table.expert == expert)][value]
            ax.bar(place + shift, values.mean(), width=0.36, color=COLOURS[method], alpha=0.9 if shift < 0 else 0.45)
            half = student_half_width(values.std(), len(values))
            ax.errorbar(place + shift, values.mean(), half, color="black", capsize=3, lw=1)
            ax.plot(np.full(len(values), place + shift + 0.1), values, ".", color="#444444", ms=2.5)
        if method in paper:
            ax.plot([place - 0.42, place + 0.42], [paper[method]] * 2, color="black", ls=":", lw=1.4)
    ax.set_xticks(range(len(methods)), [NAMES[method] for method in methods])


def coverage(seen: pd.DataFrame, part: str, low: tuple, high: tuple, ax: Axes) -> None:
    """Every place in the plane that `part` ("object" or "target") had at some timestep, inside its range (metres)."""
    method = seen.method.iloc[0]
    ax.plot(seen[f"{part}_x"] * 100, seen[f"{part}_y"] * 100, ".", color=COLOURS[method], ms=1.2, alpha=0.5)
    ax.add_patch(Rectangle((low[0] * 100, low[1] * 100), (high[0] - low[0]) * 100, (high[1] - low[1]) * 100,
                           fill=False, color="#888888", lw=0.8))
    ax.set(aspect="equal", xlabel=f"{part} x (cm)")


def picture(frame: np.ndarray, title: str, ax: Axes) -> None:
    """A frame, or frames side by side, without axes."""
    ax.imshow(frame)
    ax.set_title(title, loc="left")
    ax.axis("off")


def verdicts(table: pd.DataFrame, order: Sequence[str], ax: Axes) -> None:
    """How many claims have which verdict, one bar a verdict.

    Args:
        table: one row a claim with its `verdict`.
        order: of the verdicts, from the top.
    """
    counts = table.verdict.value_counts().reindex(order, fill_value=0)
    ax.barh(range(len(order)), counts, color="#777777", height=0.66)
    for place, count in enumerate(counts):
        ax.annotate(str(count), (count, place), xytext=(3, 0), textcoords="offset points", va="center", fontsize=7)
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
    ax.set(xlabel=f"share of {column} cells visited", xlim=(-0.02, 1.02), ylim=(-0.03, 1.03))

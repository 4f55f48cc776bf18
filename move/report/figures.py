"""Whole figures, laid out from the pieces of `plots` and `maps`: tables in, a Figure out; nothing is read from disk.

One function a figure, named as its notebook. Every figure is one or two columns wide, its panels have letters, and what
a row says is missing is drawn as missing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from move.paper import PAPER_TASKS
from move.report import maps, plots
from move.report.style import COLOURS, COLUMN_WIDTH, NAMES, PAGE_WIDTH, remark, titles
from move.sim.configuration import Box
from move.sim.grasp_points import CIRCLE
from move.sim.tasks import TASKS
from move.study.claims.rule import VERDICTS

SEEN = {"rgb": "from pixels", "keypoints": "from keypoints: perception given"}
Strips = Mapping[str, tuple[np.ndarray, Sequence[int]]]  # title -> frames (count, size, size, 3), their timesteps


def fig1_sparse(episodes: pd.DataFrame, whole: pd.DataFrame) -> Figure:
    """Two maps and the rates over the whole space.

    Args:
        episodes: of static and MOVE, on a grid and at the grasp points.
        whole: as `plots.rates` takes it.
    """
    figure, axes = plt.subplots(1, 3, figsize=(PAGE_WIDTH, 2.3), width_ratios=[1, 1, 0.75])
    _maps(episodes, axes[:2])
    _rates_with_legend(whole, axes[2])
    titles(axes, ["static", "MOVE", "whole space"])
    return figure


def _maps(episodes: pd.DataFrame, axes: Sequence[Axes]) -> None:
    """One map a method with one colour bar; a method without episodes leaves its panel empty and says so."""
    for ax, method in zip(axes, ("static", "move"), strict=True):
        rows = episodes[episodes.method == method]
        if len(rows):
            mesh = maps.heatmap(rows, ax)
            ax.set_anchor("N")
        else:
            _say("missing", ax)
    axes[1].set_ylabel("")
    maps.seeds_bar(mesh, axes, episodes.seed.nunique())


def _rates_with_legend(whole: pd.DataFrame, ax: Axes) -> None:
    plots.rates(whole, ax)
    _legend_below(ax, [_seed_dot()])


def _seed_dot() -> Line2D:
    return Line2D([], [], ls="none", marker="o", ms=3.5, color="black", mfc="white", mew=0.6, label="a seed")


def _legend_below(ax: Axes, more: Sequence[Line2D] = (), columns: int = 2) -> None:
    """The legend of one panel under its axis, outside of the marks."""
    handles, _ = ax.get_legend_handles_labels()
    ax.legend(handles=[*handles, *more], ncol=columns, loc="upper center", bbox_to_anchor=(0.5, -0.14))


def _say(text: str, ax: Axes) -> None:
    ax.set_axis_off()
    ax.text(0.5, 0.5, text, ha="center", va="center", transform=ax.transAxes)


def fig2_overview(seen: Mapping[str, pd.DataFrame], shares: pd.DataFrame, ranges: Mapping[str, Box], strips: Strips,
                  problem: str | None = None) -> Figure:
    """For each way of collecting where object and target were, and below strips of frames.

    Args:
        seen: method -> its configurations, with object_x, object_y, target_x, target_y (metres).
        shares: method, object, target (share of cells visited).
        ranges: "object" and "target" -> the range that evaluation draws from.
        problem: why there are no strips.
    """
    methods, share = list(seen), shares.set_index("method")
    figure = plt.figure(figsize=(PAGE_WIDTH, 2.9 + 0.98 * max(len(strips), 1)))
    top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=[2.7, 0.1 + 1.05 * max(len(strips), 1)])[:, 0]
    for part in (top, bottom):
        part.set_facecolor("none")
    panels = top.subplots(len(ranges), len(methods), squeeze=False, sharex=True,
                          height_ratios=[box.high[1] - box.low[1] for box in ranges.values()])
    texts = []
    for row, (part, box) in zip(panels, ranges.items(), strict=True):
        for ax, method in zip(row, methods, strict=True):
            maps.coverage(seen[method], part, box.low, box.high, ax)
            texts.append(f"{NAMES[method]}, {part}: {100 * share.loc[method, part]:.0f} % of cells")
            ax.set_xlabel("x (cm)" if ax in panels[-1] else "")
            ax.set_ylabel(f"{part} y (cm)" if method == methods[0] else "")
    strip_axes = bottom.subplots(max(1, len(strips)), 1, squeeze=False)[:, 0]
    for ax, (frames, steps) in zip(strip_axes, strips.values(), strict=False):
        maps.strip(frames, [str(step) for step in steps], ax)
    if not strips:
        _say(problem or "no images", strip_axes[0])
    titles([*panels.flat, *strip_axes], [*texts, *(strips or [""])])
    return figure


def fig3_dense(episodes: pd.DataFrame, grasped: pd.DataFrame, whole: pd.DataFrame, by_budget: pd.DataFrame) -> Figure:
    """Two maps with the grasps over them, the rates over the whole space, and the rates at smaller budgets.

    Args:
        grasped: method, object_x, object_y of the demonstrations' grasps (metres).
        by_budget: as `plots.curve` takes it, with the column timesteps.
    """
    figure, axes = plt.subplots(1, 4, figsize=(PAGE_WIDTH, 2.1), width_ratios=[1, 1, 0.62, 0.8])
    _maps(episodes, axes[:2])
    for ax, method in zip(axes, ("static", "move"), strict=False):
        maps.grasps(grasped[grasped.method == method], ax)
    _rates_with_legend(whole, axes[2])
    plots.curve(by_budget, "timesteps", "timesteps", axes[3], log=True)
    axes[3].set_ylabel("")
    axes[3].legend(loc="lower right")
    titles(axes, ["static", "MOVE", "whole space", "by budget"])
    return figure


def fig4_scaling(rates: pd.DataFrame, printed: pd.DataFrame) -> Figure:
    """One panel a task: success against timesteps with the paper's values.

    Args:
        rates: task, and what `plots.curve` takes with the column timesteps.
        printed: task, method, timesteps, value of the paper.
    """
    figure, axes = plt.subplots(2, 5, figsize=(PAGE_WIDTH, 3.5), sharey=True)
    for ax, task in zip(axes.flat, PAPER_TASKS, strict=True):
        shown = rates[rates.task == task]
        if len(shown):
            plots.curve(shown, "timesteps", "timesteps", ax, log=True)
            theirs = printed[printed.task == task]
            plots.printed_points(theirs, ax)
            plots.log_ticks({*shown.timesteps, *theirs.timesteps}, ax)
        else:
            _say("missing", ax)
        ax.label_outer(remove_inner_ticks=False)
        ax.tick_params(labelbottom=True)
        ax.set_ylabel("success (%)" if ax in axes[:, 0] else "")
    titles(list(axes.flat), [TASKS[task].title for task in PAPER_TASKS])
    figure.legend(handles=plots.entries(list(rates.method.unique()), "paper, in the method's colour",
                                        bool(rates.value.isna().any())), ncol=5, loc="outside upper center")
    return figure


def fig4_efficiency(factors: pd.DataFrame, tasks: Sequence[str]) -> Figure:
    """Static's timesteps over MOVE's for the same success, one line for each of `tasks`."""
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.efficiencies(factors.set_index("task").reindex(list(tasks)).rename_axis("task").reset_index(), ax)
    return figure


def fig5_circle(episodes: pd.DataFrame, rates: pd.DataFrame) -> Figure:
    """Two maps with the circle over them, and the rates inside and outside of it.

    Args:
        rates: as `plots.grouped_rates` takes it, with the column where.
    """
    figure, axes = plt.subplots(1, 3, figsize=(PAGE_WIDTH, 2.3), width_ratios=[1, 1, 0.95])
    _maps(episodes, axes[:2])
    for ax in axes[:2]:
        maps.circle(CIRCLE, ax)
    plots.grouped_rates(rates, "where", list(rates["where"].unique()), axes[2])
    _legend_below(axes[2], [_seed_dot()], 2)
    titles(axes, ["static", "MOVE", "in and out of the circle"])
    return figure


def fig6_dimensions(rates: pd.DataFrame) -> Figure:
    """One ladder a task.

    Args:
        rates: task, and what `plots.ladder` takes with the column moves.
    """
    tasks = list(rates.task.unique())
    bars = [int((rates.task == task).sum()) for task in tasks]
    figure, axes = plt.subplots(1, len(tasks), figsize=(PAGE_WIDTH, 2.5), squeeze=False, sharey=True, width_ratios=bars)
    for ax, task in zip(axes.flat, tasks, strict=True):
        plots.ladder(rates[rates.task == task], "moves", ax)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
        ax.set_xlabel("what moves in the demonstrations")
    titles(list(axes.flat), [TASKS[task].title for task in tasks])
    _methods_and_seeds(figure, rates)
    return figure


def _methods_and_seeds(figure: Figure, rates: pd.DataFrame) -> None:
    """A legend over the figure: the methods' colours and what a white dot is."""
    bars = [Patch(color=COLOURS[name], alpha=0.85, label=NAMES[name]) for name in COLOURS if name in set(rates.method)]
    figure.legend(handles=[*bars, _seed_dot()], ncol=4, loc="outside upper center")


def fig7_speed(rates: pd.DataFrame) -> Figure:
    """One row a task, one column a part whose speed is varied; static as a level.

    Args:
        rates: task, part ("nothing": static), speed, and what `plots.curve` takes.
    """
    units = {"object": "object's speed (m per step)", "target": "target's speed (m per step)",
             "camera": "camera's speed (degrees per step)"}
    tasks, parts = list(rates.task.unique()), [part for part in units if part in set(rates.part)]
    figure, axes = plt.subplots(len(tasks), max(len(parts), 1), figsize=(PAGE_WIDTH, 1.75 * len(tasks) + 0.4),
                                squeeze=False, sharey=True)
    for row, task in zip(axes, tasks, strict=True):
        here = rates[rates.task == task]
        for ax, part in zip(row, parts, strict=False):
            if len(moved := here[here.part == part]):
                plots.curve(moved, "speed", units[part], ax)
                for still in here[(here.part == "nothing") & here.value.notna()].itertuples():
                    plots.level(still.value, "static", ax)
            else:
                _say("not part of this study", ax)
            ax.set_ylabel("success (%)" if ax is row[0] else "")
    titles(list(axes.flat), [f"{TASKS[task].title}, {part}" for task in tasks for part in parts or ["nothing"]])
    figure.legend(handles=plots.entries(["move"], missing=bool(rates.value.isna().any())), ncol=2,
                  loc="outside upper center")
    return figure


def fig_mixture(rates: pd.DataFrame, task: str) -> Figure:
    """One bar a share of MOVE in the data.

    Args:
        rates: share, and what `plots.ladder` takes.
    """
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.ladder(rates.assign(percent=[f"{100 * share:.0f}" for share in rates.share]), "percent", ax)
    ax.set_xlabel("timesteps by MOVE (%), the rest static")
    titles([ax], [TASKS[task].title])
    _methods_and_seeds(figure, rates)
    return figure


def fig_training_length(rates: pd.DataFrame) -> Figure:
    """One panel a task: success against the length of training.

    Args:
        rates: task, and what `plots.curve` takes with the column length.
    """
    tasks = list(rates.task.unique())
    figure, axes = plt.subplots(1, len(tasks), figsize=(PAGE_WIDTH, 2.3), squeeze=False, sharey=True)
    for ax, task in zip(axes.flat, tasks, strict=True):
        plots.curve(rates[rates.task == task], "length", "gradient steps / the recipe's", ax, log=True)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
    titles(list(axes.flat), [TASKS[task].title for task in tasks])
    figure.legend(handles=plots.entries(list(rates.method.unique()), missing=bool(rates.value.isna().any())), ncol=4,
                  loc="outside upper center")
    return figure


def equal_demonstrations(rates: pd.DataFrame, task: str) -> Figure:
    """Static and MOVE with as many timesteps, and with as many demonstrations.

    Args:
        rates: equal, and what `plots.grouped_rates` takes.
    """
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.grouped_rates(rates.assign(paper=np.nan), "equal", [f"equal {name}" for name in rates.equal.unique()], ax)
    titles([ax], [TASKS[task].title])
    _methods_and_seeds(figure, rates)
    return figure


def fig_coverage(cells: pd.DataFrame) -> Figure:
    """Success against what the data cover: of the object, of the camera, of both together.

    Args:
        cells: as `move.report.covered.coverage_table` gives it.
    """
    figure, axes = plt.subplots(1, 3, figsize=(PAGE_WIDTH, 2.6), sharey=True)
    for ax, column in zip(axes, ("object", "camera", "joint"), strict=True):
        plots.covered(cells, column, ax)
        ax.set_ylabel("success (%)" if ax is axes[0] else "")
    titles(list(axes), ["object", "camera", "both together"])
    figure.legend(*axes[0].get_legend_handles_labels(), ncol=4, loc="outside upper center")
    return figure


def fig_perception(rates: pd.DataFrame) -> Figure:
    """Static beside MOVE in several experiments, from pixels and from keypoints.

    Args:
        rates: observation, experiment, and what `plots.grouped_rates` takes.
    """
    kinds = list(rates.observation.unique())
    figure, axes = plt.subplots(1, len(kinds), figsize=(PAGE_WIDTH, 2.6), sharey=True, squeeze=False)
    for ax, kind in zip(axes.flat, kinds, strict=True):
        rows = rates[rates.observation == kind]
        labels = [name.replace(", ", "\n").replace("+", "\n+ ") for name in rows.experiment.unique()]
        plots.grouped_rates(rows.assign(paper=np.nan), "experiment", labels, ax)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
    titles(list(axes.flat), [SEEN[kind] for kind in kinds])
    _methods_and_seeds(figure, rates)
    return figure


def generalization(rates: pd.DataFrame) -> Figure:
    """For each task and method its rates at its own grasps, elsewhere and in motion."""
    figure, ax = plt.subplots(figsize=(PAGE_WIDTH, 2.6))
    plots.own_and_elsewhere(rates, ax)
    figure.legend(handles=plots.own_and_elsewhere_entries(rates), ncol=6, loc="outside upper center")
    return figure


def keypoint_control(rates: pd.DataFrame, controls: Mapping[str, float], printed: pd.DataFrame) -> Figure:
    """Success from keypoints against the budget, between floor and ceiling; the paper's values from images beside it.

    Args:
        rates: as `plots.curve` takes it, with the column timesteps.
        controls: "expert" and "goal-blind" -> their success.
        printed: method, timesteps, value of the paper, from images.
    """
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.7))
    plots.curve(rates, "timesteps", "timesteps of demonstrations", ax, log=True)
    plots.printed_points(printed, ax)
    plots.log_ticks({*rates.timesteps, *printed.timesteps}, ax)
    for name in ("expert", "goal-blind"):
        plots.level(controls[name], NAMES[name], ax)
    ax.set_ylim(-0.03, 1.12)
    titles([ax], ["Pick-Place, from keypoints"])
    figure.legend(handles=plots.entries(list(rates.method.unique()), "paper, from images"), ncol=4,
                  loc="outside upper center", columnspacing=0.8, handletextpad=0.4)
    return figure


def rollouts(strips: Strips, absent: Sequence[str] = (), problem: str | None = None) -> Figure:
    """One strip of frames an episode.

    Args:
        absent: methods whose policies are not there to be shown.
        problem: why there is no strip.
    """
    count = max(1, len(strips))
    figure, axes = plt.subplots(count, 1, figsize=(PAGE_WIDTH, 1.14 * count), squeeze=False)
    for ax, (frames, steps) in zip(axes.flat, strips.values(), strict=False):
        maps.strip(frames, [str(step) for step in steps], ax)
    if not strips:
        _say(problem or "no run is stored", axes[0, 0])
    titles(list(axes.flat), list(strips) or [""])
    if absent:
        remark(figure, f"not shown, for the policy is not shipped: {', '.join(absent)}")
    return figure


def statistics(simulated: pd.DataFrame) -> Figure:
    """How often the intervals hold the truth, and how wide they are.

    Args:
        simulated: as `move.study.statistics.simulation.coverage` gives it.
    """
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.8))
    plots.coverages(simulated, axes[0])
    axes[0].legend(loc="lower left")
    plots.half_widths(simulated[simulated.interval == "ours"], axes[1])
    titles(axes, ["do the intervals hold the truth?", "what another seed buys"])
    return figure


def table1_spatial_factors(rates: pd.DataFrame, gaps: pd.DataFrame, labels: Mapping[str, str]) -> Figure:
    """Static beside MOVE as more is random, and their difference.

    Args:
        rates: as `plots.grouped_rates` takes it, with the column factors.
        labels: what to call the values of factors.
    """
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.4), width_ratios=[1.2, 1])
    plots.grouped_rates(rates, "factors", [labels[name] for name in rates.factors.unique()], axes[0])
    axes[0].set_xlabel("what is random")
    handles, _ = axes[0].get_legend_handles_labels()
    figure.legend(handles=[*handles, _seed_dot()], ncol=4, loc="outside upper center")
    plots.gaps(gaps, "factors", [labels[name] for name in gaps.factors.unique()], axes[1])
    titles(axes, ["success", "MOVE minus static"])
    return figure


def table2_main(rates: pd.DataFrame, given: pd.DataFrame, controls: pd.DataFrame, gaps: pd.DataFrame,
                means: pd.DataFrame) -> Figure:
    """Ten tasks from pixels and from keypoints, and the differences from pixels.

    Args:
        rates, given: as `plots.task_rates` takes them, from pixels and from keypoints.
        gaps, means: as `plots.gaps` takes them, from pixels.
    """
    figure, axes = plt.subplots(3, 1, figsize=(PAGE_WIDTH, 7.2), height_ratios=[1, 0.85, 1.35])
    plots.task_rates(rates, controls, axes[0])
    plots.task_rates(given, controls, axes[1])
    axes[0].tick_params(labelbottom=False)
    handles, _ = axes[0].get_legend_handles_labels()
    figure.legend(handles=handles, ncol=6, loc="outside upper center")
    plots.gaps(gaps, "task", [TASKS[name].title for name in gaps.task.unique()], axes[2], means)
    handles, _ = axes[2].get_legend_handles_labels()
    handles = sorted(handles, key=lambda handle: handle.get_label().endswith("paper"))
    axes[2].legend(handles=handles, ncol=2, loc="lower right", bbox_to_anchor=(1, 1))  # above: bars fill the panel
    titles(axes, ["from pixels", "from keypoints: perception given", "from pixels: MOVE minus the others"])
    return figure


def table6_collection(costs: pd.DataFrame, means: pd.DataFrame) -> Figure:
    """What a demonstration costs: its timesteps, and how many attempts succeed.

    Args:
        costs: as `plots.costs` takes it.
        means: method, paper_mean_steps, paper_generation_rate.
    """
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.5))
    for ax, value in zip(axes, ("mean_steps", "generation_rate"), strict=True):
        printed = means.set_index("method")[f"paper_{value}"].dropna().to_dict()
        plots.costs(costs, value, printed, ax, share=value == "generation_rate")
    axes[0].set_ylabel("timesteps a demonstration")
    axes[1].set_ylabel("attempts that succeed (%)")
    titles(axes, ["length of a demonstration", "generation rate"])
    figure.legend(handles=plots.cost_entries(list(costs.expert.unique())), ncol=4, loc="outside upper center")
    return figure


def table_adc(rates: pd.DataFrame) -> Figure:
    """The readings of ADC, one panel a kind of observation.

    Args:
        rates: observation, and what `plots.readings` takes with the column jumping.
    """
    kinds = list(rates.observation.unique())
    figure, axes = plt.subplots(len(kinds), 1, figsize=(PAGE_WIDTH, 2.1 * len(kinds) + 0.3), squeeze=False)
    for ax, kind in zip(axes.flat, kinds, strict=True):
        plots.readings(rates[rates.observation == kind], "jumping", ax)
    handles, _ = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles=handles, ncol=3, loc="outside upper center")
    titles(list(axes.flat), [SEEN[kind] for kind in kinds])
    return figure


def table_keypoint_control(rates: pd.DataFrame, controls: pd.DataFrame) -> Figure:
    """Ten tasks from keypoints between floor and ceiling."""
    figure, ax = plt.subplots(figsize=(PAGE_WIDTH, 2.7))
    plots.task_rates(rates, controls, ax)
    handles, _ = ax.get_legend_handles_labels()
    figure.legend(handles=handles, ncol=5, loc="outside upper center")
    titles([ax], ["ten tasks, from keypoints"])
    return figure


def table_recipe(table: pd.DataFrame) -> Figure:
    """For each budget the recipe's success with one change at a time, and what each change gains.

    Args:
        table: as `move.report.tables.recipe_table` gives it.
    """
    budgets = list(table.groupby("timesteps", sort=False))
    figure, axes = plt.subplots(1, 2 * len(budgets), figsize=(PAGE_WIDTH, 2.3), squeeze=False)
    texts: list[str] = []
    named: list[str] | None = None
    for number, (budget, rows) in enumerate(budgets):
        success, gain = axes[0, 2 * number:2 * number + 2]
        plots.changes(rows, success)
        plots.gains(rows, gain)
        gain.tick_params(labelleft=False)
        success.tick_params(labelleft=list(rows.change) != named)  # the same changes are named once
        named, texts = list(rows.change), [*texts, f"{plots.short(budget)} timesteps", "gain"]
    titles(list(axes.flat), texts)
    return figure


def claims(ledger: pd.DataFrame) -> Figure:
    """How many claims have which verdict."""
    figure, ax = plt.subplots(figsize=(PAGE_WIDTH, 1.7))
    plots.verdicts(ledger, VERDICTS, ax)
    return figure

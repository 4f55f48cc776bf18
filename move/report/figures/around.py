"""Around the results: the idea, episodes, costs of collection, the recipe, the statistics, the claims."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.report import maps, plots
from move.report.figures.panels import Strips, empty_panel
from move.report.style import NAMES, PAGE_WIDTH, remark, titles
from move.sim.configuration import Box


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
        empty_panel(problem or "no images", strip_axes[0])
    titles([*panels.flat, *strip_axes], [*texts, *(strips or [""])])
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
        empty_panel(problem or "no run is stored", axes[0, 0])
    titles(list(axes.flat), list(strips) or [""])
    if absent:
        remark(figure, f"not shown, for the policy is not shipped: {', '.join(absent)}")
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


def statistics(simulated: pd.DataFrame) -> Figure:
    """How often the intervals hold the truth, and how wide they are.

    Args:
        simulated: as `move.statistics.simulation.coverage` gives it.
    """
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.8))
    plots.coverages(simulated, axes[0])
    axes[0].legend(loc="lower left")
    plots.half_widths(simulated[simulated.interval == "ours"], axes[1])
    titles(axes, ["do the intervals hold the truth?", "what another seed buys"])
    return figure


def claims(numbers: pd.DataFrame) -> Figure:
    """The claims that are numbers, grouped by figure: shares and differences, and below them factors.

    Args:
        numbers: as `move.claims.ledger.numbers` gives it.
    """
    grouped = numbers.assign(first=numbers.groupby("figure").number.transform("min")).sort_values(
        ["first", "number"], kind="stable")
    parts = [grouped[~grouped.factor], grouped[grouped.factor]]
    lines = [max(part.number.nunique(), 1) for part in parts]
    figure, axes = plt.subplots(2, 1, figsize=(PAGE_WIDTH, 1.9 + 0.17 * sum(lines)), height_ratios=lines)
    for ax, part in zip(axes, parts, strict=True):
        plots.forest(part, ax)
    axes[0].set_xlabel("difference, rate or share, as the claim has it")
    axes[1].set(xlabel="static's timesteps / MOVE's, same success", xlim=(0, None))
    axes[1].axvline(1, color="black", lw=0.8, ls="--")
    figure.legend(handles=plots.forest_entries(list(numbers.verdict)), ncol=4, loc="outside upper center")
    titles(axes, ["claims that are a share or a difference", "claims of data efficiency"])
    return figure

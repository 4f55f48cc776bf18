"""The distance to the paper, setting by setting."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from move.experiments.gap import PACKAGE, TOGETHER
from move.report import plots
from move.report.figures.panels import empty_panel
from move.report.gap import INTERACTION, PAPER, UNEXPLAINED
from move.report.plots.axes import GREY
from move.report.style import COLOURS, PAGE_WIDTH, titles
from move.sim.tasks import TASKS


def gap(steps: pd.DataFrame, rates: pd.DataFrame, leads: pd.DataFrame, cases: Sequence[str]) -> Figure:
    """One row a case: static from the rate here to the paper's, step by step, and MOVE's lead under each setting.

    Args:
        steps: as `move.report.gap.waterfall` gives it.
        rates: as `move.report.gap.gap_table` gives it, with the paper's rate in `paper`.
        leads: as `move.report.gap.lead_table` gives it, with the paper's difference in `paper`.
    """
    size = PAGE_WIDTH, 0.4 + 2.3 * len(cases)
    figure, axes = plt.subplots(len(cases), 2, figsize=size, squeeze=False, sharey="row", width_ratios=[1.3, 1])
    for row, case in zip(axes, cases, strict=True):
        static = rates[(rates.case == case) & (rates.method == "static")].set_index("setting")
        if PACKAGE not in static.index:
            for ax in row:
                empty_panel("missing", ax)
            continue
        own = steps[(steps.case == case) & (steps.method == "static")].set_index("step")
        lines = [PACKAGE, *(name for name in own.index if name != UNEXPLAINED),
                 *([TOGETHER, UNEXPLAINED] if UNEXPLAINED in own.index else []), PAPER]
        _waterfall(own, static, lines, row[0])
        _leads(leads[leads.case == case].set_index("setting"), lines, row[1])
    names = [case if case not in TASKS else TASKS[case].title for case in cases]
    titles(list(axes.ravel()), [text for name in names for text in (f"{name}: static", f"{name}: MOVE minus static")])
    return figure


def _waterfall(steps: pd.DataFrame, rates: pd.DataFrame, lines: Sequence[str], ax: Axes) -> None:
    """From the rate here to the paper's: levels as whole bars, steps as hanging ones with their length's interval."""
    levels = {PACKAGE: rates.value.get(PACKAGE), TOGETHER: rates.value.get(TOGETHER), PAPER: rates.paper.iloc[0]}
    for place, name in enumerate(lines):
        if name in levels:
            ax.barh(place, levels[name], color=COLOURS["static"], alpha=0.85 if name != PAPER else 0.4, height=0.7)
        elif not np.isnan(steps.change[name]):
            row = steps.loc[name]
            strength = 0.5 if name == INTERACTION else 0.9
            ax.barh(place, row.change, left=row.start, color=GREY, alpha=strength, height=0.7)
            if not np.isnan(row.low):
                ax.errorbar(row.start + row.change, place, xerr=[[row.change - row.low], [row.high - row.change]],
                            color="black", capsize=2, lw=0.9)
    ax.set_yticks(range(len(lines)), lines)
    ax.set_ylim(len(lines) - 0.5, -0.5)
    ax.set_xlabel("success (%)")
    ax.xaxis.set_major_formatter(lambda value, _: f"{100 * value:.0f}")


def _leads(leads: pd.DataFrame, lines: Sequence[str], ax: Axes) -> None:
    """MOVE minus static under each setting, a point with its interval a line; the paper's as a diamond."""
    for place, name in enumerate(lines):
        if name in leads.index:
            row = leads.loc[name]
            ax.errorbar(row.difference, place, xerr=[[row.difference - row.low], [row.high - row.difference]],
                        fmt="o", color=COLOURS["move"], ms=4, capsize=2, lw=0.9)
    if len(leads):
        ax.plot(leads.paper.iloc[0], len(lines) - 1, "D", color="black", mfc="white", ms=4.5)
    plots.points_axis(ax, "points")
    ax.tick_params(labelleft=False)

"""Figure 6: what has to move? Nothing, then the object, the target, the camera and the rotation as well."""

from __future__ import annotations

from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Repeats
from move.figures.plots.panels import methods_and_seeds
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import counts_text, difference_brief, largest, variant_table
from move.sim.motion.wrappers import movable
from move.sim.tasks import TASKS, get_task
from move.study.axes import budgets
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

REPEATED = True
ORDER = ("object", "target", "camera", "rotation")  # in which they are added
BY = ["task", "moves", "method"]


def runs(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "assembly"),
    alone_tasks: tuple[str, ...] = ("pick-place",), seeds: Repeats = 3, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """MOVE from pixels at table 2's budget with more and more in motion; on some tasks each motion alone.

    The label `moves` names what moves; where nothing does, the demonstrations are static.
    """
    base = partial(policy_run, profile, episodes=episodes)
    return [run for task in dict.fromkeys((*tasks, *alone_tasks))
            for run in grid(base, seed=range(seeds), task=budgets([task], most_timesteps),
                            moves=_moves(task, task in tasks, task in alone_tasks))]


def _moves(task: str, together: bool, alone: bool) -> dict[str, dict[str, Any]]:
    parts = sorted(movable(get_task(task), "all"), key=ORDER.index)
    chosen = {"nothing": (), "object": ("object",)}
    if together:
        chosen |= {" + ".join(parts[:count]): tuple(parts[:count]) for count in range(2, len(parts) + 1)}
    if alone:
        chosen |= {f"{part} alone": (part,) for part in parts[1:]}
    return {name: {"method": "move", "moving": moving} if moving else {"method": "static"}
            for name, moving in chosen.items()}


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates, and what each motion brings."""
    noise = data.noise()
    return {"": rate_table(data.episodes, BY, noise),
            "steps": variant_table(data.episodes, ["task"], "moves", _pairs, noise)}


def _pairs(episodes: pd.DataFrame) -> list[tuple[str, str]]:
    """Each rung with the one before, and each motion alone with nothing."""
    rungs = [name for name in episodes.moves.unique() if "alone" not in name]
    return [*zip(rungs[1:], rungs, strict=False),
            *((name, "nothing") for name in episodes.moves.unique() if "alone" in name)]


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """One ladder a task."""
    rates = data.with_missing(tables[""], BY)
    tasks = list(rates.task.unique())
    bars = [int((rates.task == task).sum()) for task in tasks]
    figure, axes = plt.subplots(1, len(tasks), figsize=(PAGE_WIDTH, 2.5), squeeze=False, sharey=True, width_ratios=bars)
    for ax, task in zip(axes.flat, tasks, strict=True):
        plots.ladder(rates[rates.task == task], "moves", ax)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
        ax.set_xlabel("what moves in the demonstrations")
    titles(list(axes.flat), [TASKS[task].title for task in tasks])
    methods_and_seeds(figure, rates)
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How many neighbours differ, and the largest difference."""
    steps, row = tables["steps"], largest(tables["steps"])
    most = "" if row is None else (f"; the largest: {TASKS[row.task].title}, {row.moves} against {row.baseline} "
                                   f"{difference_brief(row)}")
    return (
        "**The paper:** success rises with every motion that is added. **Here**, each motion added, or alone against "
        f"nothing, in points: {counts_text(steps)}{most}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Figure 6. What has to move?",
    shown=(
        f"Success as one thing after the other moves in the demonstrations, and where one thing moves alone (light "
        f"bars); the first bar is static collection. {INTERVALS} White dots are single seeds. The paper prints no "
        f"numbers for this figure."),
    alt="One bar chart a task, one bar for everything that moves.",
    tables={
        "": f"Figure 6: what has to move. {RATES}",
        "steps": (
            "Figure 6: each motion added against the row before, and each alone against nothing; in "
            "points, with 95 % intervals."),
    },
)

"""Figure 7: how fast? The largest speed of the object, of the target, or of the camera, the others as always."""

from __future__ import annotations

import math
from functools import partial
from typing import Annotated, Any

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field

from move.figures import plots
from move.figures.page.captions import INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Repeats
from move.figures.plots.panels import seed_dot
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import counts_text, difference_brief, largest, variant_table
from move.sim.collection import FASTEST, FASTEST_TURN
from move.sim.motion.wrappers import movable
from move.sim.tasks import TASKS, get_task
from move.study.axes import budgets
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

Speed = Annotated[float, Field(gt=0, le=FASTEST, allow_inf_nan=False)]
Degrees = Annotated[float, Field(gt=0, le=math.degrees(FASTEST_TURN), allow_inf_nan=False)]
USUAL = {"object": 0.03, "target": 0.03, "camera": 1.0}
"""The speeds used everywhere else: metres per step, and degrees per step of the camera."""
BY = ["task", "part", "speed", "method"]


def runs(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "assembly"),
    camera_tasks: tuple[str, ...] = ("pick-place",), speeds: tuple[Speed, ...] = (0.01, 0.02, 0.03, 0.05, 0.08),
    camera_degrees: tuple[Degrees, ...] = (0.33, 0.67, 1.0, 1.67, 2.67), seeds: Repeats = 2, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """MOVE from pixels at table 2's budget, one speed at a time; and static.

    Labels: `part`, whose speed it is ("nothing": static), and `speed`, metres a step or degrees a step of the camera.

    Args:
        speeds: of object and target, metres per step.
        camera_degrees: of the camera, degrees per step.
    """
    base = partial(policy_run, profile, episodes=episodes)
    runs: list[LabelledRun] = []
    for task in tasks:
        place: dict[str, Any] = {"seed": range(seeds), "task": budgets([task], most_timesteps)}
        runs += grid(partial(base, method="static"), **place, part={"nothing": {}}, speed={0.0: {}})
        for part in [name for name in ("object", "target") if name in movable(get_task(task), "all")]:
            runs += grid(partial(base, method="move"), **place, part={part: {}},
                         speed={speed: {f"{part}_speed": speed} for speed in speeds})
        if task in camera_tasks:
            runs += grid(partial(base, method="move"), **place, part={"camera": {}},
                         speed={angle: {"camera_speed": math.radians(angle)} for angle in camera_degrees})
    return runs


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates at every speed, and each speed against the usual one."""
    noise = data.noise()
    return {"": rate_table(data.episodes, BY, noise),
            "ends": variant_table(data.episodes, ["task", "part"], "speed", _against_usual, noise)}


def _against_usual(group: pd.DataFrame) -> list[tuple[float, float]]:
    usual = USUAL.get(group.part.iloc[0])
    return [(speed, usual) for speed in sorted(group.speed.unique()) if usual and speed != usual]


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """One row a task, one panel a part whose speed is varied; static as a dashed line with its band."""
    rates = data.with_missing(tables[""], BY)
    units = {"object": "object's speed (m per step)", "target": "target's speed (m per step)",
             "camera": "camera's speed (degrees per step)"}
    tasks, parts = list(rates.task.unique()), [part for part in units if part in set(rates.part)]
    still = rates[(rates.part == "nothing") & rates.value.notna()]
    figure, axes = plt.subplots(len(tasks), max(len(parts), 1), figsize=(PAGE_WIDTH, 1.75 * len(tasks) + 0.4),
                                squeeze=False, sharey=True)
    texts = {}
    for row, task in zip(axes, tasks, strict=True):
        here = rates[rates.task == task]
        studied = [part for part in parts if part in set(here.part)]
        for ax, part in zip(row, studied, strict=False):
            plots.curve(here[here.part == part], "speed", units[part], ax, dots=True)
            for static in still[still.task == task].itertuples():
                plots.reference(static, ax)
            ax.set_ylabel("success (%)" if ax is row[0] else "")
            texts[ax] = f"{TASKS[task].title}, {part}"
        for ax in row[len(studied):]:
            ax.remove()
    titles(list(texts), list(texts.values()))
    known = [plots.reference_entry("static")] * bool(len(still)) + plots.entries(
        ["move"], missing=bool(rates.value.isna().any()))
    figure.legend(handles=[*known, seed_dot(), *plots.pooled_entry(rates)], ncol=5, loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How many speeds differ from the usual one, and the largest difference."""
    ends, row = tables["ends"], largest(tables["ends"])
    most = "" if row is None else (f"; the largest: {TASKS[row.task].title}, {row.part} {row.speed:.2g} against "
                                   f"{row.baseline:.2g} {difference_brief(row)}")
    return (
        "**The paper:** a degree of robustness to speed. **Here**, each speed minus the usual one, in points: "
        f"{counts_text(ends)}{most}. **How sure:** not distinguishable is not the same. {data.sample_size}")


WORDS = Words(
    title="Figure 7. How fast may it move?",
    shown=(
        f"Success against one largest speed, the others as everywhere else; the dashed line is static collection, "
        f"the band its interval. {INTERVALS} White dots are single seeds, question marks speeds that "
        f"are not computed yet. The paper prints no numbers for this figure."),
    alt="A grid of curves over the speed, one row a task, one column for the object, the target and the camera.",
    tables={
        "": f"Figure 7: the largest speed of one thing. {RATES}",
        "ends": "Figure 7: each speed against the one used everywhere else; in points, with 95 % intervals.",
    },
)

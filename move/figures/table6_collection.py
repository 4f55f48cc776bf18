"""Table 6: what a demonstration costs, its timesteps and how many attempts succeed, by each expert and method."""

from __future__ import annotations

from functools import partial
from typing import get_args

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move import paper
from move.choices import ExpertName
from move.figures import plots
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import collection_costs, with_paper
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.sim.tasks import TASKS
from move.sim.tasks.task import acceptance_rate
from move.study.kinds import collector_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

TRAINS = False
VALUES = ("mean_steps", "generation_rate")


def runs(profile: Profile, attempts: Count = 100) -> list[LabelledRun]:
    """Attempts by each expert, static, ADC and MOVE, on every task."""
    base = partial(collector_run, profile, attempts=attempts)
    return grid(base, expert=get_args(ExpertName), task=PAPER_TASKS, method=PAPER_METHODS)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Means over the tasks, task by task, and how many random configurations a task keeps."""
    costs = collection_costs(data.results)
    means = costs.groupby(["expert", "method"], sort=False)[[*VALUES, "jumps"]].mean().reset_index()
    for value in VALUES:
        means = with_paper(means, "table6_collection", on=["method"], metric=value, column=f"paper_{value}",
                           condition="simulation")
    return {"": means, "by_task": costs, "kept": acceptance_rates(np.random.default_rng(0))}


def acceptance_rates(rng: np.random.Generator) -> pd.DataFrame:
    """For each task the share of random configurations that its reach and clearance filter keeps.

    The same filter serves static starts, ADC's jumps, MOVE's motions and evaluation.
    """
    return pd.DataFrame([{"task": name, "acceptance_rate": acceptance_rate(TASKS[name], rng, 1000)}
                         for name in PAPER_TASKS])


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """What a demonstration costs: its timesteps, and how many attempts succeed."""
    costs, means = tables["by_task"], tables[""]
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.5))
    for ax, value in zip(axes, VALUES, strict=True):
        printed = means.set_index("method")[f"paper_{value}"].dropna().to_dict()
        plots.costs(costs, value, printed, ax, share=value == "generation_rate")
    axes[0].set_ylabel("timesteps a demonstration")
    axes[1].set_ylabel("attempts that succeed (%)")
    titles(axes, ["length of a demonstration", "generation rate"])
    figure.legend(handles=plots.cost_entries(list(costs.expert.unique())), ncol=4, loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How much longer MOVE's demonstrations are, and how many attempts succeed, in the paper and here."""
    means, names = tables[""], {"phase": "our expert", "metaworld": "Meta-World's expert"}
    per = means[means.method == "static"].merge(means[means.method == "move"], on="expert",
                                                suffixes=("_static", "_move"))
    each = "; ".join(
        f"with {names[row.expert]} {row.mean_steps_move / row.mean_steps_static - 1:+.0%} timesteps "
        f"({row.mean_steps_static:.1f} to {row.mean_steps_move:.1f}), {row.generation_rate_move:.1%} succeed against "
        f"{row.generation_rate_static:.1%}" for row in per.itertuples())
    steps, kept = (paper.published("table6_collection", value, condition="simulation").set_index("method").value
                   for value in VALUES)
    return (
        f"**The paper:** {steps.move / steps.static - 1:+.0%} timesteps ({steps.static} to {steps.move}), "
        f"{kept.move:.1%} of attempts succeed against {kept.static:.1%}. **Here**, MOVE against static: "
        f"{each or 'nothing to compare yet'}. **How sure:** means over {tables['by_task'].task.nunique()} tasks. "
        f"{data.sample_size}")


WORDS = Words(
    title="Table 6. What a demonstration costs",
    shown=(
        "(a) Timesteps of a successful demonstration and (b) share of attempts that succeed: means over the tasks with "
        "95 % intervals of these same tasks, from the demonstrations of each. Dots are single tasks, dotted lines the "
        "paper's values."),
    alt="Two bar charts, for each method one dark and one light bar.",
    tables={
        "": "Table 6: what a demonstration costs, means over the tasks.",
        "by_task": "Table 6, task by task; 95 % intervals are Wilson's.",
        "kept": "Share of random configurations that a task's reach and clearance filter keeps.",
    },
)

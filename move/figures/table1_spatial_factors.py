"""Table 1: Pick-Place as its object, then its target, then camera and hand become random; static and MOVE."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move import paper
from move.figures import plots
from move.figures.page.captions import COSTS, DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Observation, Repeats
from move.figures.plots.panels import seed_dot
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table, run_costs, with_paper
from move.figures.tables.differences import difference_brief, difference_table, variant_table
from move.statistics.cells import training_noise
from move.statistics.estimates import unpaired_difference
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

REPEATED = True
NAMES = {"object": "object", "object+target": "+ target", "all": "+ camera"}  # what is random


def runs(
    profile: Profile, observation: Observation = "rgb", timesteps: Count = 20_000, seeds: Repeats = 3,
    episodes: Count = 100,
) -> list[LabelledRun]:
    """Both methods with each set of random factors; the label `factors`."""
    base = partial(policy_run, profile, task="pick-place", observation=observation, timesteps=timesteps,
                   episodes=episodes)
    return grid(base, seed=range(seeds), factors=list(NAMES), method=("static", "move"))


def tables(data: Data, *, observation: str) -> dict[str, pd.DataFrame]:
    """Rates, MOVE minus static, what static loses by each factor, and costs."""
    noise, static = data.noise(observation), data.episodes[data.episodes.method == "static"]
    both = training_noise(data.episodes, ["factors", "method"], noise)
    rates = rate_table(data.episodes, ["factors", "method"], noise)
    return {
        "": with_paper(rates, "table1_spatial_factors", on=["factors", "method"]),
        "differences": difference_table(data.episodes, "factors", noise),
        "lost": variant_table(static, ["method"], "factors", _with_more_random, both, unpaired_difference),
        "costs": run_costs(data.results),
    }


def _with_more_random(episodes: pd.DataFrame) -> list[tuple[str, str]]:
    return [(more, "object") for more in episodes.factors.unique() if more != "object"]


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Static next to MOVE as more is random, and their difference."""
    rates, differences = tables[""], tables["differences"]
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.4), width_ratios=[1.2, 1])
    plots.grouped_rates(rates, "factors", [NAMES[name] for name in rates.factors.unique()], axes[0])
    axes[0].set_xlabel("what is random")
    handles, _ = axes[0].get_legend_handles_labels()
    figure.legend(handles=[*handles, seed_dot()], ncol=4, loc="outside upper center")
    plots.differences(differences, "factors", [NAMES[name] for name in differences.factors.unique()], axes[1])
    titles(axes, ["success", "MOVE minus static"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How static falls as more is random, in the paper and here, and MOVE minus static."""
    rates = tables[""]
    fall = ", ".join(f"{NAMES[row.factors]} {row.value:.1%}"
                     for row in rates[rates.method == "static"].itertuples())
    leads = ", ".join(f"{NAMES[row.factors]} {difference_brief(row)}" for _, row in tables["differences"].iterrows())
    printed = paper.published("table1_spatial_factors").set_index("condition").value
    return (
        f"**The paper:** static falls from {printed['object']:.1%} to {printed['all']:.1%} as more is random. "
        f"**Here** static has {fall or 'nothing computed yet'}; MOVE minus static in points: "
        f"{leads or 'nothing to compare yet'}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Table 1. How much harder does every random factor make it?",
    shown=(
        f"(a) Success on Pick-Place as more is random: the object, then the target and the hand too, then the camera "
        f"too. White dots are single seeds, dotted lines the paper's static values. (b) MOVE minus static, paired by "
        f"configuration. {INTERVALS}"),
    alt="A bar chart of static beside MOVE in three groups, and their differences with intervals.",
    tables={
        "": f"Table 1: what is random, Pick-Place. {RATES}",
        "differences": f"Table 1: what is random. {DIFFERENCES}",
        "lost": (
            "Table 1: static with more random against static with the object alone, not "
            "paired; in points, with 95 % intervals."),
        "costs": f"Table 1. {COSTS}",
    },
)

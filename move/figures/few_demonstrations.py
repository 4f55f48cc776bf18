"""Figure 1 with fewer demonstrations: how few at a place are too few to learn anything?"""

from __future__ import annotations

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.fig1_sparse import grasp_runs
from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Counts, Observation, Repeats
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import demonstrations_made, rate_table
from move.figures.tables.differences import difference_brief, difference_table
from move.sim.grasp_points import SPARSE_SIDE
from move.study.labels import LabelledRun
from move.study.profiles import Profile

REPEATED = True
BY = ["timesteps", "method"]


def runs(
    profile: Profile, observation: Observation = "rgb", timesteps: Counts = (1550, 3900, 7000), seeds: Repeats = 3,
    grid_side: Count = 15,
) -> list[LabelledRun]:
    """In these budgets static makes about 2, 5 and 9 demonstrations at each of its points.

    The paper took 10, for with fewer "usually" no meaningful policy was learnt (section IV-A).
    """
    return [run for budget in timesteps for run in grasp_runs(
        profile, "sparse", observation, "anywhere", seeds, grid_side, timesteps=budget)]


def tables(data: Data, *, observation: str) -> dict[str, pd.DataFrame]:
    """Rates over the whole space and at the points, differences, and how many demonstrations there are."""
    noise = data.noise(observation, grid=True)
    whole, points = (data.episodes[data.episodes.group == group] for group in ("grid", "point"))
    return {
        "": rate_table(whole, BY, noise),
        "points": rate_table(points, BY, noise),
        "differences": difference_table(whole, "timesteps", noise),
        "made": demonstrations_made(data.results, "timesteps"),
    }


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Success at the nine points and over the whole space, against the budget."""
    at_points, whole = (data.with_missing(tables[suffix], BY) for suffix in ("points", ""))
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.3), sharey=True)
    for ax, rates in zip(axes, (at_points, whole), strict=True):
        plots.curve(rates, "timesteps", "timesteps of demonstrations", ax, log=True)
    axes[1].set_ylabel("")
    titles(axes, [f"{words} (n = {' or '.join(f'{count:,}' for count in sorted(table.episodes.unique()))} a point)"
                  for words, table in (("at the nine points", tables["points"]), ("whole space", tables[""]))])
    missing = bool(pd.concat([at_points, whole]).value.isna().any())
    figure.legend(handles=[*plots.entries(["static", "move"], missing=missing), *plots.pooled_entry(whole)], ncol=4,
                  loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """At the smallest computed budget static's success at its own points, and MOVE's lead over the whole space."""
    static = {suffix: tables[suffix][tables[suffix].method == "static"].sort_values("timesteps")
              for suffix in ("points", "made")}
    least, there = tables["differences"].sort_values("timesteps").head(1), "nothing is computed yet"
    if len(static["points"]):
        row, made = static["points"].iloc[0], static["made"].iloc[0]
        there = (f"at the smallest computed budget ({row.timesteps:,} timesteps, "
                 f"{made.demonstrations / SPARSE_SIDE**2:.1f} demonstrations a point) static succeeds at its points in "
                 f"{row.value:.0%} [{row.low:.0%}, {row.high:.0%}]"
                 + "".join(f"; whole space, MOVE minus static {difference_brief(each)}"
                           for _, each in least.iterrows()))
    return (
        '**The paper:** with under ten demonstrations a point policies "usually failed to learn". **Here:** '
        f"{there}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="How few demonstrations at a place are too few?",
    shown=(
        f"Success in figure 1's experiment against the budget, (a) at the nine grasp points of the demonstrations "
        f"themselves and (b) over the whole space. In these budgets static makes about 2, 5 and 9 demonstrations at "
        f"each point, MOVE a fifth fewer; n is episodes over all seeds. {INTERVALS} Question marks "
        f"are budgets that are not computed yet."),
    alt="Two panels with a curve a method over the budget.",
    tables={
        "": f"Figure 1 with fewer demonstrations: the whole space. {RATES}",
        "points": f"Figure 1 with fewer demonstrations: at the nine grasp points themselves. {RATES}",
        "differences": f"Figure 1 with fewer demonstrations: the whole space. {DIFFERENCES}",
        "made": "Figure 1 with fewer demonstrations: how many there are, means of the seeds.",
    },
)

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
from move.figures.tables import demonstrations_made, difference_table, difference_text, rate_table
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
        "differences": difference_table(whole, "timesteps", others=("static",), known=noise),
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
    """Static at its own points at every budget, its demonstrations there, and the lead over the whole space."""
    points, made = (tables[suffix][tables[suffix].method == "static"].sort_values("timesteps")
                    for suffix in ("points", "made"))
    own = "; ".join(f"in {row.timesteps:,} timesteps {row.value:.0%} [{row.low:.0%}, {row.high:.0%}]"
                    for row in points.itertuples())
    between = "; ".join(f"in {row.timesteps:,} timesteps {difference_text(row)}"
                        for _, row in tables["differences"].iterrows())
    counts = ", ".join(f"{row.demonstrations / SPARSE_SIDE**2:.1f}" for row in made.itertuples())
    return (
        '**The paper:** with fewer than ten demonstrations at each of the nine points, policies "usually failed to '
        f"learn\". **Here:** static succeeds at its own nine points {own or 'in nothing computed yet'}; it has "
        f"{counts or 'no'} demonstrations at each. Over the whole space MOVE minus static is "
        f"{between or 'not computed yet'}. **How sure:** {data.sample_size}")


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

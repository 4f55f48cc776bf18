"""Figure 1's static policies with new seeds: two claims about their places that the first seeds had left undecided."""

from __future__ import annotations

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move import paper
from move.figures.decided import FIRST_SEED
from move.figures.fig1_sparse import MAPS, grasp_runs
from move.figures.page.captions import INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Repeats
from move.figures.plots import maps
from move.figures.plots.axes import PRINTED, rate_points, success_axis
from move.figures.plots.panels import empty_panel
from move.figures.plots.style import COLUMN_WIDTH, titles
from move.figures.tables import rate_table
from move.study.labels import LabelledRun
from move.study.profiles import Profile

PLACES = {"point": "nine places", "grid": "whole space"}


def runs(profile: Profile, seeds: Repeats = 10, timesteps: Count = 7000, grid_side: Count = 15) -> list[LabelledRun]:
    """Static at nine points, the hand anywhere, with as many seeds as the ledger said would decide claims 11 and 13."""
    return grasp_runs(profile, "sparse", "rgb", "anywhere", seeds, grid_side, timesteps, methods=("static",),
                      first_seed=FIRST_SEED)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Success at the nine places and over the whole space, once the last run is there (see `decided.tables`)."""
    episodes = data.episodes[:0] if data.missing else data.episodes
    return {"": rate_table(episodes, ["group", "method"], data.noise(grid=True))}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """A map of the seeds that succeed, and both rates against half of the episodes."""
    figure, axes = plt.subplots(1, 2, figsize=(COLUMN_WIDTH, 2.0), width_ratios=[1, 0.8])
    rates = tables[""].set_index("group").reindex(list(PLACES))
    if rates.value.isna().any():
        for ax in axes:
            empty_panel("missing", ax)
        return figure
    maps.seeds_bar(maps.heatmap(data.episodes, axes[0]), [axes[0]], data.episodes.seed.nunique())
    rate_points(range(len(rates)), rates, "static", axes[1])
    axes[1].axhline(0.5, color="black", lw=0.8, ls="--")
    (printed,) = paper.published("fig1_sparse", method="static").value
    axes[1].plot([0.7, 1.3], [printed, printed], **PRINTED)
    axes[1].set_xticks(range(len(rates)), [name.replace(" ", "\n", 1) for name in PLACES.values()])
    axes[1].set_xlim(-0.5, len(rates) - 0.5)
    success_axis(axes[1])
    titles(axes, ["static", "success"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Both rates with their intervals."""
    each = "; ".join(f"{PLACES[row.group]} {row.value:.0%} [{row.low:.0%}, {row.high:.0%}]"
                     for row in tables[""].itertuples())
    return ("**The paper:** trained at nine places, static performs well there (claim 13), and succeeds only around "
            f"them, in 29.5 % of the space (claim 11). **Here**, static with new seeds: "
            f"{each or 'nothing is complete yet'}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Static at nine places, with new seeds",
    shown=(f"(a) Static, {MAPS} Rings are the nine grasp points. (b) Success at these points and over the whole space; "
           f"dashed is half, above which a claim says that a policy succeeds, dotted the paper's value. {INTERVALS}"),
    alt="A map of a space of 30 by 30 cm, coloured by success, and two rates with their intervals.",
    tables={"": f"Static at nine places, with new seeds. {RATES}"},
)

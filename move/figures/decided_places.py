"""Figure 1's static policies with new seeds: two claims about their places that the first seeds had left undecided."""

from __future__ import annotations

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move import paper
from move.figures.decided import FIRST_SEED
from move.figures.fig1_sparse import MAPS, from_grasps, grasp_runs
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

PLACES = {"point": "nine places", "near": "within 3 cm", "far": "beyond 5 cm", "grid": "whole space"}
"""Where it is tried: at the grasp points, or at the places of the grid that are near one of them, far from all, any."""


def runs(profile: Profile, seeds: Repeats = 10, timesteps: Count = 7000, grid_side: Count = 15) -> list[LabelledRun]:
    """Static at nine points, the hand anywhere: new seeds for claims 11 and 13 at figure 1's places and hand starts."""
    return grasp_runs(profile, "sparse", "rgb", "anywhere", seeds, grid_side, timesteps, methods=("static",),
                      first_seed=FIRST_SEED)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Success at the nine places, near them, far from them, anywhere, once the last run is there (`decided.tables`)."""
    episodes = data.episodes[:0] if data.missing else data.episodes
    gridded, apart = episodes.group == "grid", from_grasps(episodes)
    groups = {"point": ~gridded, "near": gridded & (apart <= 0.03), "far": gridded & (apart > 0.05), "grid": gridded}
    rows = pd.concat([episodes[chosen].assign(group=name) for name, chosen in groups.items()])
    return {"": rate_table(rows, ["group", "method"], data.noise(grid=True))}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """A map of the seeds that succeed, and the rates against half of the episodes."""
    figure, axes = plt.subplots(1, 2, figsize=(COLUMN_WIDTH, 2.4), width_ratios=[1, 0.8])
    rates = tables[""].set_index("group").reindex(list(PLACES))
    if rates.value.isna().any():
        for ax in axes:
            empty_panel("missing", ax)
        return figure
    maps.seeds_bar(maps.heatmap(data.episodes, axes[0]), [axes[0]], data.episodes.seed.nunique())
    rate_points(range(len(rates)), rates, "static", axes[1])
    axes[1].axhline(0.5, color="black", lw=0.8, ls="--")
    (printed,) = paper.published("fig1_sparse", method="static").value
    last = len(rates) - 1  # the whole space
    axes[1].plot([last - 0.3, last + 0.3], [printed, printed], **PRINTED)
    axes[1].set_xticks(range(len(rates)), list(PLACES.values()), rotation=90)
    axes[1].set_xlim(-0.5, len(rates) - 0.5)
    success_axis(axes[1])
    titles(axes, ["static", "success"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The rates with their intervals."""
    each = "; ".join(f"{PLACES[row.group]} {row.value:.0%} [{row.low:.0%}, {row.high:.0%}]"
                     for row in tables[""].itertuples())
    return ("**The paper:** trained at nine places, static performs well there (claim 13), and only around them (11), "
            f"in 29.5 % of the space. **Here**, with new seeds: {each or 'nothing is complete yet'}. **How sure:** "
            f"{data.sample_size}")


WORDS = Words(
    title="Static at nine places, with new seeds",
    shown=(f"(a) Static, {MAPS} Rings are the nine grasp points. (b) Success at these points, at the places of the map "
           f"within 3 cm of one and beyond 5 cm of all, and over the whole space; dashed is half, above which a claim "
           f"says that a policy succeeds, dotted the paper's value. {INTERVALS}"),
    alt="A map of a space of 30 by 30 cm, coloured by success, and four rates with their intervals.",
    tables={"": f"Static at nine places, with new seeds. {RATES}"},
)

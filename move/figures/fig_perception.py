"""Figures 1, 3 and 5 and table 1 from pixels and with perception given: what is left of the effect?"""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots, table1_spatial_factors
from move.figures.fig1_sparse import PRELIMINARY, grasp_runs
from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Observation, Repeats
from move.figures.plots.panels import SEEN, methods_and_seeds
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import counts_text, difference_table, joined
from move.study.labels import LabelledRun
from move.study.profiles import Profile

REPEATED = True
BY = ["observation", "experiment", "method"]


def runs(
    profile: Profile, timesteps: Count = 7000, table_timesteps: Count = 20_000, seeds: Repeats = 3,
    grid_side: Count = 15, episodes: Count = 100, observations: tuple[Observation, ...] = ("rgb", "keypoints"),
) -> list[LabelledRun]:
    """The runs of those figures, whose label `experiment` is such as "figure 1" or "table 1, all".

    Observations without a recipe in the profile are left out.
    """
    runs: list[LabelledRun] = []
    for observation in observations:
        for name, protocol in PRELIMINARY.items():
            runs += [run.labelled(experiment=name) for run in grasp_runs(
                profile, protocol, observation, "anywhere", seeds, grid_side, timesteps)]
        runs += [run.labelled(experiment=f"table 1, {run.labels['factors']}") for run in table1_spatial_factors.runs(
            profile, observation=observation, timesteps=table_timesteps, seeds=seeds, episodes=episodes)]
    return runs


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates, and for each observation MOVE minus static in every experiment."""
    tried = data.episodes[data.episodes.group != "point"]  # elsewhere than at the grasp points of the data
    on_grid = tried.experiment.str.startswith("figure")  # where trainings differ more than in table 1
    parts = [(seen, rows, data.noise(seen, grid))
             for (seen, grid), rows in tried.groupby([tried.observation, on_grid], sort=False)]
    compared = {seen: joined([difference_table(rows, "experiment", noise)
                              for other, rows, noise in parts if other == seen])
                for seen in tried.observation.unique()}
    return {"": pd.concat([rate_table(rows, BY, noise) for _, rows, noise in parts]),
            **{f"differences_{seen}": table for seen, table in compared.items()}}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Static next to MOVE in several experiments, from pixels and from keypoints."""
    rates = data.with_missing(tables[""], BY)
    kinds = list(rates.observation.unique())
    figure, axes = plt.subplots(1, len(kinds), figsize=(PAGE_WIDTH, 2.6), sharey=True, squeeze=False)
    for ax, kind in zip(axes.flat, kinds, strict=True):
        rows = rates[rates.observation == kind]
        labels = [name.replace(", ", "\n").replace("+", "\n+ ") for name in rows.experiment.unique()]
        plots.grouped_rates(rows.assign(paper=np.nan), "experiment", labels, ax)
        ax.set_ylabel("success (%)" if ax is axes[0, 0] else "")
    titles(list(axes.flat), [SEEN[kind] for kind in kinds])
    methods_and_seeds(figure, rates)
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """In how many experiments MOVE minus static is above or below 0, from pixels and from keypoints."""
    names = {"rgb": "from pixels", "keypoints": "from keypoints"}
    each = "; ".join(f"{names[seen]} {counts_text(tables[f'differences_{seen}'])}" for seen in names
                     if f"differences_{seen}" in tables)
    return (f"**The paper** has no results from keypoints. **Here**, MOVE minus static by experiment: {each}. "
            f"**How sure:** after Holm's adjustment. {data.sample_size}")


WORDS = Words(
    title="What is left when perception is given",
    shown=(
        f"Success in figures 1, 3 and 5 and in table 1 away from the demonstrations' own grasp points, (a) from pixels "
        f"and (b) from keypoints. {INTERVALS} White dots are single seeds."),
    alt="Two panels of bars, static beside MOVE in each experiment.",
    tables={
        "": f"Figures 1, 3 and 5 and table 1, from pixels and from keypoints. {RATES}",
        "differences_rgb": f"Figures 1, 3 and 5 and table 1, from pixels. {DIFFERENCES}",
        "differences_keypoints": (
            "Figures 1, 3 and 5 and table 1, from keypoints, perception given. "
            f"{DIFFERENCES}"),
    },
)

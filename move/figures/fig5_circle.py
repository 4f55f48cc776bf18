"""Figure 5: twenty grasp points on a circle, motion inside it; success inside and outside of the circle."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move import paper
from move.figures.fig1_sparse import MAPS, STARTS, by_hand, grasp_runs, success_maps
from move.figures.page.captions import COSTS, DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Observation, Repeats, Seeds
from move.figures.page.printed import readable
from move.figures.plots import maps
from move.figures.plots.panels import empty_panel, key_under
from move.figures.plots.style import NAMES, PAGE_WIDTH, titles
from move.figures.tables import rate_table, rates_text, run_costs, with_paper
from move.figures.tables.differences import differences_at, verdicts_text, with_verdicts
from move.sim.grasp_points import CIRCLE
from move.statistics.cells import inside_and_outside
from move.study.labels import LabelledRun
from move.study.profiles import Profile

REPEATED = True


def runs(
    profile: Profile, observation: Observation = "rgb", timesteps: Count = 7000, seeds: Repeats = 3,
    near_hands: Seeds = 5, identical_starts: Seeds = 3, grid_side: Count = 15, earlier_grid_side: Count = 12,
) -> list[LabelledRun]:
    """Both methods, tried on a grid over the object space, in and out of the circle."""
    grasps = partial(grasp_runs, profile, "circle", observation, timesteps=timesteps)
    return [*grasps("anywhere", seeds, grid_side), *grasps("within 3 cm", near_hands, earlier_grid_side),
            *grasps("one place", identical_starts, earlier_grid_side)]


def tables(data: Data, *, observation: str) -> dict[str, pd.DataFrame]:
    """Rates inside and outside, at the points, by the hand's start; differences; costs."""
    noise = data.noise(observation, grid=True)
    episodes = data.episodes[data.episodes.hand == "anywhere"]
    everywhere = inside_and_outside(data.episodes, CIRCLE)
    grid, on = everywhere[everywhere.hand == "anywhere"], ["where", "method"]
    return {
        "": with_paper(rate_table(grid, ["where", "method"], noise), "fig5_circle", on=on),
        "points": rate_table(episodes[episodes.group == "point"], ["method"], noise),
        "hand": with_paper(rate_table(everywhere, ["where", "hand", "method"], noise), "fig5_circle", on=on),
        "differences": differences_at(everywhere, "hand", "where", noise),
        "costs": run_costs(data.results),
    }


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """The differences with their verdicts."""
    return {"differences": readable(_with_verdicts(tables))}


def _with_verdicts(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    compared = with_paper(tables["differences"], "fig5_circle", ["where", "baseline"], "difference")
    return with_verdicts(compared, tables["hand"], ["where", "hand"])


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Two maps with the circle over them, and the rates inside and outside of it by where the hand starts."""
    figure, axes = plt.subplots(1, 4, figsize=(PAGE_WIDTH, 2.1), width_ratios=[1, 1, 0.8, 0.8])
    success_maps(data.episodes[data.episodes.hand == "anywhere"], axes[:2])
    for ax in axes[:2]:
        if ax.axison:  # there is a map
            maps.circle(CIRCLE, ax)
    if axes[0].axison:
        key_under(axes[0], maps.GRASP_POINT)
    rates = data.with_missing(tables["hand"], ["hand", "method"])
    for ax, where in zip(axes[2:], ("inside", "outside"), strict=True):
        rows = rates[(rates["where"] == where) | rates["where"].isna()]  # NaN: both are missing
        if rows.empty:
            empty_panel(f"no place {where}\nwas tried", ax)
        else:
            by_hand(rows, ax)
    axes[3].set_ylabel("")
    titles(axes, ["static", "MOVE", "inside", "outside"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The paper's rates inside and outside, the differences with hands anywhere, and the rates at the points."""
    theirs = "; ".join(f"{where} {rates_text(rows)}" for where, rows in
                       paper.published("fig5_circle", "success").groupby("condition", sort=False))
    compared = _with_verdicts(tables)
    own = ", ".join(f"{NAMES[row.method]} {row.value:.0%}" for row in tables["points"].itertuples())
    return (
        f"**The paper:** {theirs}. **Here**, MOVE minus static in points, hands anywhere: "
        f"{verdicts_text(compared[compared.hand == 'anywhere'], 'where')}. At the twenty points: "
        f"{own or 'not computed yet'}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Figure 5. Grasp points on a circle: inside and outside",
    shown=(
        f"(a, b) Static and MOVE, {MAPS} Rings are the twenty grasp points on the dashed circle, filled with their "
        f"own success. (c, d) Success inside and outside of the circle by where the hand starts: {STARTS} {INTERVALS} "
        f"White dots are single seeds, dotted lines the paper's values."),
    alt="Two maps of a space of 30 by 30 cm with a circle, coloured by success, and a bar chart.",
    tables={
        "": f"Figure 5: inside and outside of the circle. {RATES}",
        "points": f"Figure 5: at the twenty grasp points themselves. {RATES}",
        "differences": f"Figure 5: inside and outside of the circle. {DIFFERENCES}",
        "hand": f"Figure 5, by where the hand starts. {RATES}",
        "costs": f"Figure 5. {COSTS}",
    },
)

"""Figure 3: a grasp point of its own for every demonstration, the same for static and MOVE; smaller budgets too."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move import paper
from move.figures import plots
from move.figures.fig1_sparse import COMPARED, MAPS, STARTS, by_hand, grasp_runs, success_maps
from move.figures.page.captions import COSTS, DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Counts, Observation, Repeats, Seeds
from move.figures.page.printed import readable
from move.figures.plots import maps
from move.figures.plots.panels import key_under, legend_below
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import grasp_points, rate_table, rates_text, run_costs, with_paper
from move.figures.tables.differences import difference_table, verdicts_text, with_verdicts
from move.study.labels import LabelledRun
from move.study.profiles import Profile

REPEATED = True


def runs(
    profile: Profile, observation: Observation = "rgb", timesteps: Counts = (7000, 3500, 2000), seeds: Repeats = 3,
    near_hands: Seeds = 3, identical_starts: Seeds = 3, grid_side: Count = 15, earlier_grid_side: Count = 12,
) -> list[LabelledRun]:
    """Both methods at each budget of `timesteps`, tried on a grid.

    With the hand always in one place, as in figure 1, at the first budget alone.
    """
    grasps = partial(grasp_runs, profile, "dense", observation)
    runs = [run for budget in timesteps for run in (
        *grasps("anywhere", seeds, grid_side, timesteps=budget),
        *grasps("within 3 cm", near_hands, earlier_grid_side, timesteps=budget))]
    return [*runs, *grasps("one place", identical_starts, earlier_grid_side, timesteps=timesteps[0])]


def tables(data: Data, *, observation: str, timesteps: tuple[int, ...]) -> dict[str, pd.DataFrame]:
    """Rates and differences at the first budget, by the hand's start, and by budget; costs."""
    noise = data.noise(observation, grid=True)
    budgets, near = (data.episodes[data.episodes.hand == hand] for hand in ("anywhere", "within 3 cm"))
    everywhere = data.episodes[data.episodes.timesteps == timesteps[0]]
    first = budgets[budgets.timesteps == timesteps[0]]
    compared = difference_table(everywhere, "hand", noise)
    return {
        "": with_paper(rate_table(first, ["method"], noise), "fig3_dense", on=["method"]),
        "hand": with_paper(rate_table(everywhere, ["hand", "method"], noise), "fig3_dense", on=["method"]),
        "difference": with_paper(compared, "fig3_dense", ["baseline"], "difference"),
        "budgets": rate_table(budgets, ["timesteps", "method"], noise),
        "budgets_difference": difference_table(budgets, "timesteps", noise),
        "near_budgets": rate_table(near, ["timesteps", "method"], noise),
        "near_budgets_difference": difference_table(near, "timesteps", noise),
        "costs": run_costs(data.results),
    }


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """The differences with their verdicts."""
    return {"difference": readable(with_verdicts(tables["difference"], tables["hand"], ["hand"]))}


def draw(tables: dict[str, pd.DataFrame], data: Data, *, timesteps: tuple[int, ...]) -> Figure:
    """Two maps with the grasps over them, the rates by where the hand starts, and the rates at smaller budgets."""
    episodes = data.episodes[(data.episodes.hand == "anywhere") & (data.episodes.timesteps == timesteps[0])]
    grasped = grasp_points([result for result in data.results if result.spec.hash in set(episodes.run)])
    figure, axes = plt.subplots(1, 4, figsize=(PAGE_WIDTH, 2.1), width_ratios=[1, 1, 0.9, 0.8])
    success_maps(episodes, axes[:2])
    shown = [(ax, method) for ax, method in zip(axes, COMPARED, strict=False) if ax.axison]  # where there is a map
    for ax, method in shown:
        maps.grasps(grasped[grasped.method == method], ax)
    for ax, _ in shown[:1]:
        key_under(ax, maps.GRASP)
    by_hand(data.with_missing(tables["hand"], ["hand", "method"]), axes[2])
    by_budget = data.with_missing(tables["budgets"], ["timesteps", "method"])
    plots.curve(by_budget, "timesteps", "timesteps", axes[3], log=True)
    axes[3].set_ylabel("")
    legend_below(axes[3], lines=3)
    titles(axes, ["static", "MOVE", "by the hand's start", "by budget"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The paper's rates, and the differences here by the hand's start with verdicts."""
    compared = with_verdicts(tables["difference"], tables["hand"], ["hand"])
    return (
        f"**The paper:** {rates_text(paper.published('fig3_dense', 'success'))}. **Here**, MOVE minus static in "
        f"points, by the hand's start: {verdicts_text(compared, 'hand')}. **How sure:** near the ceiling none can "
        f"lead. {data.sample_size}")


WORDS = Words(
    title="Figure 3. Grasp points everywhere",
    shown=(
        f"(a, b) Static and MOVE, {MAPS} Small dots are where the demonstrations of all seeds grasped. (c) Success "
        f"over the whole space by where the hand starts: {STARTS} White dots are single seeds, dotted lines the "
        f"paper's values. (d) Success at smaller budgets, hands anywhere. {INTERVALS}"),
    alt="Two maps of a space of 30 by 30 cm, coloured by success, a bar chart and two curves over the budget.",
    tables={
        "": f"Figure 3: grasp points everywhere, the whole space. {RATES}",
        "difference": f"Figure 3: the whole space. {DIFFERENCES}",
        "budgets": f"Figure 3: smaller budgets. {RATES}",
        "budgets_difference": f"Figure 3: smaller budgets. {DIFFERENCES}",
        "hand": f"Figure 3, by where the hand starts. {RATES}",
        "near_budgets": f"Figure 3: smaller budgets, hands within 3 cm. {RATES}",
        "near_budgets_difference": f"Figure 3: smaller budgets, hands within 3 cm. {DIFFERENCES}",
        "costs": f"Figure 3. {COSTS}",
    },
)

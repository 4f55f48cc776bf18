"""Figure 1: nine grasp points, static against MOVE, equal timesteps; success over the whole 30 x 30 cm object space.

Figures 3 and 5 and `few_demonstrations` take from here what they share: where the hand starts, the runs over grasp
points, maps, and the panel of the hand's start.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from move import paper
from move.figures import plots
from move.figures.page.captions import COSTS, DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Multiple, Observation, Repeats, Seeds
from move.figures.page.printed import readable
from move.figures.plots import maps
from move.figures.plots.panels import empty_panel, key_under, legend_below, seed_dot
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table, rates_text, run_costs, with_paper
from move.figures.tables.differences import difference_table, verdicts_text, with_verdicts
from move.learn.evaluation import Evaluation
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

REPEATED = True
COMPARED = ("static", "move")
PRELIMINARY = {"figure 1": "sparse", "figure 3": "dense", "figure 5": "circle"}
"""Figures over grasp points, and how these are placed."""
TRACED_BACK = 35  # steps before its grasp from which MOVE's object comes, as in the authors' code
HAND_LENGTH = 1.0
"""Gradient steps of figures 1, 3 and 5 where the hand starts anywhere, as a multiple of the recipe's; for both methods.

The rule: the least of 1, 2 and 3 at which static succeeds in at least 95 % of 60 of its own configurations with each
of two seeds, or 3 if there is none. MOVE has no say in it (`runs`, whose label `length` is that multiple). At 1 both
seeds succeeded in 58 of 60, so nothing longer was tried."""

ANYWHERE: dict[str, Any] = {"factors": "object+hand", "fixed": "authors"}
HANDS: dict[str, dict[str, Any]] = {
    "anywhere": ANYWHERE,
    "within 3 cm": {"factors": "object", "hand_spread": 0.03},
    "one place": {"factors": "object", "hand_spread": 0.0},
}
"""Where the hand starts in the demonstrations of figures 1, 3 and 5.

Anywhere is as in the authors' code: in the evaluation too, with their camera and target, and with MOVE's object traced
back over their 35 steps. The others are this package's earlier ones: tried with the hand in one place, camera on the
other side, 30 steps. Where it starts in one place, the static demonstrations of a point are all the same.
"""


def runs(
    profile: Profile, observation: Observation = "rgb", timesteps: Count = 7000, seeds: Repeats = 3,
    near_hands: Seeds = 5, identical_starts: Seeds = 3, grid_side: Count = 15, earlier_grid_side: Count = 12,
    lengths: tuple[Multiple, ...] = (1,), length_seeds: Seeds = 2, own_episodes: Count = 60,
) -> list[LabelledRun]:
    """Both methods at nine points, tried on a grid.

    The hand starts anywhere (`seeds`), within 3 cm of its place (`near_hands`) or in one place (`identical_starts`).
    Static at its own configurations says how long to train (`HAND_LENGTH`).
    """
    grasps = partial(grasp_runs, profile, "sparse", observation, timesteps=timesteps)
    runs = [*grasps("anywhere", seeds, grid_side), *grasps("within 3 cm", near_hands, earlier_grid_side),
            *grasps("one place", identical_starts, earlier_grid_side)]
    own = Evaluation(starts="own", episodes=own_episodes)
    return runs + [run.tried(own) for length in lengths
                   for run in grasps("anywhere", length_seeds, grid_side, methods=("static",), length=length)]


def grasp_runs(
    profile: Profile, protocol: str, observation: str, hand: str, seeds: int, grid_side: int, timesteps: int,
    methods: tuple[str, ...] = COMPARED, length: float = HAND_LENGTH, first_seed: int = 0,
) -> list[LabelledRun]:
    """Pick-Place with grasp points of `protocol`, tried on a grid and at the points; labels timesteps, hand, length.

    Args:
        hand: where it starts, one of `HANDS`.
        length: gradient steps as a multiple of the recipe's, where the hand starts anywhere.
    """
    points = "none" if protocol == "dense" else protocol  # dense: every demonstration has a point of its own
    base = partial(policy_run, profile, task="pick-place", observation=observation, protocol=protocol, starts="grid",
                   grid_side=grid_side, points=points)
    anywhere = hand == "anywhere"
    if anywhere:
        base = partial(base, length=length)
    traced = {"move": {"object_steps": TRACED_BACK}} if anywhere else {}
    return grid(base, timesteps=[timesteps], hand={hand: HANDS[hand]}, length={length: {}},
                seed=range(first_seed, first_seed + seeds),
                method={method: {"method": method, **traced.get(method, {})} for method in methods})


def from_grasps(episodes: pd.DataFrame) -> np.ndarray:
    """Metres from each episode's object to the nearest grasp point, where `group` is "point"; NaN if there is none."""
    places = episodes[["object_x", "object_y"]].to_numpy()
    points = np.unique(places[(episodes.group == "point").to_numpy()], axis=0)
    if not len(points):
        return np.full(len(places), np.nan)
    return np.linalg.norm(places[:, None] - points[None], axis=2).min(axis=1)


def tables(data: Data, *, observation: str) -> dict[str, pd.DataFrame]:
    """Rates over the whole space, at the points, by the hand's start and by length of training; differences; costs."""
    noise = data.noise(observation, grid=True)
    tried = data.episodes[data.episodes.hand == "anywhere"]
    whole, points, own = (tried[tried.group == group] for group in ("grid", "point", "own"))
    everywhere = data.episodes[data.episodes.group == "grid"]
    compared = difference_table(everywhere, "hand", noise)
    return {
        "": with_paper(rate_table(whole, ["method"], noise), "fig1_sparse", on=["method"]),
        "points": rate_table(points, ["method"], noise),
        "hand": with_paper(rate_table(everywhere, ["hand", "method"], noise), "fig1_sparse", on=["method"]),
        "difference": with_paper(compared, "fig1_sparse", ["baseline"], "difference"),
        "length": rate_table(own, ["length", "method"], noise),
        "costs": run_costs(data.results),
    }


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """The differences with their verdicts."""
    return {"difference": readable(with_verdicts(tables["difference"], tables["hand"], ["hand"]))}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Two maps, their difference, and the rates over the whole space by where the hand starts."""
    figure, axes = plt.subplots(1, 4, figsize=(PAGE_WIDTH, 2.1), width_ratios=[1, 1, 1, 1])
    episodes = data.episodes[data.episodes.hand == "anywhere"]
    success_maps(episodes, axes[:2])
    difference_map(episodes, axes[2])
    if axes[0].axison:  # there is a map
        key_under(axes[0], maps.GRASP_POINT)
    by_hand(data.with_missing(tables["hand"], ["hand", "method"]), axes[3])
    titles(axes, ["static", "MOVE", "b \N{MINUS SIGN} a", "whole space"])
    return figure


def success_maps(episodes: pd.DataFrame, axes: Sequence[Axes]) -> None:
    """One map a method with one colour bar; a method that has none on the grid leaves its panel empty and says so."""
    mesh = None
    for ax, method in zip(axes, COMPARED, strict=True):
        rows = episodes[episodes.method == method]
        if (rows.group == "grid").any():
            mesh = maps.heatmap(rows, ax)
            ax.set_anchor("N")
        else:
            empty_panel("missing", ax)
    axes[1].set_ylabel("")
    if mesh is not None:
        maps.seeds_bar(mesh, axes, episodes.seed.nunique())


def difference_map(episodes: pd.DataFrame, ax: Axes) -> None:
    """MOVE minus static, cell by cell, with its colour bar; an empty panel where one of them has no map."""
    gridded = episodes[episodes.group == "grid"]
    if set(gridded.method) < set(COMPARED):
        empty_panel("missing", ax)
        return
    seeds = episodes.seed.nunique()
    mesh = maps.difference(gridded, ax)
    ax.set_anchor("N")
    ax.set_ylabel("")
    maps.seeds_bar(mesh, [ax], seeds, -seeds, "more seeds with MOVE")


def by_hand(rates: pd.DataFrame, ax: Axes) -> None:
    """Static next to MOVE by where the hand starts; rates as `plots.grouped_rates` takes them, with the column hand."""
    names = {"anywhere": "any-\nwhere", "within 3 cm": "within\n3 cm", "one place": "one\nplace"}
    plots.grouped_rates(rates, "hand", [names[hand] for hand in rates.hand.unique()], ax)
    legend_below(ax, [seed_dot()], 2, lines=2)


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The paper's rates, the differences here by the hand's start with verdicts, and the rates at the points."""
    compared = with_verdicts(tables["difference"], tables["hand"], ["hand"])
    return (
        f"**The paper:** whole space {rates_text(paper.published('fig1_sparse', 'success'))}. **Here**, MOVE minus "
        f"static in points, by the hand's start: {verdicts_text(compared, 'hand')}. At the nine points: "
        f"{rates_text(tables['points'])}. **How sure:** {data.sample_size}")


MAPS = ("seen from above: a cell is one place of the object, its colour the number of seeds whose policy succeeds "
        "there; the robot's base is below the map, at x = 0, y = 0.")
STARTS = ("anywhere in its range in training and evaluation (the maps; the authors' camera, target and 35 traced-back "
          "steps), within 3 cm of its place in training, or always in one place, so that static's demonstrations of a "
          "point are all alike (both: this package's earlier camera and target).")

WORDS = Words(
    title="Figure 1. Nine grasp points: success over the places between",
    shown=(
        f"(a, b) Static and MOVE, {MAPS} Rings are the nine grasp points, filled with their own success. "
        f"(c) In how many seeds more MOVE succeeds there than static. (d) Success over the whole space by "
        f"where the hand starts: {STARTS} {INTERVALS} White dots are single seeds, dotted lines the paper's values."),
    alt="Two maps of a space of 30 by 30 cm, coloured by success, a map of their difference, and a bar chart.",
    tables={
        "": f"Figure 1: nine grasp points, the whole space. {RATES}",
        "points": f"Figure 1: at the nine grasp points themselves. {RATES}",
        "difference": f"Figure 1: the whole space. {DIFFERENCES}",
        "hand": f"Figure 1, by where the hand starts. {RATES}",
        "length": f"Figure 1: static at its own configurations, by length of training. {RATES}",
        "costs": f"Figure 1. {COSTS}",
    },
)

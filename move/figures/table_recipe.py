"""The laptop's recipe for images, and what each part of it is worth: one change at a time, static alone."""

from __future__ import annotations

from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Multiple
from move.figures.plots.style import PAGE_WIDTH, titles
from move.learn.evaluation import Evaluation
from move.statistics.estimates import difference, success_rate
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, distinct, grid
from move.study.profiles import Profile

RECIPE_CHANGES: dict[str, dict[str, Any]] = {
    "chosen": {},
    "one noise level a window": {"noise_draws": 1},
    "spatial softmax starts flat": {"softmax_gain": 1.0},
    "encoder learns from all frames": {"learning_frames": None},
    "32 channels": {"cnn_width": 32},
    "learning rate 1e-3": {"learning_rate": 1e-3},
    "learning rate 3e-3": {"learning_rate": 3e-3},
}
"""What the recipe for images was measured against: one change at a time."""


def runs(
    profile: Profile, timesteps: tuple[Count, ...] = (7000, 20_000), episodes: Count = 60,
    lengths: tuple[Multiple, ...] = (2 / 3, 3),
) -> list[LabelledRun]:
    """One training a change, tried at the configurations that it learnt from; nothing here compares methods.

    The last runs of each budget train for the recipe's gradient steps times each of `lengths`; the label `change` says
    what is other. A profile whose policy is not the small CNN has no `timesteps` for it.
    """
    changes = RECIPE_CHANGES | {f"{length:.2g} times as long": {"length": length} for length in lengths}
    runs: list[LabelledRun] = []
    for budget in timesteps:
        protocol, factors = ("sparse", "object") if budget == min(timesteps) else ("random", "all")
        base = partial(policy_run, profile, task="pick-place", method="static", seed=0, protocol=protocol,
                       factors=factors)
        runs += grid(base, timesteps=[budget], change=changes)
    own = Evaluation(starts="own", episodes=episodes)
    return distinct(run.tried(own) for run in runs)  # a change may be none in this profile


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """One row a run: what was changed, minutes of training, success at its own places.

    Columns timesteps, change, train_minutes (one core), loss (mean of the last fiftieth of the steps), value, low,
    high, episodes; gain, gain_low, gain_high: success minus the chosen recipe's, paired, NaN where that is missing.
    """
    runs = [(result, result.labels["timesteps"], result.labels["change"]) for result in data.results]
    chosen = {timesteps: result.successes[None] for result, timesteps, change in runs if change == "chosen"}
    rows = []
    for result, timesteps, change in runs:
        training = result.training or {"curve": [[0, np.nan]]}
        outcomes = result.successes[None]
        rate = success_rate(outcomes)
        found = difference(outcomes, chosen[timesteps]) if timesteps in chosen else None
        gain = (found.value, found.low, found.high) if found else (np.nan,) * 3
        rows.append({"timesteps": timesteps, "change": change,
                     "train_minutes": result.seconds["train"] / 60, "loss": training["curve"][-1][1],
                     "value": rate.value, "low": rate.low, "high": rate.high, "episodes": rate.episodes,
                     **dict(zip(("gain", "gain_low", "gain_high"), gain, strict=True))})
    return {"": pd.DataFrame(rows)}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """For each budget the recipe's success with one change at a time, and what each change gains."""
    budgets = list(tables[""].groupby("timesteps", sort=False))
    figure, axes = plt.subplots(1, 2 * len(budgets), figsize=(PAGE_WIDTH, 2.3), squeeze=False)
    texts: list[str] = []
    named: list[str] | None = None
    for number, (budget, rows) in enumerate(budgets):
        success, gain = axes[0, 2 * number:2 * number + 2]
        plots.changes(rows, success)
        plots.gains(rows, gain)
        gain.tick_params(labelleft=False)
        success.tick_params(labelleft=list(rows.change) != named)  # the same changes are named once
        named, texts = list(rows.change), [*texts, f"{plots.short(budget)} timesteps", "gain"]
    titles(list(axes.flat), texts)
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The chosen recipe of each budget: minutes, success at its own configurations."""
    rows = tables[""][tables[""].change == "chosen"]
    each = "; ".join(
        f"{row.timesteps:,} timesteps, {row.change}: {row.train_minutes:.1f} minutes of training, {row.value:.0%} "
        f"[{row.low:.0%}, {row.high:.0%}] of its own configurations" for row in rows.itertuples())
    return (
        f"**The paper** trains a larger network for 220,000 steps. **Here:** {each or 'nothing is computed yet'}. "
        f"**How sure:** one training a line; intervals count episodes alone. {data.sample_size}")


WORDS = Words(
    title="The laptop's recipe for images, and what each part of it is worth",
    shown=(
        "Static alone, one training a line, tried at configurations that its own demonstrations began with. Left of "
        "each pair: success; right: success minus the chosen recipe's, paired, with the minutes of training. Error "
        "bars are 95 % intervals that know about the episodes alone."),
    alt="Four panels of points with intervals, one line a change of the recipe.",
    tables={
        "": (
            "The recipe for images with one change at a time: minutes and loss of training, success in per "
            "cent at its own configurations, and the gain over the chosen recipe in points."),
    },
)

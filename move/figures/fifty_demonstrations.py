"""What should fifty demonstrations be? Few places many times, many places once, or motion over either."""

from __future__ import annotations

from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from move.choices import PlacementRule
from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Counts, Observation, Repeats, TaskName
from move.figures.plots.axes import errors, log_ticks, success_axis
from move.figures.plots.style import COLOURS, PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import variant_table
from move.figures.tables.ranks import RANKS, ranks
from move.paths import ROOT
from move.sim.placement import Placement
from move.sim.tasks import TASKS
from move.statistics.cells import successes, training_noise
from move.statistics.data_efficiency import data_efficiency
from move.statistics.training_noise import UNKNOWN, TrainingNoise
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile
from move.study.results import Result

REPEATED = True
BY = ["task", "equal", "demonstrations", "arm", "method"]
SPREAD = 0.03  # metres: the hand's start differs, or all demonstrations of a place would be alike
STEPS = 72  # timesteps of a static demonstration, mean of both tasks to two; MOVE's have about 90
MOST_STEPS = 200  # of any demonstration

ARMS: dict[str, tuple[str, PlacementRule, int]] = {
    "5 places": ("static", "jittered", 5),
    "10 places": ("static", "jittered", 10),
    "each its own, random": ("static", "random", 0),
    "each its own, jittered grid": ("static", "jittered", 0),
    "each its own, Halton": ("static", "halton", 0),
    "MOVE, 5 places": ("move", "jittered", 5),
    "MOVE, random": ("move", "random", 0),
}
"""Method, rule, and number of places of each arm; 0: as many as demonstrations."""

COPIED, SPREAD_OUT = "5 places", "each its own, random"
ASKED = {COPIED: (SPREAD_OUT,), "MOVE, 5 places": (COPIED, SPREAD_OUT), "MOVE, random": (COPIED, SPREAD_OUT)}
"""Whose episodes are counted, and whose success at the middle number of episodes they are to match.

Committed before any of these runs: the answer is the first factor, 5 places against random places of their own. It is
decided above or below 1 where its 95 % interval is."""

PREDICTED = ROOT / "results" / "predicted.csv"  # of Push, by tools/predict_order.py, committed before these runs
SAME_ORDER = 0.8  # Spearman's correlation of the arms' predicted and measured rates from which the order is predicted


def runs(
    profile: Profile, task: TaskName = "pick-place", observation: Observation = "rgb",
    demonstrations: Counts = (25, 50, 100), seeds: Repeats = 3, grid_side: Count = 15, other_task: TaskName = "push",
    other_demonstrations: Counts = (50,),
) -> list[LabelledRun]:
    """Each arm with so many demonstrations, and MOVE's with static's timesteps besides; the object alone is random.

    All are trained as long, by the recipe of 7,000 timesteps. The labels `equal`, `demonstrations` and `arm` say what
    is equal, to how many static demonstrations, and how they are placed.
    """
    found: list[LabelledRun] = []
    for name, counts in ((task, demonstrations), (other_task, other_demonstrations)):
        for count in counts:
            base = partial(
                policy_run, profile, task=name, observation=observation, factors="object", protocol="placed",
                hand_spread=SPREAD, hand_within=SPREAD, starts="grid", grid_side=grid_side,
                gradient_steps=profile.recipe(observation, 7000).gradient_steps)
            for equal in ("demonstrations", "timesteps"):
                found += grid(base, seed=range(seeds), task=[name], equal={equal: {}}, demonstrations={count: {}},
                              arm={arm: _arm(arm, equal, count) for arm in ARMS})
    return found


def _arm(arm: str, equal: str, count: int) -> dict[str, Any]:
    method, rule, places = ARMS[arm]
    made = {"method": method, "placement": Placement(rule=rule, places=places or count)}
    if equal == "timesteps" and method == "move":
        return {**made, "timesteps": STEPS * count}
    return {**made, "timesteps": MOST_STEPS * count, "demonstrations": count}


def tables(data: Data, *, observation: str) -> dict[str, pd.DataFrame]:
    """Rates, each arm against five places, and how many times the episodes an arm needs for another's success."""
    noise = data.noise(observation, grid=True)
    rates = rate_table(data.episodes, BY, noise)
    return {
        "": rates,
        "differences": variant_table(data.episodes, BY[:3], "arm", lambda _: [
            (arm, COPIED) for arm in ARMS if arm != COPIED], noise),
        "factors": factors_table(data.episodes, noise),
        "predicted": (predicted := predicted_table(rates, data.results)),
        "ranks": ranks_table(predicted),
    }


def predicted_table(rates: pd.DataFrame, results: list[Result]) -> pd.DataFrame:
    """What the radius said of each arm on the other task before it was tried, and what came of it.

    `spread` is what other tools score: the standard deviation of the places of the grasps, in metres.
    """
    columns = [*BY[:4], "predicted", "spread", "value", "low", "high"]
    if rates.empty or not PREDICTED.exists():
        return pd.DataFrame(columns=columns)
    spread = pd.DataFrame([{**{name: result.labels[name] for name in BY[:4]}, "spread": _spread(result)}
                           for result in results]).groupby(BY[:4], as_index=False).mean()
    return pd.read_csv(PREDICTED).merge(rates, on=BY[:4]).merge(spread, on=BY[:4])[columns]


def _spread(result: Result) -> float:
    assert result.collection is not None
    return float(np.sqrt(np.var(result.collection["grasp_points"], axis=0).sum()))


def ranks_table(predicted: pd.DataFrame) -> pd.DataFrame:
    """How well two scores order the arms of a task of which neither knew a rate; each arm is left out in turn."""
    scores = {"distance to what was seen": "predicted", "spread of grasps": "spread"}
    rows = [{"task": task, "equal": equal, **row}
            for (task, equal), arms in predicted.groupby(["task", "equal"], sort=False) if len(arms) == len(ARMS)
            for row in ranks(arms, scores, arms.arm.to_numpy())]
    return pd.DataFrame(rows, columns=["task", "equal", *RANKS])


def factors_table(episodes: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """One arm's episodes over another's for the other's success at the middle number, where three numbers are tried.

    `equal` says whether episodes are counted, or timesteps in units of a static episode.
    """
    noise, rows = training_noise(episodes, BY, known), []
    for (task, equal), tried in episodes.groupby(["task", "equal"], sort=False):
        curves = {arm: {int(count): successes(cell) for count, cell in rows_of.groupby("demonstrations")}
                  for arm, rows_of in tried.groupby("arm", sort=False)}
        for arm, others in ASKED.items():
            for other in others:
                counts = sorted(curves.get(other, {}))
                middle = counts[len(counts) // 2] if counts else 0
                if len(counts) > 2 and len(curves.get(arm, {})) > 2:
                    found = data_efficiency(curves[arm], curves[other], middle, noise)
                    rows.append({"task": task, "equal": equal, "arm": arm, "other": other, "episodes": middle,
                                 "ratio": found.ratio, "low": found.low, "high": found.high, "text": str(found)})
    return pd.DataFrame(rows, columns=["task", "equal", "arm", "other", "episodes", "ratio", "low", "high", "text"])


def draw(tables: dict[str, pd.DataFrame], data: Data, *, task: str, other_task: str) -> Figure:
    """Success against the number of demonstrations, the same against timesteps, and the other task."""
    rates = data.with_missing(tables[""], BY)
    figure, axes = plt.subplots(1, 3, figsize=(PAGE_WIDTH, 2.6), sharey=True, width_ratios=[1.2, 1.2, 1])
    shown = rates[rates.task == task]
    for ax, equal in zip(axes[:2], ("demonstrations", "timesteps"), strict=True):
        _curves(shown[shown.equal == equal], ax)
        ax.set_xlabel("demonstrations" if equal == "demonstrations" else f"timesteps / {STEPS}")
    other, before = (table[(table.task == other_task) & (table.equal == "demonstrations")]
                     for table in (rates, tables["predicted"]))
    _bars(other, before, axes[2])
    for ax in axes[1:]:
        ax.set_ylabel("")
    titles(list(axes), [f"{TASKS[task].title}, equal demonstrations", "equal timesteps", TASKS[other_task].title])
    figure.legend(*axes[0].get_legend_handles_labels(), ncol=4, loc="outside upper center")
    return figure


MARKERS = dict(zip(ARMS, "osp^vPX", strict=True))


def _curves(rates: pd.DataFrame, ax: Axes) -> None:
    counts = sorted(rates.demonstrations.unique())
    for number, arm in enumerate(ARMS):
        rows = rates[rates.arm == arm].sort_values("demonstrations")
        there, missing = rows[rows.value.notna()], rows[rows.value.isna()]
        shift = 1 + 0.02 * (number - len(ARMS) / 2)
        ax.errorbar(there.demonstrations * shift, there.value, errors(there), marker=MARKERS[arm], ms=3, lw=1.0,
                    capsize=1.2, color=COLOURS[ARMS[arm][0]], ls="-" if ARMS[arm][2] else "--", label=arm)
        ax.plot(missing.demonstrations * shift, [0.02 + 0.05 * number] * len(missing), ls="none", marker="$?$", ms=4,
                mew=0.3, color=COLOURS[ARMS[arm][0]])
    log_ticks(counts, ax)
    success_axis(ax)


def _bars(rates: pd.DataFrame, predicted: pd.DataFrame, ax: Axes) -> None:
    for place, arm in enumerate(ARMS):
        ax.plot([place] * (predicted.arm == arm).sum(), predicted.predicted[predicted.arm == arm], ls="none",
                marker="_", ms=10, mew=1.2, color="black", zorder=1)
        for row in rates[rates.arm == arm].itertuples():
            colour = COLOURS[ARMS[arm][0]]
            if pd.isna(row.value):
                ax.plot(place, 0.05, marker="$?$", ms=4, mew=0.3, color=colour)
            else:
                ax.errorbar(place, row.value, errors(row), marker=MARKERS[arm], ms=4, capsize=1.5, color=colour)
    ax.set_xticks([])
    ax.set_xlabel("50 demonstrations")
    success_axis(ax)


def answer(tables: dict[str, pd.DataFrame], data: Data, *, task: str) -> str:
    """How many times the episodes of random places each arm of `ASKED` needs, at equal demonstrations, and the order.
    """
    factors = tables["factors"]
    shown = factors[(factors.task == task) & (factors.equal == "demonstrations") & (factors.other == SPREAD_OUT)]
    each = "; ".join(f"{row.arm} {row.text}" for row in shown.itertuples())
    asked = "".join(f", times as many episodes as {count} random places for the same success"
                    for count in shown.episodes.unique())
    return (f"**The paper** does not ask. **Here**{asked}: {each or 'not computed yet'}. {_order(tables['predicted'])}"
            f"**How sure:** {data.sample_size}")


def _order(table: pd.DataFrame) -> str:
    """Whether the arms came out in the order that was predicted, where all of them were tried."""
    table = table[table.equal == "demonstrations"]
    if len(table) < len(ARMS):
        return ""
    found = float(table.predicted.corr(table.value, method="spearman"))
    return (f"{TASKS[table.task.iloc[0]].title}: order {'' if found >= SAME_ORDER else 'not '}as predicted "
            f"(Spearman {found:.2f}). ")


WORDS = Words(
    title="What should your fifty demonstrations be?",
    shown=(
        f"Success over a grid of places against the number of demonstrations: (a) all arms with as many, (b) with as "
        f"many timesteps, in units of {STEPS} (a static demonstration), (c) another task; dashes are what distance "
        "predicted before any of these runs. Static demonstrations grasp at five or ten places again and again, or "
        "each at a place of its own (random, one a cell of a jittered grid, or a Halton sequence); under MOVE the "
        f"object arrives at such places. {INTERVALS} Question marks are what is not computed yet."),
    alt="Curves of success over the number of demonstrations, one a way of placing them.",
    tables={
        "": f"Placements of demonstrations. {RATES}",
        "differences": f"Each placement against five places. {DIFFERENCES}",
        "factors": "How many times the other's episodes an arm needs for the other's success at the middle number of "
                   "episodes, with 95 % intervals.",
        "predicted": "Success on the other task as predicted from distance before any of these runs, the spread of its "
                     "grasps, and success as it came.",
        "ranks": "Spearman's correlation of two scores of the data with success on the other task: success predicted "
                 "from distance, and the standard deviation of the places of the grasps.",
    },
)

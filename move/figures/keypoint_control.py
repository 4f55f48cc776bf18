"""What is left when perception is given? Pick-Place from keypoints at several budgets, between floor and ceiling."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Repeats
from move.figures.plots.style import COLUMN_WIDTH, NAMES, titles
from move.figures.tables import printed_success, rate_table, rates_text
from move.figures.tables.differences import difference_means, difference_table, means_text, summary
from move.paper import PAPER_METHODS
from move.sim.observe import IMAGE_SIZE
from move.sim.tasks import TASKS
from move.study.axes import floors_and_ceilings
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

REPEATED = True
UNUSED_IMAGE_SIZE = IMAGE_SIZE  # enters the hashes of these runs from keypoints, whatever the profile's is


def runs(
    profile: Profile, timesteps: tuple[Count, ...] = (1250, 2500, 5000), seeds: Repeats = 5, episodes: Count = 100
) -> list[LabelledRun]:
    """All factors random: three methods at several budgets, the expert, and untrained baselines."""
    base = partial(policy_run, profile, task="pick-place", observation="keypoints", image_size=UNUSED_IMAGE_SIZE,
                   episodes=episodes)
    policies = grid(base, timesteps=timesteps, method=PAPER_METHODS, seed=range(seeds))
    return policies + floors_and_ceilings(["pick-place"], episodes)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates at every budget, differences, and their mean."""
    noise, policies = data.noise("keypoints"), data.episodes[data.episodes.kind == "policy"]
    return {
        "": rate_table(policies, ["method", "timesteps"], noise),
        "differences": difference_table(policies, "timesteps", noise),
        "differences_mean": difference_means(policies, "timesteps", noise),
    }


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """MOVE against each method in a row."""
    return {"summary": summary(tables["differences"], tables["differences_mean"])}


def _controls(data: Data) -> pd.Series:
    return data.episodes[data.episodes.kind == "control"].groupby("method").success.mean()


def _printed(data: Data) -> pd.DataFrame:
    """The paper's values from images, at their own budget."""
    return printed_success([data.runs[0].spec.task])


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Success against the budget, between floor and ceiling; and the paper's values from images."""
    rates, controls, printed = tables[""], _controls(data), _printed(data)
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.7))
    plots.curve(rates, "timesteps", "timesteps of demonstrations", ax, log=True)
    plots.printed_points(printed, ax)
    plots.log_ticks({*rates.timesteps, *printed.timesteps}, ax)
    for name in ("expert", "goal-blind"):
        if name in controls:
            plots.level(controls[name], NAMES[name], ax)
    ax.set_ylim(-0.03, 1.12)
    titles([ax], [f"{TASKS[data.runs[0].spec.task].title}, from keypoints"])
    figure.legend(handles=[*plots.entries(list(rates.method.unique()), "paper, from images"),
                            *plots.pooled_entry(rates)], ncol=4,
                  loc="outside upper center", columnspacing=0.8, handletextpad=0.4)
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The paper's rates from images, MOVE minus the others on the mean of the budgets, and the untrained baselines."""
    floor = ", ".join(f"{NAMES[name]} {rate:.0%}" for name, rate in _controls(data).items())
    return (
        f"**The paper**, from images at its own budget: {rates_text(_printed(data))}. **Here, from keypoints**, "
        f"mean of {tables[''].timesteps.nunique()} budgets: {means_text(tables['differences_mean'])}. Untrained: "
        f"{floor or 'not computed yet'}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="The keypoint control: what is left when perception is given",
    shown=(
        f"Success on Pick-Place from keypoints against the timesteps of demonstrations. {INTERVALS} Diamonds are the "
        f"paper's values, from images, at its own budget: a reference, not a comparison. Dashed lines: the expert, and "
        f"an expert that is told a wrong goal."),
    alt="Three curves over the budget between a floor and a ceiling.",
    tables={
        "": f"From keypoints: Pick-Place, perception given. {RATES}",
        "differences": f"From keypoints: Pick-Place, perception given. {DIFFERENCES}",
        "differences_mean": f"From keypoints: Pick-Place, mean of the budgets. {DIFFERENCES}",
    },
)

"""As many demonstrations in place of as many timesteps: is MOVE still ahead?"""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Repeats, TaskName
from move.figures.plots.panels import methods_and_seeds
from move.figures.plots.style import COLUMN_WIDTH, NAMES, titles
from move.figures.tables import demonstrations_made, rate_table
from move.figures.tables.differences import difference_table, difference_text
from move.sim.tasks import TASKS
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

BY = ["equal", "method"]


def runs(
    profile: Profile, task: TaskName = "pick-place", static_timesteps: Count = 18_000, move_timesteps: Count = 20_000,
    seeds: Repeats = 2, episodes: Count = 100,
) -> list[LabelledRun]:
    """Both methods from pixels; the label `equal` says which is equal, demonstrations or timesteps.

    Args:
        static_timesteps: in which static makes as many demonstrations as MOVE does in `move_timesteps`.
    """
    base = partial(policy_run, profile, task=task, episodes=episodes)
    budgets = {"demonstrations": static_timesteps, "timesteps": move_timesteps}
    return [run for seed in range(seeds) for run in (
        *grid(base, seed=[seed], equal={name: {"timesteps": budget} for name, budget in budgets.items()},
              method=["static"]),
        *grid(base, seed=[seed], equal={name: {"timesteps": move_timesteps} for name in budgets}, method=["move"]))]


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates, differences, and how many demonstrations there are."""
    noise = data.noise()
    return {
        "": rate_table(data.episodes, BY, noise),
        "differences": difference_table(data.episodes, "equal", noise),
        "made": demonstrations_made(data.results, "equal"),
    }


def draw(tables: dict[str, pd.DataFrame], data: Data, *, task: str) -> Figure:
    """Static and MOVE with as many timesteps, and with as many demonstrations."""
    rates = data.with_missing(tables[""], BY)
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.grouped_rates(rates.assign(paper=np.nan), "equal", [f"equal {name}" for name in rates.equal.unique()], ax)
    titles([ax], [TASKS[task].title])
    methods_and_seeds(figure, rates)
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """MOVE minus static both ways, and the demonstrations where they were to be equal."""
    made = tables["made"]
    each = "; ".join(f"at equal {row['equal']} MOVE minus static is {difference_text(row)}"
                     for _, row in tables["differences"].iterrows())
    counts = ", ".join(f"{NAMES[row.method]} {row.demonstrations:.0f}"
                       for row in made[made.equal == "demonstrations"].itertuples())
    return (
        f"**The paper** compares at equal timesteps. **Here:** {each or 'nothing is computed yet'}. Demonstrations "
        f"where they were to be equal, mean of the seeds: {counts}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="As many demonstrations instead of as many timesteps",
    shown=(
        f"Success on Pick-Place where both methods get as many timesteps, and where static gets as many demonstrations "
        f"as MOVE. {INTERVALS} White dots are single seeds."),
    alt="Two groups of bars, static beside MOVE.",
    tables={
        "": f"Equal timesteps and equal demonstrations, Pick-Place. {RATES}",
        "differences": f"Equal timesteps and equal demonstrations. {DIFFERENCES}",
        "made": "Demonstrations in a data set, mean of the seeds.",
    },
)

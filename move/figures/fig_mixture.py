"""How much of the data has to move? Shares of MOVE in a data set of static demonstrations."""

from __future__ import annotations

from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Repeats, Share, TaskName
from move.figures.plots.panels import methods_and_seeds
from move.figures.plots.style import COLUMN_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import difference_brief, variant_table
from move.sim.tasks import TASKS
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

BY = ["share", "method"]


def runs(
    profile: Profile, task: TaskName = "pick-place", shares: tuple[Share, ...] = (0, 0.25, 0.5, 0.75, 1),
    seeds: Repeats = 2, timesteps: Count = 20_000, episodes: Count = 100,
) -> list[LabelledRun]:
    """So much of the timesteps by MOVE and the rest static, from pixels; the label `share` is MOVE's."""
    base = partial(policy_run, profile, task=task, timesteps=timesteps, episodes=episodes)
    return grid(base, seed=range(seeds), share={float(share): _shared(share) for share in shares})


def _shared(share: float) -> dict[str, Any]:
    if share in (0, 1):
        return {"method": "move" if share else "static"}
    return {"method": "mixture", "shares": {"static": 1 - share, "move": share}}


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates at every share, and each share against none."""
    noise = data.noise()
    rates = rate_table(data.episodes, BY, noise).sort_values("share")
    return {"": rates, "gains": variant_table(data.episodes, [], "share", lambda rows: [
        (share, 0.0) for share in sorted(rows.share.unique()) if share], noise)}


def draw(tables: dict[str, pd.DataFrame], data: Data, *, task: str) -> Figure:
    """One bar a share of MOVE in the data."""
    rates = data.with_missing(tables[""], BY).sort_values("share")
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.ladder(rates.assign(percent=[f"{100 * share:.0f}" for share in rates.share]), "percent", ax)
    ax.set_xlabel("timesteps by MOVE (%), the rest static")
    titles([ax], [TASKS[task].title])
    methods_and_seeds(figure, rates)
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Each share against none."""
    each = "; ".join(f"{100 * row.share:.0f} % {difference_brief(row)}" for _, row in tables["gains"].iterrows())
    return (f"**The paper** does not ask this. **Here**, in points against none: {each or 'nothing is computed yet'}. "
            f"**How sure:** after Holm's adjustment. {data.sample_size}")


WORDS = Words(
    title="How much of the data has to move?",
    shown=(
        f"Success on Pick-Place against the share of the timesteps that MOVE collected, the rest being static. "
        f"{INTERVALS} White dots are single seeds."),
    alt="A bar chart over the share of moving demonstrations.",
    tables={
        "": f"Shares of MOVE in the data, Pick-Place. {RATES}",
        "gains": "Each share of MOVE against none; in points, with 95 % intervals.",
    },
)

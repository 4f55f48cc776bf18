"""By which law are speeds drawn? MOVE's Beta(2, 5) against others of the same mean (section III-B)."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.choices import SpeedLaw
from move.figures import plots
from move.figures.page.captions import INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Repeats, TaskName
from move.figures.plots.panels import methods_and_seeds
from move.figures.plots.style import COLUMN_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import difference_text, variant_table
from move.sim.tasks import TASKS
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

BY = ["law", "method"]


def runs(
    profile: Profile, task: TaskName = "pick-place", laws: tuple[SpeedLaw, ...] = ("beta", "uniform", "constant"),
    seeds: Repeats = 2, timesteps: Count = 20_000, episodes: Count = 100,
) -> list[LabelledRun]:
    """MOVE with every speed drawn by another law of the same mean, and static; the label `law`.

    The paper's law is "beta"; where nothing moves, the label is "static".
    """
    base = partial(policy_run, profile, task=task, timesteps=timesteps, episodes=episodes)
    chosen: dict[str, dict[str, str]] = {"static": {"method": "static"}}
    chosen |= {law: {"method": "move", "speed_law": law} for law in laws}
    return grid(base, seed=range(seeds), law=chosen)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates under each law, and each other law against the paper's."""
    noise = data.noise()
    return {"": rate_table(data.episodes, BY, noise),
            "others": variant_table(data.episodes, [], "law", lambda rows: [
                (law, "beta") for law in rows.law.unique() if law not in ("beta", "static")], noise)}


def draw(tables: dict[str, pd.DataFrame], data: Data, *, task: str) -> Figure:
    """Static, and MOVE under each law of the speeds."""
    rates = data.with_missing(tables[""], BY)
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 2.3))
    plots.ladder(rates, "law", ax)
    ax.set_xlabel("how the speeds are drawn, all with one mean")
    titles([ax], [TASKS[task].title])
    methods_and_seeds(figure, rates)
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Each other law against the paper's."""
    each = "; ".join(f"{row.law} against Beta {difference_text(row)}" for _, row in tables["others"].iterrows())
    return (
        "**The paper:** Beta-distributed speeds help robust grasping; it compares with no other law. **Here:** "
        f"{each or 'nothing is computed yet'}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Does it matter how speeds are drawn?",
    shown=(
        f"Success on Pick-Place: static, and MOVE with every speed drawn from Beta(2, 5) as in the paper, uniformly "
        f"between 0 and twice its mean, or always its mean. {INTERVALS} White dots are single seeds. The paper gives "
        f"no numbers."),
    alt="A bar chart with a bar for static and one for each law of the speeds.",
    tables={
        "": f"How speeds are drawn, Pick-Place. {RATES}",
        "others": "Each other law of the speeds against Beta(2, 5); in points, with 95 % intervals.",
    },
)

"""Which ADC is the stronger baseline? Three readings of when its objects jump."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import INTERVALS, POOLED, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Seeds
from move.figures.plots.panels import SEEN
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.figures.tables.differences import COLUMNS, difference_brief, mean_columns
from move.paper import PAPER_TASKS
from move.sim.motion.adc import JUMPS
from move.statistics.cells import successes, training_noise
from move.statistics.training_noise import TrainingNoise
from move.study.axes import budgets
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile


def runs(
    profile: Profile, pixel_tasks: tuple[str, ...] = PAPER_TASKS, tasks: tuple[str, ...] = PAPER_TASKS,
    periodic_tasks: tuple[str, ...] = ("pick-place", "window-open"), timesteps: Count = 2500, seeds: Seeds = 3,
    episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """One seed from pixels at table 2's budget on `pixel_tasks`, `seeds` from keypoints on `tasks`.

    Jumps twice a phase are tried on `periodic_tasks` from keypoints, and on the first of them from pixels.
    """
    base, runs = partial(policy_run, profile, method="adc", episodes=episodes), []
    for name, jumping in JUMPS.items():
        few = name == "periodic"
        reading = {name: {"jumping": jumping}}
        seen = [task for task in pixel_tasks if not few or task in periodic_tasks[:1]]
        given = [task for task in tasks if not few or task in periodic_tasks]
        runs += grid(base, jumping=reading, observation=["rgb"], task=budgets(seen, most_timesteps), seed=[0])
        runs += grid(base, jumping=reading, observation=["keypoints"], timesteps=[timesteps], task=given,
                     seed=range(seeds))
    return runs


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates of each reading, their means, and each reading against the one as printed."""
    noise = {seen: data.noise(seen) for seen in ("rgb", "keypoints")}
    rates = pd.concat([rate_table(rows, ["observation", "task", "method", "jumping"], noise[seen])
                       for seen, rows in data.episodes.groupby("observation", sort=False)]).drop(columns="method")
    return {
        "": rates,
        "means": rates.groupby(["observation", "jumping"], sort=False).value.agg(["mean", "count"]).reset_index(),
        "differences": reading_differences(data.episodes, noise),
    }


def reading_differences(episodes: pd.DataFrame, known: dict[str, TrainingNoise]) -> pd.DataFrame:
    """Each other reading minus the one as printed: the mean over the tasks that have both, one row an observation."""
    rows, printed = [], "as printed"
    for seen, part in episodes.groupby("observation", sort=False):
        noise = training_noise(part, ["task", "jumping"], known[seen])
        cells = {key: successes(cell) for key, cell in part.groupby(["task", "jumping"])}
        for reading in ("mended", "periodic"):
            pairs = [(cells[task, reading], cells[task, printed]) for task in part.task.unique()
                     if {(task, reading), (task, printed)} <= set(cells)]
            rows += [{"observation": seen, "jumping": reading, "baseline": printed, **mean_columns(pairs, noise)}
                     ] if pairs else []
    return pd.DataFrame(rows, columns=["observation", "jumping", "baseline", "items", *COLUMNS])


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """The readings of ADC, one panel a kind of observation."""
    rates = tables[""]
    kinds = list(rates.observation.unique())
    figure, axes = plt.subplots(len(kinds), 1, figsize=(PAGE_WIDTH, 2.1 * len(kinds) + 0.3), squeeze=False)
    for ax, kind in zip(axes.flat, kinds, strict=True):
        plots.readings(rates[rates.observation == kind], "jumping", ax)
    handles, _ = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles=[*handles, *plots.pooled_entry(rates)], ncol=4, loc="outside upper center")
    titles(list(axes.flat), [SEEN[kind] for kind in kinds])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Each reading against the one as printed, over the tasks that have both."""
    each = "; ".join(f"from {'pixels' if row.observation == 'rgb' else row.observation} {row.jumping}, {row['items']} "
                     f"tasks, {difference_brief(row)}" for _, row in tables["differences"].iterrows())
    return ("**The paper** does not say when ADC jumps. **Here**, points against as printed: "
            f"{each or 'nothing to compare yet'}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Which ADC is the stronger baseline?",
    shown=(
        f"Success of ADC under three readings of when its objects jump, from pixels and from keypoints, where "
        f"perception is given. {INTERVALS} {POOLED}"),
    alt="Two panels of points with intervals for ten tasks and up to three readings.",
    tables={
        "": f"Three readings of ADC. {RATES}",
        "means": "Three readings of ADC: means over the tasks.",
        "differences": (
            "Readings of ADC minus the one as printed, means over the tasks that have both; in "
            "points, with 95 % intervals."),
    },
)

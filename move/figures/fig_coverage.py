"""Is it coverage? Success of the policies of table 2 and figure 6 against what their data cover."""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import fig6_dimensions, plots
from move.figures.page.captions import INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.make import steps
from move.figures.page.parameters import Count, Seeds
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import rate_table
from move.paper import PAPER_TASKS
from move.sim.tasks import get_task
from move.study.axes import budgets
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, distinct, grid
from move.study.profiles import Profile
from move.study.spec import PolicyRun, RunSpec

COVERED = ("joint", "object", "target", "camera")


def runs(
    profile: Profile, tasks: tuple[str, ...] = PAPER_TASKS,
    dimension_tasks: tuple[str, ...] = ("pick-place", "assembly"),
    seeds: Seeds = 3, episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Policies of table 2 from pixels, and of figure 6 on some tasks.

    Labels `task` and `moves`: what moves in the demonstrations, "nothing", "jumps" for ADC, or "all" for MOVE.
    """
    base = partial(policy_run, profile, episodes=episodes)
    methods = {"nothing": "static", "jumps": "adc", "all": "move"}
    runs = grid(base, seed=range(seeds), task=budgets(tasks, most_timesteps),
                moves={name: {"method": method} for name, method in methods.items()})
    return distinct(runs + fig6_dimensions.runs(
        profile, tasks=dimension_tasks, alone_tasks=tuple(task for task in dimension_tasks if task == "pick-place"),
        seeds=seeds, episodes=episodes, most_timesteps=most_timesteps))


def seen(data: Data, *, covered_timesteps: Count = 5000) -> pd.DataFrame:
    """One row a task and what moves in its data: success with its interval, and shares of cells that the data visit.

    Columns task, moves, method, value, low, high; object, target, camera and joint (object position and camera angle
    together), of the first seed's data. Where a result does not say so, its first timesteps are collected again.
    """
    first = {(result.spec.task, result.labels["moves"]): result for result in reversed(data.results)
             if isinstance(result.spec, PolicyRun)}
    shares = []
    for (task, moves), result in steps(first.items(), "collections"):
        stored = (result.collection or {}).get("covered") or {}
        found = stored.get(str(covered_timesteps)) or _collected_again(result.spec, covered_timesteps)
        shares.append({"task": task, "moves": moves, **{part: found.get(part) for part in COVERED}})
    rates = rate_table(data.episodes, ["task", "moves", "method"], data.noise())
    return rates.merge(pd.DataFrame(shares), on=["task", "moves"])


def _collected_again(spec: RunSpec, timesteps: int) -> dict[str, float]:
    """The shares that the first so many timesteps of a run's data cover, collected without images."""
    from move.sim import coverage  # imports the simulator

    assert spec.collection is not None
    fewer = spec.collection.model_copy(update={"timesteps": min(timesteps, spec.collection.timesteps),
                                               "observation": "keypoints"})
    return coverage.shares(coverage.configurations(fewer, spec.seed), get_task(spec.task))


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Success and coverage of each cell."""
    return {"": data.seen.drop(columns=["method", "seeds", "episodes", "trainings"])}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Success against what the data cover: of the object, of the camera, of both together."""
    figure, axes = plt.subplots(1, 3, figsize=(PAGE_WIDTH, 2.6), sharey=True)
    for ax, column in zip(axes, ("object", "camera", "joint"), strict=True):
        plots.covered(data.seen, column, ax, named=column == "joint")
        ax.set_ylabel("success (%)" if ax is axes[0] else "")
    titles(list(axes), ["object", "camera", "both together"])
    figure.legend(*axes[0].get_legend_handles_labels(), ncol=4, loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How success goes with coverage, and how little that says."""
    return (
        "**The paper:** motion covers more of space, and that is why MOVE works. **Here:** "
        f"{coverage_text(data.seen)} **How sure:** {data.sample_size}")


def coverage_text(table: pd.DataFrame) -> str:
    """How success goes with joint coverage, in words: within tasks, and of MOVE's gain over the tasks' gains."""
    from scipy import stats

    several = table[table.groupby("task").task.transform("size") > 1]
    if len(several) < 3:
        return "Fewer than three cells are stored."
    centred = several[["joint", "value"]] - several.groupby("task")[["joint", "value"]].transform("mean")
    within = stats.spearmanr(centred.joint, centred.value)
    said = [f"rank correlation of success and joint coverage {within.statistic:+.2f} within tasks "
            f"(p = {within.pvalue:.2g})"]
    ends = table[table.moves.isin(["nothing", "all"])].pivot(index="task", columns="moves", values=["joint", "value"])
    ends = ends.reindex(columns=pd.MultiIndex.from_product([["joint", "value"], ["nothing", "all"]])).dropna()
    if len(ends) > 2:
        gains = {name: ends[name]["all"] - ends[name]["nothing"] for name in ("joint", "value")}
        over = stats.spearmanr(gains["joint"], gains["value"])
        said.append(f"of MOVE's gains over {len(ends)} tasks (covers {100 * gains['joint'].min():+.0f} to "
                    f"{100 * gains['joint'].max():+.0f} points more, success {100 * gains['value'].min():+.0f} to "
                    f"{100 * gains['value'].max():+.0f} points) {over.statistic:+.2f} (p = {over.pvalue:.2g})")
    return "; ".join(said) + "."


WORDS = Words(
    title="Does success follow what the data cover?",
    shown=(
        f"Success from pixels against the share of equal cells that the data visit: (a) of the object's positions, (b) "
        f"of the camera's angles, (c) of both together. One mark a task and way to collect, small and light where "
        f"only some of what MOVE moves does; grey lines join the marks of a task. The axes begin at other shares. "
        f"{INTERVALS}"),
    alt="Three clouds of points in the methods' colours, joined task by task.",
    tables={
        "": f"Success, and shares of cells that the data visit in their first timesteps. {RATES}",
    },
)

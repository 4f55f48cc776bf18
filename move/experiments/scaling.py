"""How much data it takes: success against timesteps, and the pairs of budgets that the paper calls equal (figure 4)."""

from __future__ import annotations

from functools import partial

from move.experiments.budgets import budgets
from move.experiments.floors import floors_and_ceilings
from move.experiments.registry import Count, Seeds, experiment
from move.paper import PAPER_METHODS, PAPER_TASKS, published
from move.sim.tasks import get_task
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, distinct, grid
from move.study.profiles import Profile


@experiment
def fig4_scaling(
    profile: Profile, tasks: tuple[str, ...] = PAPER_TASKS,
    timesteps: tuple[Count, ...] = (5000, 10_000, 20_000, 40_000),
    short_timesteps: tuple[Count, ...] = (2500, 5000, 10_000, 20_000), seeds: Seeds = 1, table_seeds: Seeds = 3,
    pairs: bool = True, episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Static and MOVE from pixels at growing budgets, all three methods at table 2's (figure 4).

    A larger budget begins with the smaller one's demonstrations. `pairs` adds the budgets that the paper says do
    equally well. Each task's floor and ceiling say where a rate lies between them.

    Args:
        short_timesteps: the budgets of tasks to which table 5 gives fewer than `most_timesteps`.
        table_seeds: repetitions at table 2's own budget, `most_timesteps` at most.
    """
    base = partial(policy_run, profile, episodes=episodes)
    runs: list[LabelledRun] = []
    for task in tasks:
        short = get_task(task).timesteps < most_timesteps
        runs += grid(base, seed=range(seeds), task=[task], timesteps=short_timesteps if short else timesteps,
                     method=("static", "move"))
        runs += grid(base, seed=range(table_seeds), task=budgets([task], most_timesteps), method=PAPER_METHODS)
        runs += _said_to_be_equal(base, task) if pairs and seeds else []
    return distinct(runs + floors_and_ceilings(tasks, episodes) * bool(runs))


def _said_to_be_equal(base: partial, task: str) -> list[LabelledRun]:
    said = published("fig4_scaling", "timesteps", condition="equally good")
    return [run for row in said[said.task == task].itertuples()
            for run in grid(base, seed=[0], task=[task], timesteps=[int(row.value)], method=[row.method])]

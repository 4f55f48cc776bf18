"""Why it works: perception given or not, coverage, how much must move, equal demonstrations for timesteps."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

from pydantic import Field

from move.experiments.budgets import budgets
from move.experiments.dimensions import fig6_dimensions
from move.experiments.preliminary import fig1_sparse, fig3_dense, fig5_circle, table1_spatial_factors
from move.experiments.registry import Count, Observation, Seeds, experiment
from move.paper import PAPER_TASKS
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, distinct, grid
from move.study.profiles import Profile

PRELIMINARY = {"figure 1": fig1_sparse, "figure 3": fig3_dense, "figure 5": fig5_circle}
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]


@experiment
def fig_perception(
    profile: Profile, timesteps: Count = 7000, table_timesteps: Count = 20_000, seeds: Count = 3,
    grid_side: Count = 15, episodes: Count = 100, observations: tuple[Observation, ...] = ("rgb", "keypoints"),
) -> list[LabelledRun]:
    """Figures 1, 3 and 5 and table 1 from pixels and with perception given: what is left of the effect.

    The label `experiment` is such as "figure 1" or "table 1, all". Observations without a recipe in the profile are
    left out.
    """
    runs: list[LabelledRun] = []
    for observation in [name for name in observations if name in profile.training]:
        for name, figure in PRELIMINARY.items():
            budget = (timesteps,) if figure is fig3_dense else timesteps
            alone = {"lengths": ()} if figure is fig1_sparse else {}
            runs += [run.labelled(experiment=name) for run in figure(
                profile, observation=observation, timesteps=budget, seeds=seeds, near_hands=0, identical_starts=0,
                grid_side=grid_side, **alone)]
        runs += [run.labelled(experiment=f"table 1, {run.labels['factors']}") for run in table1_spatial_factors(
            profile, observation=observation, timesteps=table_timesteps, seeds=seeds, episodes=episodes)]
    return runs


@experiment
def fig_coverage(
    profile: Profile, tasks: tuple[str, ...] = PAPER_TASKS,
    dimension_tasks: tuple[str, ...] = ("pick-place", "assembly"),
    seeds: Seeds = 3, episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Policies of table 2 from pixels, and of figure 6 on some tasks: their success, against what their data cover.

    Labels `task` and `moves`: what moves in the demonstrations, "nothing", "jumps" for ADC, or "all" for MOVE.
    """
    base = partial(policy_run, profile, episodes=episodes)
    methods = {"nothing": "static", "jumps": "adc", "all": "move"}
    runs = grid(base, seed=range(seeds), task=budgets(tasks, most_timesteps),
                moves={name: {"method": method} for name, method in methods.items()})
    return distinct(runs + fig6_dimensions(
        profile, tasks=dimension_tasks, alone_tasks=[task for task in dimension_tasks if task == "pick-place"],
        seeds=seeds, episodes=episodes, most_timesteps=most_timesteps))


@experiment
def fig_mixture(
    profile: Profile, task: str = "pick-place", shares: tuple[Share, ...] = (0, 0.25, 0.5, 0.75, 1), seeds: Seeds = 2,
    timesteps: Count = 20_000, episodes: Count = 100,
) -> list[LabelledRun]:
    """So much of the timesteps by MOVE and the rest static, from pixels; the label `share` is MOVE's."""
    base = partial(policy_run, profile, task=task, timesteps=timesteps, episodes=episodes)
    return grid(base, seed=range(seeds), share={float(share): _shared(share) for share in shares})


def _shared(share: float) -> dict[str, Any]:
    if share in (0, 1):
        return {"method": "move" if share else "static"}
    return {"method": "mixture", "shares": {"static": 1 - share, "move": share}}


@experiment
def equal_demonstrations(
    profile: Profile, task: str = "pick-place", static_timesteps: Count = 18_000, move_timesteps: Count = 20_000,
    seeds: Seeds = 2, episodes: Count = 100,
) -> list[LabelledRun]:
    """As many demonstrations in place of as many timesteps, from pixels; the label `equal` says which is equal.

    Args:
        static_timesteps: in which static makes as many demonstrations as MOVE does in `move_timesteps`.
    """
    base = partial(policy_run, profile, task=task, episodes=episodes)
    budgets = {"demonstrations": static_timesteps, "timesteps": move_timesteps}
    return [run for seed in range(seeds) for run in (
        *grid(base, seed=[seed], equal={name: {"timesteps": budget} for name, budget in budgets.items()},
              method=["static"]),
        *grid(base, seed=[seed], equal={name: {"timesteps": move_timesteps} for name in budgets}, method=["move"]))]

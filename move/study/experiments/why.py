"""Why it works, on Pick-Place: how much of the data must move, and equal demonstrations in place of timesteps."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

from pydantic import Field

from move.study.experiments.registry import Count, Seeds, experiment
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]


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

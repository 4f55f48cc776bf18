"""The recipe for pictures against one change at a time."""

from __future__ import annotations

from functools import partial
from typing import Any

from move.learn.evaluate import Evaluation
from move.study.experiments.registry import Count, Multiple, experiment
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, distinct, grid
from move.study.profiles import Profile

RECIPE_CHANGES: dict[str, dict[str, Any]] = {
    "chosen": {},
    "one noise level a window": {"noise_draws": 1},
    "spatial softmax starts flat": {"softmax_gain": 1.0},
    "encoder learns from all frames": {"learning_frames": None},
    "32 channels": {"cnn_width": 32},
    "learning rate 1e-3": {"learning_rate": 1e-3},
    "learning rate 3e-3": {"learning_rate": 3e-3},
}
"""What the recipe for pictures was measured against: one change at a time."""


@experiment
def table_recipe(
    profile: Profile, timesteps: tuple[Count, ...] = (7000, 20_000), episodes: Count = 60,
    lengths: tuple[Multiple, ...] = (2 / 3, 3),
) -> list[LabelledRun]:
    """The recipe for pictures with one change at a time: static alone, at the configurations that it learnt from.

    The last runs of each budget train for the recipe's gradient steps times each of `lengths`; the label `change` says
    what is other. Nothing here compares methods. A profile whose policy is not the small CNN has no `timesteps` for it.
    """
    changes = RECIPE_CHANGES | {f"{length:.2g} times as long": {"length": length} for length in lengths}
    runs: list[LabelledRun] = []
    for budget in timesteps:
        protocol, factors = ("sparse", "object") if budget == min(timesteps) else ("random", "all")
        base = partial(policy_run, profile, task="pick-place", method="static", seed=0, protocol=protocol,
                       factors=factors)
        runs += grid(base, timesteps=[budget], change=changes)
    own = Evaluation(layout="own", episodes=episodes)
    return distinct(run.tried(own) for run in runs)  # a change may be none in this profile

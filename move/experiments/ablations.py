"""What was chosen against what else could have been: the recipe for images, its length, and how ADC jumps."""

from __future__ import annotations

from functools import partial
from typing import Any

from move.experiments.budgets import budgets
from move.experiments.registry import Count, Multiple, Repeats, experiment
from move.learn.evaluation import Evaluation
from move.paper import PAPER_TASKS
from move.sim.motion.adc import JUMPS
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
"""What the recipe for images was measured against: one change at a time."""


@experiment
def table_recipe(
    profile: Profile, timesteps: tuple[Count, ...] = (7000, 20_000), episodes: Count = 60,
    lengths: tuple[Multiple, ...] = (2 / 3, 3),
) -> list[LabelledRun]:
    """The recipe for images with one change at a time: static alone, at the configurations that it learnt from.

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
    own = Evaluation(starts="own", episodes=episodes)
    return distinct(run.tried(own) for run in runs)  # a change may be none in this profile


@experiment
def fig_training_length(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "push", "window-open"),
    lengths: tuple[Multiple, ...] = (1 / 3, 1, 3), seeds: Repeats = 2, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Does MOVE minus static depend on how long one trains? The recipe's gradient steps times each of `lengths`.

    Policies of table 2, from pixels; nothing is chosen by the answer.
    """
    return grid(partial(policy_run, profile, episodes=episodes),
                length={round(length, 3): {"length": length} for length in lengths}, seed=range(seeds),
                task=budgets(tasks, most_timesteps), method=("static", "move"))


@experiment
def table_adc(
    profile: Profile, pixel_tasks: tuple[str, ...] = PAPER_TASKS, tasks: tuple[str, ...] = PAPER_TASKS,
    periodic_tasks: tuple[str, ...] = ("pick-place", "window-open"), timesteps: Count = 2500, seeds: Repeats = 3,
    episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Which reading of ADC is the stronger baseline: one seed from pixels at table 2's budget, `seeds` from keypoints.

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

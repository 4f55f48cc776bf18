"""What is left when perception is given, and what a demonstration costs (table 6)."""

from __future__ import annotations

from functools import partial
from typing import get_args

from move.choices import ExpertName
from move.experiments.floors import floors_and_ceilings
from move.experiments.registry import Count, Repeats, experiment
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.sim.observe import IMAGE_SIZE
from move.study.kinds import collector_run, policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

UNUSED_IMAGE_SIZE = IMAGE_SIZE  # enters the hashes of these runs from keypoints, whatever the profile's is


@experiment
def keypoint_control(
    profile: Profile, timesteps: tuple[Count, ...] = (1250, 2500, 5000), seeds: Repeats = 5, episodes: Count = 100
) -> list[LabelledRun]:
    """Pick-Place with all factors random and perception given: three methods at several budgets, and the expert."""
    base = partial(policy_run, profile, task="pick-place", observation="keypoints", image_size=UNUSED_IMAGE_SIZE,
                   episodes=episodes)
    policies = grid(base, timesteps=timesteps, method=PAPER_METHODS, seed=range(seeds))
    return policies + floors_and_ceilings(["pick-place"], episodes)


@experiment
def table6_collection(profile: Profile, attempts: Count = 100) -> list[LabelledRun]:
    """What a demonstration costs: attempts by each expert, static, ADC and MOVE, on every task (table 6)."""
    base = partial(collector_run, profile, attempts=attempts)
    return grid(base, expert=get_args(ExpertName), task=PAPER_TASKS, method=PAPER_METHODS)


@experiment
def table_keypoint_control(
    profile: Profile, timesteps: Count = 2500, seeds: Repeats = 3, episodes: Count = 100,
    larger: Count = 10_000, larger_tasks: tuple[str, ...] = ("assembly", "hammer", "basketball"),
) -> list[LabelledRun]:
    """Every task from keypoints, three methods at one budget, between each task's floor and ceiling.

    The tasks that stay near their floor, `larger_tasks`, get a `larger` budget as well, alike for all methods.
    """
    base = partial(policy_run, profile, observation="keypoints", image_size=UNUSED_IMAGE_SIZE, episodes=episodes)
    policies = [run for seed in range(seeds) for budget, tasks in ((timesteps, PAPER_TASKS), (larger, larger_tasks))
                for run in grid(base, seed=[seed], timesteps=[budget], task=tasks, method=PAPER_METHODS)]
    return policies + floors_and_ceilings(PAPER_TASKS, episodes)

"""Every task by the paper's three methods (table 2), and the same policies elsewhere and as films."""

from __future__ import annotations

from functools import partial

from move.experiments.budgets import budgets
from move.experiments.floors import floors_and_ceilings
from move.experiments.registry import Count, Observation, Seeds, experiment
from move.learn.evaluation import Evaluation
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.sim.tasks.task import EPISODE_STEPS
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile
from move.study.spec import PolicyRun


@experiment
def table2_main(
    profile: Profile, seeds: Seeds = 1, control_seeds: Seeds = 1, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Every task, three methods, at the paper's budget but at `most_timesteps` (table 2); its floor and its ceiling.

    `seeds` from pixels and `control_seeds` from keypoints.
    """
    base, tasks = partial(policy_run, profile, episodes=episodes), budgets(PAPER_TASKS, most_timesteps)
    policies = [run for observation, count in (("rgb", seeds), ("keypoints", control_seeds))
                for run in grid(partial(base, observation=observation), seed=range(count), task=tasks,
                                method=PAPER_METHODS)]
    return policies + floors_and_ceilings(PAPER_TASKS, episodes)


@experiment
def generalization(
    profile: Profile, tasks: tuple[str, ...] = PAPER_TASKS, methods: tuple[str, ...] = PAPER_METHODS,
    seeds: tuple[Seeds, ...] = (0,), own_episodes: Count = 60, episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Policies of table 2 from pixels: where table 2 tries them, the same in motion, and at their own grasps.

    In motion everything moves as in demonstrations of MOVE. Every method's demonstrations show the scene as it is at
    the grasp, so the rates mean the same for all. A policy is trained once for all. No more of its own configurations
    are tried than its budget is sure to hold.
    """
    runs = grid(partial(policy_run, profile, episodes=episodes), seed=seeds, task=budgets(tasks, most_timesteps),
                method=methods)
    moving = Evaluation(starts="moving", episodes=episodes)
    return runs + [run.tried(tried) for run in runs for tried in (_own(run, own_episodes), moving)]


def _own(run: LabelledRun, episodes: int) -> Evaluation:
    assert isinstance(run.spec, PolicyRun)
    sure = max(1, run.spec.collection.timesteps // EPISODE_STEPS)
    return Evaluation(starts="grasp", episodes=min(episodes, sure))


@experiment
def rollouts(
    profile: Profile, observation: Observation = "rgb", task: str = "pick-place", timesteps: Count = 20_000,
    episodes: Count = 100,
) -> list[LabelledRun]:
    """The first seed's policies of table 2 on one task, whose episodes are shown as films."""
    base = partial(policy_run, profile, task=task, seed=0, observation=observation, timesteps=timesteps,
                   episodes=episodes)
    return grid(base, method=PAPER_METHODS)

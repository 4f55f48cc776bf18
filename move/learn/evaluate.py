"""Evaluation: all episodes of an `Evaluation`'s starts stepped together, one row an episode.

What acts is in `agents.py`, the loop that steps the episodes in `rollout.py`, which configurations are tried in
`evaluation.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence

from move.learn.agents import Agent
from move.learn.evaluation import Evaluation, Start, starts
from move.learn.rollout import Rollout, roll_out
from move.sim.configuration import SpatialConfiguration
from move.sim.observe import KEYPOINTS, ObservationSpec
from move.sim.scene.scene import Scene
from move.sim.tasks.task import Task

BATCH_SIZE = 160  # episodes stepped together at most


def evaluate(
    agent: Agent,
    task: Task,
    evaluation: Evaluation,
    observation: ObservationSpec = KEYPOINTS,
    on_step: Callable[[int, int], None] | None = None,
    batch_size: int = BATCH_SIZE,
    own: Sequence[SpatialConfiguration] = (),
    indices: Container[int] | None = None,
    callback: Callable[[int, Scene], None] | None = None,
) -> list[dict]:
    """Try `agent` once on each configuration: at most 200 steps, ended by the tenth successful one.

    Args:
        on_step: called with (episodes ended, episodes in all).
        batch_size: how many episodes are stepped together.
        own: the configurations of the starts "own" and "grasp".
        indices: of the starts that are tried; by default all.
        callback: called with a start's index and its scene at the start and after every step.

    Returns:
        One row an episode: trial (the index of its start), group, the whole configuration that was tried (as
        `SpatialConfiguration.columns` names it), success (at least one successful step, Meta-World's rule),
        success_steps (10 end a demonstration in the authors' code), end_success (the episode's last step was
        successful), held (both fingers held the object, or touched it where the task is done without a grasp, at some
        step: a failed grasp and a missed target differ), steps; and the task's other conditions by their names, each
        whether it held at some step.
    """
    task = task.variant(evaluation.fixed)
    listed, rows = starts(task, evaluation, own), []

    def on_ended(ended: int) -> None:
        if on_step:
            on_step(ended, len(listed))

    for first in range(0, len(listed), batch_size):
        batch = listed[first : first + batch_size]
        rollouts = roll_out(
            agent, task, [start.configuration for start in batch], observation, indices, on_ended, callback,
            in_motion=evaluation.factors if evaluation.starts == "moving" else None, first_index=first,
        )
        rows += [_row(listed[rollout.index], rollout) for rollout in rollouts]
    return rows


def _row(start: Start, rollout: Rollout) -> dict:
    row = {"trial": rollout.index, "group": start.group, **start.configuration.columns(),
           "success": rollout.successes > 0, "success_steps": rollout.successes, "end_success": rollout.scene.success,
           "held": rollout.scene.phase == "place", "steps": rollout.scene.steps}
    return row | {name: steps > 0 for name, steps in rollout.scene.recorded_steps.items()}

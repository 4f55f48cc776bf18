"""Evaluation: fixed configurations, all episodes stepped together, one row an episode.

The configurations of a task and setting are the same for every method and seed, and come from a stream that no
training uses. What acts is in `agents.py`, the loop that steps the episodes in `rollout.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from move.choices import Place
from move.learn.agents import Agent
from move.learn.rollout import Rollout, roll_out
from move.sim.collect import hand_near
from move.sim.collection import ANY_HAND
from move.sim.configuration import SpatialConfiguration, Vector
from move.sim.grasp_points import circle_points, sparse_points
from move.sim.observe import KEYPOINTS, ObservationSpec
from move.sim.scene.scene import Scene
from move.sim.tasks.listed import listed_configurations
from move.sim.tasks.task import Task

CONFIGURATION_STREAM = 2  # first word of the seed of the configurations
BATCH_SIZE = 160  # episodes stepped together at most


class Evaluation(BaseModel):
    """Which configurations a policy is tried on."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", validate_by_name=True, validate_by_alias=True,
                              serialize_by_alias=True, loc_by_alias=False)

    starts: Literal["random", "moving", "grid", "listed", "own", "grasp"] = Field(
        default="random", alias="layout",
        description="held-out random configurations; 'moving': the same, all in motion as for MOVE; a grid over the "
        "object; the authors' list of 20; or the policy's own demonstrations as they began ('own') or when they "
        "grasped ('grasp'). Stored JSON calls it layout"
    )
    episodes: int = Field(default=100, gt=0, le=10**5, description="number of configurations, unless they are a grid")
    grid_side: int = Field(default=12, gt=0, le=300, description="cells along a side of the grid")
    factors: str = Field(
        default="all", description="what is random; a grid varies the object, and the hand where it is object+hand"
    )
    hand_within: float = Field(
        default=0.0, ge=0, allow_inf_nan=False, description="metres; of a grid: what hand_spread is of a collection"
    )
    fixed: Place = Field(default="package", description="whose camera and target, where they are not random")
    points: Literal["none", "sparse", "circle"] = Field(default="none", description="grasp points tried besides a grid")


@dataclass(frozen=True)
class Start:
    """One configuration to be tried; `group` is "random", "moving", "own", "grasp", "listed", "grid" or "point"."""

    group: str
    configuration: SpatialConfiguration


def starts(task: Task, evaluation: Evaluation, own: Sequence[SpatialConfiguration] = ()) -> list[Start]:
    """The fixed list of configurations of a task and setting; for "own" and "grasp" the list that is given.

    >>> from move.sim.tasks import get_task
    >>> len(starts(get_task("pick-place"), Evaluation(starts="grid", points="sparse")))
    153
    """
    if evaluation.starts in ("own", "grasp"):
        return [Start(evaluation.starts, configuration) for configuration in own]
    if evaluation.starts in ("random", "moving"):
        rng = np.random.default_rng([CONFIGURATION_STREAM, *task.name.encode()])
        return [Start(evaluation.starts, task.sample(rng, evaluation.factors)) for _ in range(evaluation.episodes)]
    if evaluation.starts == "listed":
        return [Start("listed", configuration) for configuration in listed_configurations(task)]
    points = {"none": [], "sparse": sparse_points(task), "circle": circle_points(task)}[evaluation.points]
    places = [("grid", place) for place in grid(task, evaluation.grid_side)] + [("point", place) for place in points]
    return [Start(group, replace(task.fixed, object_position=place, hand_position=_hand(task, evaluation, index)))
            for index, (group, place) in enumerate(places)]


def _hand(task: Task, evaluation: Evaluation, index: int) -> Vector:
    """Where the hand starts (metres) at one place of a grid: the same for every method and seed."""
    rng = np.random.default_rng([CONFIGURATION_STREAM, index, *task.name.encode()])
    if evaluation.factors == ANY_HAND:
        return task.hand_range.sample(rng)
    return hand_near(task, evaluation.hand_within, rng)


def grid(task: Task, side: int) -> list[tuple[float, float, float]]:
    """Centres of side x side equal cells over the object's range, x slowest (metres)."""
    low, high = task.object_range.low, task.object_range.high
    xs, ys = (low[axis] + (high[axis] - low[axis]) * (np.arange(side) + 0.5) / side for axis in (0, 1))
    return [(float(x), float(y), low[2]) for x in xs for y in ys]


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
        step: a failed grasp is told from a missed target), steps; and the task's other conditions by their names, each
        whether it held at some step.
    """
    task = task.variant(evaluation.fixed)
    listed, rows = starts(task, evaluation, own), []
    for first in range(0, len(listed), batch_size):
        batch = listed[first : first + batch_size]
        rollouts = roll_out(
            agent, task, [start.configuration for start in batch], observation,
            indices=None if indices is None else [index for index in range(len(batch)) if first + index in indices],
            on_ended=partial(_ended, on_step, len(listed), first) if on_step else None,
            callback=partial(_called, callback, first) if callback else None,
            in_motion=evaluation.factors if evaluation.starts == "moving" else None, first_index=first,
        )
        rows += [_row(first + rollout.index, batch[rollout.index], rollout) for rollout in rollouts]
    return rows


def _ended(on_step: Callable[[int, int], None], total: int, before: int, ended: int) -> None:
    on_step(before + ended, total)


def _called(callback: Callable[[int, Scene], None], before: int, index: int, scene: Scene) -> None:
    callback(before + index, scene)


def _row(index: int, start: Start, rollout: Rollout) -> dict:
    row = {"trial": index, "group": start.group, **start.configuration.columns(), "success": rollout.successes > 0,
           "success_steps": rollout.successes, "end_success": rollout.scene.success,
           "held": rollout.scene.phase == "place", "steps": rollout.scene.steps}
    return row | {name: steps > 0 for name, steps in rollout.scene.recorded_steps.items()}

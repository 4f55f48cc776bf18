"""Evaluation: fixed configurations, all episodes stepped together, one row an episode.

The configurations of a task and setting are the same for every method and seed, and come from a stream that no
training uses. What acts is in `agents.py`, the loop that steps the episodes in `rollout.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from move.learn.agents import Player
from move.learn.rollout import Played, roll_out
from move.sim.configuration import SpatialConfiguration
from move.sim.grasp_points import circle_points, sparse_points
from move.sim.scene.scene import Scene
from move.sim.tasks.task import Task

CONFIGURATION_STREAM = 2  # first word of the seed of the configurations
TOGETHER = 160  # episodes stepped together at most


class Evaluation(BaseModel):
    """Which configurations a policy is tried on."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    layout: Literal["random", "moving", "grid", "own", "grasp"] = Field(
        default="random",
        description="random configurations; 'moving': the same, all in motion as for MOVE; a grid over the object; "
        "or the policy's own demonstrations as they began ('own') or when they grasped ('grasp')"
    )
    episodes: int = Field(default=100, gt=0, description="number of configurations, unless they are a grid")
    grid_side: int = Field(default=12, gt=0, description="cells along a side of the grid")
    factors: str = Field(default="all", description="what is random; a grid varies the object alone")
    points: Literal["none", "sparse", "circle"] = Field(default="none", description="grasp points tried besides a grid")


@dataclass(frozen=True)
class Trial:
    """One configuration to be tried; `group` is "random", "moving", "own", "grasp", "grid" or "point"."""

    group: str
    configuration: SpatialConfiguration


def trials(task: Task, evaluation: Evaluation, own: Sequence[SpatialConfiguration] = ()) -> list[Trial]:
    """The fixed list of configurations of a task and setting; for "own" and "grasp" the list that is given.

    >>> from move.sim.tasks import get_task
    >>> len(trials(get_task("pick-place"), Evaluation(layout="grid", points="sparse")))
    153
    """
    if evaluation.layout in ("own", "grasp"):
        return [Trial(evaluation.layout, configuration) for configuration in own]
    if evaluation.layout in ("random", "moving"):
        rng = np.random.default_rng([CONFIGURATION_STREAM, *task.name.encode()])
        return [Trial(evaluation.layout, task.sample(rng, evaluation.factors)) for _ in range(evaluation.episodes)]
    places = {"none": [], "sparse": sparse_points(task), "circle": circle_points(task)}[evaluation.points]
    return [
        Trial(group, replace(task.fixed, object_position=place))
        for group, group_places in (("grid", grid(task, evaluation.grid_side)), ("point", places))
        for place in group_places
    ]


def grid(task: Task, side: int) -> list[tuple[float, float, float]]:
    """Centres of side x side equal cells over the object's range, x slowest (metres)."""
    low, high = task.object_range.low, task.object_range.high
    xs, ys = (low[axis] + (high[axis] - low[axis]) * (np.arange(side) + 0.5) / side for axis in (0, 1))
    return [(float(x), float(y), low[2]) for x in xs for y in ys]


def evaluate(
    player: Player,
    task: Task,
    evaluation: Evaluation,
    observation: str = "keypoints",
    image_size: int = 96,
    on_step: Callable[[int, int], None] | None = None,
    together: int = TOGETHER,
    own: Sequence[SpatialConfiguration] = (),
    only: Container[int] | None = None,
    watch: Callable[[int, Scene], None] | None = None,
) -> list[dict]:
    """Try `player` once on each configuration: at most 200 steps, ended by the tenth successful one.

    Args:
        on_step: called with (episodes ended, episodes in all).
        together: how many episodes are stepped together.
        own: the configurations of the layouts "own" and "grasp".
        only: numbers of the trials to be tried, the others are left out; by default all.
        watch: called with the trial's number and its scene at the start and after every step.

    Returns:
        One row an episode: trial (number), group, the whole configuration that was tried (as
        `SpatialConfiguration.columns` names it), success (at least one successful step, Meta-World's rule),
        success_steps (10 is the authors' rule for a demonstration), steps; for a task with a strict condition
        strict_success as well.
    """
    listed, rows = trials(task, evaluation, own), []
    for first in range(0, len(listed), together):
        batch = listed[first : first + together]
        played = roll_out(
            player, task, [trial.configuration for trial in batch], observation, image_size,
            only=None if only is None else [number for number in range(len(batch)) if first + number in only],
            on_ended=(lambda episodes, first=first: on_step(first + episodes, len(listed))) if on_step else None,
            watch=(lambda number, scene, first=first: watch(first + number, scene)) if watch else None,
            in_motion=evaluation.factors if evaluation.layout == "moving" else None, numbers_from=first,
        )
        rows += [_row(first + one.number, batch[one.number], one) for one in played]
    return rows


def _row(number: int, trial: Trial, played: Played) -> dict:
    row = {"trial": number, "group": trial.group, **trial.configuration.columns(), "success": played.successes > 0,
           "success_steps": played.successes, "steps": played.scene.steps}
    strict = played.scene.task.strict_success
    return row | {"strict_success": played.scene.strict_steps > 0} if strict else row

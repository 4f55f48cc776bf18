"""Which configurations an agent is tried on, as data: a fixed list a task and setting.

The configurations are the same for every method and seed, and come from a stream that no training uses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from move.choices import Place
from move.sim.collection import ANY_HAND
from move.sim.configuration import SpatialConfiguration, Vector
from move.sim.grasp_points import circle_points, hand_near, sparse_points
from move.sim.tasks.listed import listed_configurations
from move.sim.tasks.task import Task

CONFIGURATION_STREAM = 2  # first word of the seed of the configurations


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
    episodes: int = Field(default=100, gt=0, le=10**5,
                          description="number of configurations, unless they are a grid; of a list at most so many")
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
        return [Start("listed", configuration) for configuration in listed_configurations(task)[:evaluation.episodes]]
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

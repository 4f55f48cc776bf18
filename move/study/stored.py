"""What the file of a run of some spec holds: one row an episode, and where they came from, each of its type.

Read strictly, so that a file which somebody made or changed is refused, and not drawn.
"""

from __future__ import annotations

import json
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, NonNegativeFloat, NonNegativeInt, PositiveInt

from move.sim.grasp_points import CIRCLE_POINTS, SPARSE_SIDE
from move.sim.tasks.task import EPISODE_STEPS, SUCCESS_STEPS
from move.study.spec import OF_A_POLICY, RunSpec

STRICT = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, hide_input_in_errors=True)
OPEN = ConfigDict(strict=True, extra="allow", allow_inf_nan=False, hide_input_in_errors=True)
Steps = Annotated[int, Field(ge=0, le=EPISODE_STEPS)]
Rate = Annotated[float, Field(ge=0, le=1)]
PARTS = {"policy": {"collect", "train", "evaluate"}, "control": {"evaluate"}, "collector": {"collect"}}
POINTS = {"none": 0, "sparse": SPARSE_SIDE**2, "circle": CIRCLE_POINTS}


class Rows(BaseModel):
    """One value an episode in each column; those of the configuration are finite numbers, metres and radians."""

    model_config = OPEN
    __pydantic_extra__: dict[str, list[FiniteFloat]]

    trial: list[NonNegativeInt]
    group: list[str]
    success: list[bool]
    steps: list[Steps]
    success_steps: list[Annotated[int, Field(ge=0, le=SUCCESS_STEPS)]] | None = None
    end_success: list[bool] | None = None  # earlier versions had neither this nor held
    held: list[bool] | None = None
    strict_success: list[bool] | None = None
    metaworld_success: list[bool] | None = None
    jumps: list[NonNegativeInt] | None = None


class Collected(BaseModel):
    """The record of a collection; earlier versions had no starts, grasps and jumps."""

    model_config = OPEN

    attempts: PositiveInt
    demonstrations: PositiveInt
    timesteps: PositiveInt
    mean_steps: NonNegativeFloat
    generation_rate: Rate
    grasp_points: list[tuple[FiniteFloat, FiniteFloat]]
    seconds: NonNegativeFloat
    starts: dict[str, list[FiniteFloat]] | None = None
    grasps: dict[str, list[FiniteFloat]] | None = None
    jumps: list[NonNegativeInt] | None = None


class Trained(BaseModel):
    """What training did."""

    model_config = STRICT

    curve: Annotated[list[tuple[PositiveInt, FiniteFloat]], Field(min_length=1)]
    seconds: NonNegativeFloat
    precision: str
    parameters: PositiveInt


class Provenance(BaseModel):
    """Where the numbers came from; earlier versions named neither source nor accelerator nor CPU capability."""

    model_config = OPEN

    versions: dict[str, str]
    python: str
    processor: str
    cores: PositiveInt | None
    gl_renderer: str
    commit: str
    peak_memory_mb: int
    accelerator: str | None = None
    source: str | None = None
    cpu_capability: str | None = None


class Content(BaseModel):
    """A result's file without its digest."""

    model_config = STRICT

    spec: dict[str, Any]  # read by itself
    rows: Rows
    collection: Collected | None
    training: Trained | None
    seconds: dict[str, NonNegativeFloat]
    provenance: Provenance


def refuse_other_content(content: dict[str, Any], spec: RunSpec) -> None:
    """Refuse what a run of `spec` cannot have given.

    Raises:
        ValueError: one line that says what is wrong first; a pydantic.ValidationError for a wrong type.
    """
    found = Content.model_validate_json(json.dumps(content))
    for name, part in (("collection", found.collection), ("training", found.training)):
        if (spec.kind == "policy") != (part is not None):
            raise ValueError(f"{name}: not as a {spec.kind}'s")
    if set(found.seconds) != PARTS[spec.kind]:
        raise ValueError(f"seconds: of {', '.join(found.seconds) or 'nothing'}; a {spec.kind} has others")
    if found.collection and spec.collection and found.collection.timesteps != spec.collection.timesteps:
        raise ValueError("collection: of another budget")
    if found.training and spec.training and found.training.curve[-1][0] != spec.training.gradient_steps:
        raise ValueError("training: the curve does not end at the last gradient step")
    _refuse_other_rows(found.rows, spec, found.collection.demonstrations if found.collection else 0)


def _refuse_other_rows(rows: Rows, spec: RunSpec, demonstrations: int) -> None:
    groups = expected_groups(spec, demonstrations)
    for name, column in rows:
        if column is not None and len(column) != len(groups):
            raise ValueError(f"rows: {len(column)} values of {name} given; this run has {len(groups)}")
    if rows.trial != list(range(len(groups))):
        raise ValueError("rows: trial is not 0, 1, 2, ...")
    if rows.group != groups:
        raise ValueError(f"rows: other groups than {', '.join(dict.fromkeys(groups))} in this run's order")
    if (rows.success_steps is None) != (spec.kind == "collector"):
        raise ValueError("rows: no success_steps, or some of a collector")
    if rows.success_steps is not None and rows.success != [steps > 0 for steps in rows.success_steps]:
        raise ValueError("rows: success does not fit success_steps")


def expected_groups(spec: RunSpec, demonstrations: int) -> list[str]:
    """The group of each row that a run of `spec` has, if its policy learnt from so many demonstrations.

    >>> from move.learn.evaluation import Evaluation
    >>> from move.study.spec import ControlRun
    >>> expected_groups(ControlRun(task="push", seed=0, agent="expert", evaluation=Evaluation(episodes=2)), 0)
    ['random', 'random']
    """
    tried = spec.evaluation
    if spec.kind == "collector":
        return ["attempt"] * tried.episodes
    if tried.starts == "grid":
        return ["grid"] * tried.grid_side**2 + ["point"] * POINTS[tried.points]
    if tried.starts in OF_A_POLICY:
        return [tried.starts] * min(tried.episodes, demonstrations)
    return [tried.starts] * tried.episodes

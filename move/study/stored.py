"""The file of a result: its digest, then what the spec does not say, each of its type.

    {"digest": "...", "spec": ..., "rows": ..., "collection": ..., "training": ..., "seconds": ..., "provenance": ...}

`digest` is the sha256 of the bytes that follow it. What follows from the spec is left out: the number of an episode,
its group, its success where its successful steps are counted, and, as null, a column of the configuration that
`starts` gives. Of a collection's record a value that all demonstrations share is stored once, and the grasps without
the object's x and y, which are the grasp points, rounded. A file made or changed by hand is refused, not drawn.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, NonNegativeFloat, NonNegativeInt, PositiveInt

from move.learn.evaluation import Evaluation, starts
from move.sim.grasp_points import CIRCLE_POINTS, SPARSE_SIDE
from move.sim.tasks import get_task
from move.sim.tasks.listed import COUNT
from move.sim.tasks.task import EPISODE_STEPS, SUCCESS_STEPS
from move.study.spec import OF_A_POLICY, AnyRun, RunSpec

STRICT = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, hide_input_in_errors=True)
OPEN = ConfigDict(strict=True, extra="allow", allow_inf_nan=False, hide_input_in_errors=True)
Steps = Annotated[int, Field(ge=0, le=EPISODE_STEPS)]
Rate = Annotated[float, Field(ge=0, le=1)]
Point = Annotated[list[FiniteFloat], Field(min_length=2, max_length=2)]
PARTS = {"policy": {"collect", "train", "evaluate"}, "control": {"evaluate"}, "collector": {"collect"}}
POINTS = {"none": 0, "sparse": SPARSE_SIDE**2, "circle": CIRCLE_POINTS}
DIGEST = re.compile(rb'\{"digest":"([0-9a-f]{64})",')


class Rows(BaseModel):
    """One value an episode in each column; those of the configuration are finite numbers, metres and radians."""

    model_config = OPEN
    __pydantic_extra__: dict[str, list[FiniteFloat] | None]

    steps: list[Steps]
    success: list[bool] | None = None
    success_steps: list[Annotated[int, Field(ge=0, le=SUCCESS_STEPS)]] | None = None
    end_success: list[bool] | None = None  # earlier versions had neither this nor held
    held: list[bool] | None = None
    strict_success: list[bool] | None = None
    metaworld_success: list[bool] | None = None
    jumps: list[NonNegativeInt] | None = None


class Collected(BaseModel):
    """The record of a collection; earlier versions had no starts, grasps, jumps and shares covered."""

    model_config = OPEN

    attempts: PositiveInt
    demonstrations: PositiveInt
    timesteps: PositiveInt
    mean_steps: NonNegativeFloat
    generation_rate: Rate
    grasp_points: list[Point]
    seconds: NonNegativeFloat
    starts: dict[str, list[FiniteFloat] | FiniteFloat] | None = None
    grasps: dict[str, list[FiniteFloat] | FiniteFloat] | None = None
    jumps: list[NonNegativeInt] | None = None
    covered: dict[str, dict[str, Rate]] | None = None  # by number of timesteps, see move.sim.coverage.covered


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

    spec: AnyRun
    rows: Rows
    collection: Collected | None
    training: Trained | None
    seconds: dict[str, NonNegativeFloat]
    provenance: Provenance


def to_text(spec: RunSpec, rows: list[dict], content: Mapping[str, Any]) -> str:
    """The file of a result.

    Args:
        rows: one an episode, all with the same columns.
        content: its collection, training, seconds and provenance.
    """
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    known = configurations(spec)
    stored = {name: None if column == known.get(name) else column for name, column in columns.items()
              if name not in ("trial", "group") and not (name == "success" and "success_steps" in columns)}
    return with_digest({**content, "spec": spec.model_dump(mode="json"), "rows": stored,
                        "collection": content["collection"] and _shortened(content["collection"])})


def with_digest(content: Mapping[str, Any]) -> str:
    """The content of a result's file as its text."""
    body = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return f'{{"digest":"{hashlib.sha256(body.encode()).hexdigest()}",{body[1:]}\n'


def _shortened(record: dict[str, Any]) -> dict[str, Any]:
    short = {name: {column: values[0] if len(values) > 1 and len(set(values)) == 1 else values
                    for column, values in record[name].items()} for name in ("starts", "grasps") if record.get(name)}
    if "grasps" in short and _places(record["grasp_points"]).items() <= record["grasps"].items():
        del short["grasps"]["object_x"], short["grasps"]["object_y"]
    return record | short


def _places(points: list[Any]) -> dict[str, list[float]]:
    """Grasp points (x, y) in metres as columns of a configuration, to a micrometre."""
    return {f"object_{axis}": [round(point[place], 6) for point in points] for place, axis in enumerate("xy")}


def from_bytes(raw: bytes) -> tuple[RunSpec, list[dict], dict[str, Any]]:
    """What `to_text` was given.

    Raises:
        ValueError: one line that says what is wrong first: it does not fit its digest, or a run of its spec cannot have
            given it; a pydantic.ValidationError where it is no JSON or a value is of another type.
    """
    found = DIGEST.match(raw)
    body = b"{" + raw[found.end():].rstrip() if found else raw
    if found is None or hashlib.sha256(body).hexdigest() != found[1].decode():
        raise ValueError("its content does not fit its digest")
    content = Content.model_validate_json(body)
    spec, record = content.spec, content.collection
    for name, part in (("collection", record), ("training", content.training)):
        if (spec.kind == "policy") != (part is not None):
            raise ValueError(f"{name}: not as a {spec.kind}'s")
    if set(content.seconds) != PARTS[spec.kind]:
        raise ValueError(f"seconds: of {', '.join(content.seconds) or 'nothing'}; a {spec.kind} has others")
    if record and spec.collection:
        most, budget = spec.collection.demonstrations, spec.collection.timesteps
        ends = record.demonstrations == most  # with its last demonstration, if the budget was not full before
        if not (record.timesteps == budget or ends and record.timesteps < budget):
            raise ValueError("collection: of another budget")
    if content.training and spec.training and content.training.curve[-1][0] != spec.training.gradient_steps:
        raise ValueError("training: the curve does not end at the last gradient step")
    columns = _columns(content.rows, spec, record.demonstrations if record else 0)
    rows = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    parts = content.model_dump(mode="json", exclude_unset=True, exclude={"spec", "rows"})
    if record:
        parts["collection"] = _whole(parts["collection"])
    return spec, rows, parts


def _whole(record: dict[str, Any]) -> dict[str, Any]:
    for name, count in (("starts", record["demonstrations"]), ("grasps", len(record["grasp_points"]))):
        if record.get(name) is not None:
            record[name] = {column: values if isinstance(values, list) else [values] * count
                            for column, values in record[name].items()}
    if record.get("grasps") is not None:
        record["grasps"] = _places(record["grasp_points"]) | record["grasps"]
    return record


def _columns(rows: Rows, spec: RunSpec, demonstrations: int) -> dict[str, list]:
    """The columns of a run's rows by name, those that follow from its spec among them."""
    groups, known = expected_groups(spec, demonstrations), configurations(spec)
    columns: dict[str, Any] = {name: known.get(name) if column is None else column
                               for name, column in rows if name in rows.model_fields_set}
    if (rows.success_steps is None) != (spec.kind == "collector"):
        raise ValueError("rows: no success_steps, or some of a collector")
    if rows.success_steps is not None:
        columns["success"] = [steps > 0 for steps in rows.success_steps]
    for name, column in {"success": None, **columns}.items():
        if column is None:
            raise ValueError(f"rows: {name} is left out, which the spec does not say")
        if len(column) != len(groups):
            raise ValueError(f"rows: {len(column)} values of {name} given; this run has {len(groups)}")
    filled: dict[str, list] = {**columns, "group": groups, "trial": list(range(len(groups)))}
    return {name: filled[name] for name in sorted(filled)}


def configurations(spec: RunSpec) -> dict[str, list[float]]:
    """The columns of the configurations tried, where the spec alone says them.

    It does not where a policy's own demonstrations began, nor of hands near their place, whose limits MuJoCo knows.
    """
    tried = spec.evaluation
    given = spec.kind == "collector" or tried.starts in OF_A_POLICY or tried.hand_within > 0
    return {} if given else _configurations(spec.task, tried)


@cache
def _configurations(task: str, tried: Evaluation) -> dict[str, list[float]]:
    rows = [start.configuration.columns() for start in starts(get_task(task).variant(tried.fixed), tried)]
    return {name: [row[name] for row in rows] for name in rows[0]}


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
    if tried.starts == "listed":
        return ["listed"] * min(tried.episodes, COUNT)
    if tried.starts in OF_A_POLICY:
        return [tried.starts] * min(tried.episodes, demonstrations)
    return [tried.starts] * tried.episodes

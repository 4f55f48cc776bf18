"""A figure's parameters: what its functions take by keyword, their defaults, and the runs that they ask for."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from difflib import get_close_matches
from functools import cache
from typing import Annotated, Any, Literal, get_type_hints

from pydantic import AfterValidator, BaseModel, Field, ValidationError, create_model

from move.errors import BadInput, one_of
from move.figures import load, names
from move.sim.methods import METHODS, get_method
from move.sim.tasks import get_task
from move.study.labels import LabelledRun, distinct
from move.study.profiles import Profile, load_profile
from move.study.spec import RunSpec, run_spec_from_json
from move.validation import first_problem

Count = Annotated[int, Field(gt=0, le=10**8, strict=True)]  # of timesteps, episodes
Counts = Annotated[tuple[Count, ...], Field(min_length=1)]
Repeats = Annotated[int, Field(gt=0, le=100, strict=True)]
Seeds = Annotated[int, Field(ge=0, le=100, strict=True)]
RandomSeed = Annotated[int, Field(ge=0, lt=2**32, strict=True)]
Multiple = Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
Pixels = Annotated[int, Field(ge=16, le=512, strict=True)]
Frames = Annotated[int, Field(ge=2, le=100, strict=True)]
Observation = Literal["rgb", "keypoints"]
TaskName = Annotated[str, AfterValidator(lambda name: get_task(name).name)]
MethodName = Annotated[str, AfterValidator(lambda name: get_method(name).name)]
ProfileName = Annotated[str, AfterValidator(lambda name: load_profile(name).name)]

MOTIONS = tuple(field for field in METHODS["move"].settings if field != "motions")  # what `motions` may choose


def _of_moves_motions(chosen: dict[str, Any]) -> dict[str, Any]:
    for name in chosen:
        one_of("motions", name, MOTIONS)
    return chosen


SHARED: dict[str, tuple[Any, Any]] = {
    "task": (Annotated[str, AfterValidator(lambda name: name and get_task(name).name)], ""),
    "first_seed": (Annotated[int, Field(ge=0, le=10**6, strict=True)], 0),
    "motions": (Annotated[dict[str, Any], AfterValidator(_of_moves_motions)], {}),
}
"""What every figure that trains has besides its own parameters, with its type and default.

    task        the task of all runs in place of the figure's own; of a figure of several tasks that one alone
    first_seed  added to the number of each repetition, so that others are trained
    motions     fields of `Collection` for MOVE's demonstrations where the figure itself chooses none, as a profile's
                `collection` has them: {"object_speed": 0.05}
"""
SPEED_WORDS = ("v_max", "omega_max", "speed", "object_speed", "target_speed", "camera_speed", "yaw_speed", "speed_law",
               "moving", "law")
PARTS = ("runs", "seen", "tables", "draw", "answer", "source", "printed")
"""The functions of a figure's file, in the order in which they are called; all but `tables` may be left out."""
LONGEST = 100  # values of one parameter


def parts(name: str) -> dict[str, Callable[..., Any]]:
    """The functions of a figure's file, by their names."""
    return {part: getattr(load(name), part) for part in PARTS if hasattr(load(name), part)}


def with_runs() -> list[str]:
    """The figures that are made of runs."""
    return [name for name in names() if "runs" in parts(name)]


def _arguments(function: Callable[..., Any]) -> Iterator[inspect.Parameter]:
    """What a part of a figure takes of its parameters: all but the first argument of `runs`, else by keyword alone."""
    listed = list(inspect.signature(function).parameters.values())
    return iter(listed[1:] if function.__name__ == "runs" else [one for one in listed if one.kind is one.KEYWORD_ONLY])


@cache
def _model(name: str) -> type[BaseModel]:
    fields: dict[str, Any] = {}
    for function in parts(name).values():
        hints = get_type_hints(function, include_extras=True)
        fields |= {one.name: (hints[one.name], one.default) for one in _arguments(function)
                   if one.default is not one.empty}
    if trains(name):
        fields = {**{key: one for key, one in SHARED.items() if key not in fields}, **fields}
        fields = {key: fields[key] for key in sorted(fields, key=lambda key: key in SHARED)}
    return create_model("Parameters", **fields)


def trains(name: str) -> bool:
    """Whether a figure trains policies: all that have runs, but those whose file says `TRAINS = False`."""
    return "runs" in parts(name) and getattr(load(name), "TRAINS", True)


@cache
def extras(name: str) -> tuple[str, ...]:
    """The parameters of a figure that are numbers of further repetitions, next to `seeds`."""
    hints = get_type_hints(parts(name)["runs"], include_extras=True) if "runs" in parts(name) else {}
    return tuple(key for key, kind in hints.items() if key != "seeds" and kind in (Seeds, Repeats))


def with_extras(name: str, own: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """`given`, with fewer further repetitions where `seeds` is fewer than the figure's own: at most as many.

    Those that are given another number than their own stay as they are.
    """
    seeds, usual = given.get("seeds"), own.get("seeds")
    fewer = isinstance(seeds, int) and isinstance(usual, int) and 0 < seeds < usual
    return {**given, **{key: min(own[key], seeds) for key in extras(name)
                        if fewer and given.get(key, own[key]) == own[key]}}


def defaults(name: str) -> dict[str, Any]:
    """The parameters of a figure, with their defaults.

    Raises:
        BadInput: an unknown figure.
    """
    return {key: field.default for key, field in _model(name).model_fields.items()}


def texts(name: str) -> set[str]:
    """The parameters of a figure that are texts, and whose values are taken as they stand."""
    return {key for key, value in defaults(name).items() if isinstance(value, str)}


def refuse_unknown(name: str, given: Mapping[str, Any], where: str = "") -> None:
    """Refuse what a figure has no parameter for.

    Raises:
        BadInput: there is such a one.
    """
    if unknown := sorted(set(given) - set(defaults(name))):
        allowed = ", ".join(defaults(name)) or "none"
        near = "".join(filter(None, (_nearest_way(name, one) for one in unknown)))
        raise BadInput(f"{where}{name} has no parameter {', '.join(unknown)}{near}; allowed are {allowed}")


def _nearest_way(name: str, unknown: str) -> str:
    """How a figure is given what an unknown parameter seems to mean; empty where nothing is near."""
    known = defaults(name)
    if unknown in SPEED_WORDS and "motions" in known:
        field = unknown if unknown in MOTIONS else "object_speed"
        usual = "0.02" if field.startswith(("cam", "yaw")) else "0.05"
        value = {"speed_law": "uniform", "moving": "[object]"}.get(field, usual)
        varied = "; fig7_speed varies speeds" * (name != "fig7_speed" and "speed" in field)
        return f" (nearest: motions={{{field}: {value}}}{varied})"
    ways = {"seed": ("first_seed", "seed"), "tasks": ("task",), "task": ("tasks",), "budget": ("timesteps",),
            "trials": ("episodes",), "seeds": ("first_seed", "seed")}
    near = [way for way in ways.get(unknown, ()) if way in known] or get_close_matches(unknown, known, 1)
    return f" (nearest: {near[0]})" if near else ""


def parameters(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """All parameters of a figure: its own defaults, what the profile's YAML changes, then `changes`, all checked.

    Raises:
        BadInput: an unknown figure or parameter, or a value that is not allowed.
    """
    changed = profile.notebooks.get(name, {})
    refuse_unknown(name, changed, f"profile {profile.name}: ")
    refuse_unknown(name, changes or {})
    own = {key: _limited(value, profile.limits.get(key)) for key, value in defaults(name).items()}
    if own.get("observation") not in (None, *profile.observations):
        own["observation"] = "keypoints"
    own |= changed
    given = with_extras(name, own, {**own, **(changes or {})})
    try:
        for key, value in given.items():
            _check_values(key, value)
        return dict(_model(name).model_validate(given))
    except ValidationError as error:
        raise BadInput(f"{name}: {first_problem(error)}") from error
    except BadInput as problem:
        raise BadInput(f"{name}: {problem}") from problem


def call(name: str, part: str, chosen: Mapping[str, Any], *arguments: Any) -> Any:
    """Call one function of a figure's file with those of its chosen parameters that it takes."""
    function = parts(name)[part]
    return function(*arguments, **{one.name: chosen[one.name] for one in _arguments(function)})


def runs(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> list[LabelledRun]:
    """The labelled runs of a figure in `profile`, with `changes` of its parameters; none of one that needs none.

    Raises:
        BadInput: an unknown figure or parameter, or a value that is not allowed.
    """
    return labelled_runs(name, profile, parameters(name, profile, changes))


def labelled_runs(name: str, profile: Profile, chosen: Mapping[str, Any]) -> list[LabelledRun]:
    """The labelled runs of a figure with parameters that are checked.

    Raises:
        BadInput: a task that its runs cannot have.
    """
    if "runs" not in parts(name):
        return []
    if chosen.get("motions"):
        motions = {**profile.collection.get("move", {}), **chosen["motions"]}
        profile = profile.model_copy(update={"collection": {**profile.collection, "move": motions}})
    task, own = (chosen["task"], defaults(name)["task"]) if trains(name) else ("", "")
    if task and not own:
        chosen = {key: _of_task(key, value, task) for key, value in chosen.items()}
    runs = call(name, "runs", chosen, profile)
    if task and not own:
        several = len({run.spec.task for run in runs}) > 1
        runs = [_as_task(run, task) for run in runs if not several or run.spec.task == task]
        if not runs:
            raise BadInput(f"{name}: task {task} given; allowed are its own tasks")
    first = chosen.get("first_seed", 0)
    return [_later(run, first) for run in runs] if first else runs


def other_task(name: str, profile: Profile, chosen: Mapping[str, Any]) -> tuple[str, str] | None:
    """The one task of which a figure is made, and the other one that is chosen in its place; None without such."""
    if not trains(name) or "tasks" in defaults(name):
        return None
    own = defaults(name)["task"]
    usual = {own} if own else {run.spec.task for run in labelled_runs(name, profile, {**chosen, "task": ""})}
    task = chosen["task"] or own
    return (usual.pop(), task) if len(usual) == 1 and task and task not in usual else None


def _of_task(key: str, value: Any, task: str) -> Any:
    """A figure's list of tasks with one task alone; in a list for some of its tasks only if it is one of them."""
    if not key.endswith("tasks"):
        return value
    return (task,) if key in ("tasks", "pixel_tasks") or task in value else ()


def _as_task(run: LabelledRun, task: str) -> LabelledRun:
    """The same run of another task; where its authors' places are not known, with the package's."""
    if run.spec.task == task:
        return run
    content = json.loads(run.spec.model_dump_json(exclude_defaults=True)) | {"task": task}
    if collection := content.get("collection"):
        collection["task"] = task
        if get_task(task).authors_fixed is None:
            for part in (collection, content["evaluation"]):
                part.pop("fixed", None)
    try:
        spec = run_spec_from_json(json.dumps({"player": run.spec.agent, **content}))
    except ValidationError as error:
        raise BadInput(f"task: {task} given; {first_problem(error)}") from error
    return replace(run, spec=spec, labels={key: task if value == run.spec.task else value
                                           for key, value in run.labels.items()})


def _later(run: LabelledRun, first: int) -> LabelledRun:
    """Another repetition of a policy's run."""
    if not run.spec.training:
        return run
    labels = {key: run.spec.seed + first if key == "seed" else value for key, value in run.labels.items()}
    return replace(run, spec=run.spec.model_copy(update={"seed": run.spec.seed + first}), labels=labels)


def specs(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> list[RunSpec]:
    """The same runs without their labels, each once."""
    return [run.spec for run in distinct(runs(name, profile, changes))]


def _limited(value: Any, limit: int | None) -> Any:
    """A number, or each of several, but at most `limit`."""
    if limit is None:
        return value
    return tuple(dict.fromkeys(min(one, limit) for one in value)) if isinstance(value, tuple) else min(value, limit)


def _check_values(name: str, value: Any) -> None:
    """Refuse what a parameter's type does not tell: a value of a list twice, too many of them, an unknown task."""
    values = value if isinstance(value, (list, tuple)) else [value]
    if len(values) > LONGEST:
        raise BadInput(f"{name}: {len(values)} values given; allowed are {LONGEST}")
    kinds = [each if isinstance(each, (int, float, str)) else repr(each) for each in values]
    if len(set(kinds)) < len(kinds):
        twice = next(each for each in kinds if kinds.count(each) > 1)
        raise BadInput(f"{name}: {str(twice)[:60]} given twice; allowed is once")
    if name == "task" or name.endswith("tasks"):
        for task in (each for each in values if isinstance(each, str) and (each or name != "task")):
            try:
                get_task(task)
            except BadInput as problem:
                raise BadInput(f"{name}: {str(problem).removeprefix('task: ')}") from problem

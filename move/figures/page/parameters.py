"""A figure's parameters: what its functions take by keyword, their defaults, and the runs that they ask for."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Annotated, Any, Literal, get_type_hints

from pydantic import AfterValidator, BaseModel, Field, ValidationError, create_model

from move.errors import BadInput
from move.figures import load, names
from move.sim.methods import get_method
from move.sim.tasks import get_task
from move.study.labels import LabelledRun
from move.study.profiles import Profile, load_profile
from move.study.spec import RunSpec
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
    return create_model("Parameters", **fields)


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
        raise BadInput(f"{where}{name} has no parameter {', '.join(unknown)}; allowed are {allowed}")


def parameters(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """All parameters of a figure: its own defaults, what the profile's YAML changes, then `changes`, all checked.

    Raises:
        BadInput: an unknown figure or parameter, or a value that is not allowed.
    """
    changed = profile.parameters(name)
    refuse_unknown(name, changed, f"profile {profile.name}: ")
    refuse_unknown(name, changes or {})
    own = {key: _limited(value, profile.limits.get(key)) for key, value in defaults(name).items()}
    if own.get("observation") not in (None, *profile.observations):
        own["observation"] = "keypoints"
    given = {**own, **changed, **(changes or {})}
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
    chosen = parameters(name, profile, changes)
    return call(name, "runs", chosen, profile) if "runs" in parts(name) else []


def specs(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> list[RunSpec]:
    """The same runs without their labels."""
    return [run.spec for run in runs(name, profile, changes)]


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
        for task in (each for each in values if isinstance(each, str)):
            try:
                get_task(task)
            except BadInput as problem:
                raise BadInput(f"{name}: {str(problem).removeprefix('task: ')}") from problem

"""The experiments by name: a decorator that registers one and checks its arguments, and its runs in a profile."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, validate_call

from move.errors import BadInput
from move.sim.tasks import get_task
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.spec import RunSpec
from move.validation import first_problem

Count = Annotated[int, Field(gt=0, le=10**8, strict=True)]  # of timesteps, episodes
Counts = Annotated[tuple[Count, ...], Field(min_length=1)]
Repeats = Annotated[int, Field(gt=0, le=100, strict=True)]
Multiple = Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)]
Seeds = Annotated[int, Field(ge=0, le=100, strict=True)]
Observation = Literal["rgb", "keypoints"]
Experiment = Callable[..., list[LabelledRun]]

EXPERIMENTS: dict[str, Experiment] = {}
LONGEST = 100  # values of one parameter


def experiment(function: Experiment) -> Experiment:
    """Register an experiment under its name, and check its arguments by their annotations.

    Its first argument is the Profile. What does not fit is BadInput, in one line.
    """
    validated = validate_call(function)

    @functools.wraps(function)
    def call(*arguments: Any, **keywords: Any) -> list[LabelledRun]:
        for name, value in keywords.items():
            try:
                check_values(name, value)
            except BadInput as problem:
                raise BadInput(f"{function.__name__}: {problem}") from problem
        try:
            return validated(*arguments, **keywords)
        except ValidationError as error:
            raise BadInput(f"{function.__name__}: {first_problem(error)}") from error

    EXPERIMENTS[function.__name__] = call
    return call


def check_values(name: str, value: Any) -> None:
    """Refuse what a parameter's type does not tell: a value of a list twice, too many of them, an unknown task.

    Raises:
        BadInput: one of these.
    """
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


def defaults(name: str) -> dict[str, Any]:
    """The parameters of an experiment and their defaults, without the profile.

    Raises:
        BadInput: an unknown experiment.
    """
    if name not in EXPERIMENTS:
        raise BadInput(f"figure: {name!r} given; allowed are {', '.join(EXPERIMENTS)}")
    found = inspect.signature(EXPERIMENTS[name]).parameters
    return {key: parameter.default for key, parameter in found.items() if key != "profile"}


def parameters(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The parameters of an experiment: the function's own defaults, what the profile's YAML changes, then `changes`.

    Raises:
        BadInput: an unknown experiment or parameter.
    """
    own, changed = defaults(name), profile.parameters(name)
    for where, given in ((f"profile {profile.name}: ", changed), ("", changes or {})):
        if unknown := set(given) - set(own):
            raise BadInput(f"{where}{name} has no parameter {', '.join(sorted(unknown))}; "
                           f"allowed are {', '.join(own)}")
    return {**own, **changed, **(changes or {})}


def runs(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> list[LabelledRun]:
    """The labelled runs of an experiment in `profile`, with `changes` of its parameters.

    Raises:
        BadInput: an unknown experiment or parameter, or a value that is not allowed.
    """
    chosen = parameters(name, profile, changes)
    return EXPERIMENTS[name](profile, **chosen)


def specs(name: str, profile: Profile, changes: Mapping[str, Any] | None = None) -> list[RunSpec]:
    """The same runs without their labels."""
    return [run.spec for run in runs(name, profile, changes)]

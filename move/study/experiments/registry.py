"""The experiments by name: a decorator that registers one and checks its arguments, and its runs in a profile."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, validate_call

from move.errors import BadInput
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.spec import RunSpec
from move.validation import first_problem

Count = Annotated[int, Field(gt=0, strict=True)]
Multiple = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Seeds = Annotated[int, Field(ge=0, strict=True)]
Observation = Literal["rgb", "keypoints"]
Experiment = Callable[..., list[LabelledRun]]

EXPERIMENTS: dict[str, Experiment] = {}


def experiment(function: Experiment) -> Experiment:
    """Register an experiment under its name, and check its arguments by their annotations.

    Its first argument is the Profile. What does not fit is BadInput, in one line.
    """
    validated = validate_call(function)

    @functools.wraps(function)
    def call(*arguments: Any, **keywords: Any) -> list[LabelledRun]:
        try:
            return validated(*arguments, **keywords)
        except ValidationError as error:
            raise BadInput(f"{function.__name__}: {first_problem(error)}") from error

    EXPERIMENTS[function.__name__] = call
    return call


def defaults(name: str) -> dict[str, Any]:
    """The parameters of an experiment and their defaults, without the profile.

    Raises:
        BadInput: an unknown experiment.
    """
    if name not in EXPERIMENTS:
        raise BadInput(f"figure: {name!r} given; allowed are {', '.join(EXPERIMENTS)}")
    found = inspect.signature(EXPERIMENTS[name]).parameters
    return {key: parameter.default for key, parameter in found.items() if key != "profile"}


def parameters(name: str, profile: Profile) -> dict[str, Any]:
    """The parameters of an experiment in `profile`: the function's own defaults and what the YAML changes.

    Raises:
        BadInput: an unknown experiment or parameter.
    """
    own, changed = defaults(name), profile.parameters(name)
    if unknown := set(changed) - set(own):
        raise BadInput(f"profile {profile.name}: {name} has no parameter {', '.join(sorted(unknown))}; "
                       f"allowed are {', '.join(own)}")
    return {**own, **changed}


def runs(name: str, profile: Profile) -> list[LabelledRun]:
    """The labelled runs of an experiment in `profile`.

    Raises:
        BadInput: an unknown experiment or parameter, or a value that is not allowed.
    """
    chosen = parameters(name, profile)
    return EXPERIMENTS[name](profile, **chosen)


def specs(name: str, profile: Profile) -> list[RunSpec]:
    """The same runs without their labels."""
    return [run.spec for run in runs(name, profile)]

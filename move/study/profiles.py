"""Profiles: one YAML file each under profiles/, with the recipes and each notebook's parameters."""

from __future__ import annotations

import math
from typing import Any, Self

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, PositiveInt, ValidationError, model_validator

from move.errors import BadInput
from move.learn.settings import Training
from move.machine import gl_problem
from move.paths import PROFILES
from move.sim.collection import Method
from move.sim.observe import IMAGE_SIZE
from move.validation import first_problem


class Profile(BaseModel):
    """The settings that all figures of one profile share, and the parameters of each notebook."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    name: str = Field(default="", description="the file's, without its ending")
    purpose: str = Field(description="one sentence that every picture of the profile carries")
    stamp: str = Field(
        default="", description="written across every picture of a profile that proves nothing, whose results stay out "
        "of git"
    )
    shipped: bool = Field(default=False, description="whether its figures and tables are those in git")
    shares_results: str = Field(
        default="", description="the profile in whose folder its results are kept; left out: in its own"
    )
    image_size: int = Field(default=IMAGE_SIZE, ge=16, le=512, description="pixels along a side")
    collection: dict[Method, dict[str, Any]] = Field(
        default_factory=dict, description="by method: fields of Collection that its runs have where an experiment "
        "chooses none"
    )
    training: dict[str, Training] = Field(description="the recipe for each observation, alike for all methods")
    gradient_steps: dict[str, dict[PositiveInt, PositiveInt]] = Field(
        default_factory=dict, description="by observation: gradient steps for so many timesteps of data"
    )
    notebooks: dict[str, dict[str, Any]] = Field(description="parameters that differ from the notebook's own")
    without_gl: dict[str, dict[str, Any]] = Field(default_factory=dict, description="the same, where nothing can draw")
    minutes: dict[str, float] = Field(default_factory=dict, description="core-minutes of a run, by observation")

    @model_validator(mode="after")
    def _steps_begin_with_the_recipes_own(self) -> Self:
        for observation, steps in self.gradient_steps.items():
            own = self.training[observation].gradient_steps if observation in self.training else "no such recipe"
            if not steps or steps[min(steps)] != own:
                raise ValueError(f"gradient_steps {observation}: smallest budget must have what training has, {own}")
        return self

    def parameters(self, notebook: str) -> dict[str, Any]:
        """What this profile changes in `notebook`, on this machine."""
        changed = self.notebooks.get(notebook, {})
        return {**changed, **self.without_gl.get(notebook, {})} if gl_problem() else changed

    def recipe(self, observation: str, timesteps: int) -> Training:
        """How policies that see `observation` are built and trained on so many timesteps.

        Between two entries of `gradient_steps` its gradient steps lie on a straight line, above the last they grow in
        proportion to the data, and below the first they stay. Without entries they are the recipe's own.

        Raises:
            BadInput: the profile has no such recipe.
        """
        if observation not in self.training:
            raise BadInput(f"observation: {observation!r} given; this profile has {', '.join(self.training)}")
        recipe, chosen = self.training[observation], sorted(self.gradient_steps.get(observation, {}).items())
        if not chosen:
            return recipe
        budgets, steps = zip(*chosen, strict=True)
        beyond = max(1.0, timesteps / budgets[-1])
        return recipe.model_copy(update={"gradient_steps": math.ceil(beyond * np.interp(timesteps, budgets, steps))})


def names() -> list[str]:
    """The profiles that exist."""
    return sorted(path.stem for path in PROFILES.glob("*.yaml"))


def read_yaml(path) -> Any:
    """A YAML file's content.

    Raises:
        BadInput: not YAML, or a number like 1e-4, which YAML reads as text.
    """
    try:
        content = yaml.safe_load(path.read_text())
    except (OSError, yaml.YAMLError) as error:
        raise BadInput(f"{path}: not readable as YAML: {' '.join(str(error).split())}") from error
    refuse_text_numbers(content, str(path))
    return content


def refuse_text_numbers(content: Any, where: str) -> None:
    """Refuse texts that were meant as numbers, such as 1e-4.

    Raises:
        BadInput: such a text; the message says how to write it.
    """
    if isinstance(content, dict):
        for key, value in content.items():
            refuse_text_numbers(value, f"{where}: {key}")
    elif isinstance(content, list):
        for value in content:
            refuse_text_numbers(value, where)
    elif isinstance(content, str):
        try:
            number = float(content)
        except ValueError:
            return
        raise BadInput(f"{where}: {content!r} is text to YAML; write the number as {number!r} or like 1.0e-4")


def load_profile(name: str) -> Profile:
    """The profile called `name`, read from its file.

    Raises:
        BadInput: no such profile, or a setting that is wrong; the message says which.
    """
    if name not in names():
        raise BadInput(f"profile: {name!r} given; allowed are {', '.join(names())} (files under {PROFILES})")
    path = PROFILES / f"{name}.yaml"
    try:
        content = read_yaml(path)
        return Profile.model_validate(content | {"name": name} if isinstance(content, dict) else content)
    except ValidationError as error:
        raise BadInput(f"{path}: {first_problem(error)}") from error

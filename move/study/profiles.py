"""Profiles: one YAML file each under profiles/, with the recipes and each notebook's parameters."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from move import paths, yaml_text
from move.errors import BadInput
from move.learn.settings import Training
from move.machine import gl_problem
from move.paths import IN_CHECKOUT, NOTEBOOKS, PROFILES
from move.sim.collection import Collection
from move.sim.methods import METHODS
from move.sim.observe import IMAGE_SIZE, ObservationKind
from move.validation import first_problem

Budget = Annotated[int, Field(gt=0, le=10**8)]  # timesteps
Steps = Annotated[int, Field(gt=0, le=10**7)]
CHOSEN_ELSEWHERE = ("task", "method", "timesteps", "observation")  # of a collection: by the experiment
Minutes = Annotated[float, Field(gt=0, le=10**6, allow_inf_nan=False)]


class NoRecipe(BadInput):
    """A profile does not say how policies that see so are trained."""


class Profile(BaseModel):
    """The settings that all figures of one profile share, and the parameters of each notebook."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    name: str = Field(default="", description="the file's, without its ending")
    purpose: str = Field(description="one sentence that every figure of the profile carries")
    stamp: str = Field(
        default="", description="written across every figure of a profile that proves nothing, whose results stay out "
        "of git"
    )
    shipped: bool = Field(default=False, description="whether its figures and tables are those in git")
    shares_results: str = Field(
        default="", pattern=r"^[\w-]*$",
        description="the profile in whose folder its results are kept; left out: in its own"
    )
    image_size: int = Field(default=IMAGE_SIZE, ge=16, le=512, description="pixels along a side")
    collection: dict[str, dict[str, Any]] = Field(
        default_factory=dict, description="by method: fields of Collection that its runs have where an experiment "
        "chooses none"
    )
    training: dict[ObservationKind, Training] = Field(
        description="the recipe for each observation, alike for all methods"
    )
    gradient_steps: dict[ObservationKind, dict[Budget, Steps]] = Field(
        default_factory=dict, description="by observation: gradient steps for so many timesteps of data"
    )
    notebooks: dict[str, dict[str, Any]] = Field(description="parameters that differ from the notebook's own")
    limits: dict[str, Budget] = Field(
        default_factory=dict, description="by name, the most that a parameter is in any notebook for which `notebooks` "
        "chooses none; of several numbers each"
    )
    leaves_out_pixels: bool = Field(
        default=False, description="whether runs from pixels are left out, and not refused, where nothing can draw"
    )
    minutes: dict[ObservationKind, Minutes] = Field(
        default_factory=dict, description="of a run alone on one core, by observation"
    )

    def __hash__(self) -> int:
        return hash(self.name)

    @model_validator(mode="after")
    def _steps_begin_with_the_recipes_own(self) -> Self:
        for observation, steps in self.gradient_steps.items():
            own = self.training[observation].gradient_steps if observation in self.training else "no such recipe"
            if not steps or steps[min(steps)] != own:
                raise ValueError(f"gradient_steps {observation}: smallest budget must have what training has, {own}")
            if (taken := [steps[budget] for budget in sorted(steps)]) != sorted(taken):
                raise ValueError(f"gradient_steps {observation}: {taken} given for budgets {sorted(steps)}; allowed "
                                 "are no fewer for more data")
        return self

    @model_validator(mode="after")
    def _crops_fit_the_images(self) -> Self:
        pixels = self.training["rgb"].crop_pixels if "rgb" in self.training else None
        if pixels and pixels > self.image_size:
            raise ValueError(f"training rgb: crop_pixels {pixels} of images of {self.image_size} pixels; allowed are "
                             "no more")
        return self

    @field_validator("collection")
    @classmethod
    def _of_what_no_experiment_chooses(cls, collection: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        if unknown := [method for method in collection if method not in METHODS]:
            raise ValueError(f"method {unknown[0]!r} given; allowed are {', '.join(METHODS)}")
        allowed = [name for name in Collection.model_fields if name not in CHOSEN_ELSEWHERE]
        if wrong := [name for chosen in collection.values() for name in chosen if name not in allowed]:
            raise ValueError(f"{wrong[0]!r} given; allowed are {', '.join(allowed)}")
        return collection

    @field_validator("notebooks")
    @classmethod
    def _of_notebooks_that_exist(cls, changed: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        known = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))
        if IN_CHECKOUT and (unknown := sorted(set(changed) - set(known))):
            raise ValueError(f"no notebook {', '.join(unknown)}; allowed are {', '.join(known)}")
        return changed

    @property
    def results(self) -> Path:
        """Where its results are: one JSON file a run. Those of a stamped profile prove nothing and stay out of git."""
        return (paths.BUILD if self.stamp else paths.ROOT) / "results" / (self.shares_results or self.name)

    @property
    def own_results(self) -> Path:
        """Where notebooks store the runs that they compute, so that what is shipped stays as it is."""
        return paths.BUILD / "results" / self.results.name

    @property
    def figures(self) -> Path:
        """Where its figures and tables go; the shipped ones are in git."""
        return paths.ROOT / "paper_figures" if self.shipped else paths.own_figures(self.name)

    @property
    def observations(self) -> tuple[ObservationKind, ...]:
        """What policies of this profile can see on this machine."""
        hidden = {"rgb"} if self.leaves_out_pixels and gl_problem() else set()
        return tuple(name for name in self.training if name not in hidden)

    def recipe(self, observation: str, timesteps: int) -> Training:
        """How policies that see `observation` are built and trained on so many timesteps.

        Between two entries of `gradient_steps` its gradient steps lie on a straight line, above the last they grow in
        proportion to the data, and below the first they stay. Without entries they are the recipe's own.

        Raises:
            NoRecipe: the profile has none for it.
        """
        if observation not in self.observations:
            raise NoRecipe(f"observation: {observation!r} given; this profile has {', '.join(self.observations)}")
        recipe, chosen = self.training[observation], sorted(self.gradient_steps.get(observation, {}).items())
        if not chosen:
            return recipe
        budgets, steps = zip(*chosen, strict=True)
        beyond = max(1.0, timesteps / budgets[-1])
        return recipe.model_copy(update={"gradient_steps": math.ceil(beyond * np.interp(timesteps, budgets, steps))})


def names() -> list[str]:
    """The profiles that exist."""
    return sorted(path.stem for path in PROFILES.glob("*.yaml"))


def load_profile(name: str) -> Profile:
    """The profile called `name`, read from its file.

    Raises:
        BadInput: no such profile, or a setting that is wrong; the message says which.
    """
    if name not in names():
        raise BadInput(f"profile: {name!r} given; allowed are {', '.join(names())} (files under {PROFILES})")
    path = PROFILES / f"{name}.yaml"
    try:
        content = yaml_text.read(path.read_text(encoding="utf-8"), str(path))
        return Profile.model_validate(content | {"name": name} if isinstance(content, dict) else content)
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path}: not readable as YAML: {error}") from error
    except ValidationError as error:
        raise BadInput(f"{path}: {first_problem(error)}") from error

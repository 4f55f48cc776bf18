"""A run as data: everything that decides a number, and its hash.

PolicyRun       collect, train, evaluate
ControlRun      evaluate an untrained baseline
CollectionRun   count attempts to demonstrate
RunSpec         any of the three; `run_spec_from_json` reads it back
"""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator

from move.choices import Control
from move.learn.evaluation import Evaluation
from move.learn.settings import Training
from move.sim.collection import Collection
from move.sim.tasks import get_task

RESULTS_VERSION = 1
"""Raised by hand whenever the behaviour of collection, training or evaluation changes; it makes every hash new."""

OF_A_POLICY = ("own", "grasp")  # evaluations that start where the policy's own demonstrations did


class _Run(BaseModel):
    """What the three kinds share.

    Two runs with the same hash are the same run. Fields left at their defaults do not enter the hash, so a field
    added later, whose default means what was done before, keeps the results that exist. Stored JSON calls the agent
    "player".
    """

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", validate_by_name=True, validate_by_alias=True,
                              serialize_by_alias=True, loc_by_alias=False)
    kind: ClassVar[str]

    task: str
    seed: int = Field(ge=0)
    agent: str = Field(alias="player")
    evaluation: Evaluation = Evaluation()
    results_version: int = RESULTS_VERSION

    @property
    def hash(self) -> str:
        """First 16 hexadecimal digits of the sha256 of the canonical JSON."""
        chosen = self.model_dump(mode="json", exclude_defaults=True) | {"results_version": self.results_version}
        if self.agent != "policy":
            chosen["player"] = self.agent
        if (version := get_task(self.task).version) > 1:
            chosen["task_version"] = version
        canonical = json.dumps(chosen, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()[:16]

    @property
    def policy_hash(self) -> str:
        """The hash of the run that tries the same policy as `Evaluation()` says: alike where only the starts differ."""
        return self.model_copy(update={"evaluation": Evaluation()}).hash

    @model_validator(mode="after")
    def _starts_of_a_policy_for_policies(self) -> Self:
        if self.agent != "policy" and self.evaluation.starts in OF_A_POLICY:
            raise ValueError(f"agent {self.agent!r} learnt from nothing; starts {self.evaluation.starts!r} are for "
                             "policies")
        return self


class _Collected(_Run):
    """A run that collects demonstrations of its task."""

    collection: Collection

    @model_validator(mode="after")
    def _one_task(self) -> Self:
        if self.collection.task != self.task:
            raise ValueError(f"task {self.task!r} but a collection of {self.collection.task!r}")
        return self

    @property
    def observation(self) -> str:
        """What is kept of each timestep, and what a policy sees: "keypoints" or "rgb"."""
        return self.collection.observation

    @property
    def method(self) -> str:
        """How the data are collected."""
        return self.collection.method


class PolicyRun(_Collected):
    """Collect demonstrations, train a policy on them, evaluate it."""

    kind: ClassVar[str] = "policy"

    agent: Literal["policy"] = Field(default="policy", alias="player")
    training: Training

    @property
    def label(self) -> str:
        """One line that names the run to a reader."""
        made = self.collection
        return f"{self.task} {made.method} {made.protocol} {made.timesteps} {made.observation} seed {self.seed}"


class ControlRun(_Run):
    """Evaluate an untrained baseline: a floor or a ceiling."""

    kind: ClassVar[str] = "control"

    agent: Control = Field(alias="player")
    collection: None = None
    training: None = None

    @property
    def observation(self) -> str:
        """Nothing that matters: "none"."""
        return "none"

    @property
    def method(self) -> str:
        """The agent's name, which stands in the place of a method."""
        return self.agent

    @property
    def label(self) -> str:
        """One line that names the run to a reader."""
        return f"{self.task} {self.agent}"


class CollectionRun(_Collected):
    """Count attempts to demonstrate; `evaluation.episodes` says how many."""

    kind: ClassVar[str] = "collector"

    agent: Literal["collector"] = Field(default="collector", alias="player")
    training: None = None

    @model_validator(mode="after")
    def _one_method(self) -> Self:
        if self.collection.shares:
            raise ValueError("attempts of a mixture; allowed are those of each of its methods")
        return self

    @property
    def label(self) -> str:
        """One line that names the run to a reader."""
        return f"{self.task} attempts, {self.collection.method}, {self.collection.expert} expert"


RunSpec = PolicyRun | ControlRun | CollectionRun
AnyRun = Annotated[RunSpec, Field(discriminator="agent")]
_ANY: TypeAdapter[RunSpec] = TypeAdapter(AnyRun)


def run_spec_from_json(text: str) -> RunSpec:
    """A run of whichever kind from the JSON that a result holds.

    Raises:
        pydantic.ValidationError: it is not a run, a ValueError.
    """
    return _ANY.validate_json(text)

"""A run as data: everything that decides a number, and its hash."""

from __future__ import annotations

import hashlib
import json
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from move.learn.evaluate import Evaluation
from move.learn.settings import Training
from move.sim.collect import Collection

RESULTS_VERSION = 1
"""Raised by hand whenever the behaviour of collection, training or evaluation changes; it makes every hash new."""


class RunSpec(BaseModel):
    """One run: collect, train, evaluate; or a control, which only evaluates; or attempts to demonstrate, counted.

    Two runs with the same hash are the same run. Fields left at their defaults do not enter the hash, so a field
    added later, whose default means what was done before, keeps the results that exist.
    """

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    task: str
    seed: int = Field(ge=0)
    player: Literal["policy", "nothing", "random", "expert", "goal-blind", "collector"] = "policy"
    collection: Collection | None = None
    training: Training | None = None
    evaluation: Evaluation = Evaluation()
    results_version: int = RESULTS_VERSION

    @model_validator(mode="after")
    def _parts_fit_the_player(self) -> Self:
        needed = {"policy": (True, True), "collector": (True, False)}.get(self.player, (False, False))
        if needed != (self.collection is not None, self.training is not None):
            raise ValueError(f"player {self.player!r}: a policy has a collection and a training, a collector a "
                             "collection only, a control neither")
        if self.player == "collector" and self.collection.method == "mixture":
            raise ValueError("attempts of a mixture; allowed are those of each of its methods")
        if self.evaluation.layout in ("own", "grasp") and self.player != "policy":
            raise ValueError(f"player {self.player!r} learnt from nothing; layout {self.evaluation.layout!r} is for "
                             "policies")
        if self.collection and self.collection.task != self.task:
            raise ValueError(f"task {self.task!r} but a collection of {self.collection.task!r}")
        return self

    @property
    def hash(self) -> str:
        """First 16 hexadecimal digits of the sha256 of the canonical JSON."""
        chosen = self.model_dump(mode="json", exclude_defaults=True) | {"results_version": self.results_version}
        canonical = json.dumps(chosen, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()[:16]

    @property
    def policy_hash(self) -> str:
        """The hash of the run that tries the same policy as `Evaluation()` says: alike where only the trial differs."""
        return self.model_copy(update={"evaluation": Evaluation()}).hash

    @property
    def kind(self) -> str:
        """Whether the run has a "policy", is a "control", or counts attempts of a "collector"."""
        return self.player if self.player in ("policy", "collector") else "control"

    @property
    def observation(self) -> str:
        """What the player sees: "keypoints", "rgb", or "none" for a control."""
        return self.collection.observation if self.collection else "none"

    @property
    def method(self) -> str:
        """How the data was collected, or the control's name."""
        return self.collection.method if self.collection else self.player

    @property
    def label(self) -> str:
        """One line that names the run to a reader."""
        if self.collection is None:
            return f"{self.task} {self.player}"
        if self.player == "collector":
            return f"{self.task} attempts, {self.collection.method}, {self.collection.expert} expert"
        made = f"{self.collection.method} {self.collection.protocol} {self.collection.timesteps} {self.observation}"
        return f"{self.task} {made} seed {self.seed}"

"""What a figure is made of: its runs, what is stored of them, and what is missing."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from move.errors import BadInput
from move.figures.page import captions
from move.figures.page.noise import known_noise
from move.figures.tables import rates
from move.statistics.estimates import TrainingNoise
from move.study.execute import execute
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.results import NOT_COMPUTED, Result, missing_in_words, split, table
from move.study.spec import RunSpec


@dataclass(frozen=True)
class Data:
    """The runs of one figure: what is stored, as results and as episodes, and what is missing.

    Args:
        folder: where the figure is written, and whatever else it makes, such as films.
        seen: what the function `seen` of the figure's file gave.
    """

    profile: Profile
    folder: Path
    runs: list[LabelledRun] = field(default_factory=list)
    results: list[Result] = field(default_factory=list)
    missing: list[tuple[RunSpec, str]] = field(default_factory=list)
    seen: Any = None
    _noises: dict[tuple[str, bool], TrainingNoise] = field(default_factory=dict, init=False)

    @cached_property
    def episodes(self) -> pd.DataFrame:
        """The episodes of all results as `move.study.results.table` gives them, with the runs' labels as columns."""
        return table(self.results)

    @property
    def counted(self) -> list[Result]:
        """The results, each once: a run may stand in several conditions of a figure, with other labels."""
        return list({result.spec.hash: result for result in self.results}.values())

    def noise(self, observation: str = "rgb", grid: bool = False) -> TrainingNoise:
        """How much a rate varies from training to training, the same in every figure, see `known_noise`."""
        if (observation, grid) not in self._noises:
            self._noises[observation, grid] = known_noise(self.profile, observation, grid)
        return self._noises[observation, grid]

    def with_missing(self, table: pd.DataFrame, by: list[str]) -> pd.DataFrame:
        """`table` with a row for everything that the runs were to tell, NaN where it is missing, in their order."""
        return rates.with_missing(table, self.runs, by)

    @property
    def source(self) -> str:
        """Observation, budgets, seeds, episodes, runs, what is missing and the profile's purpose, in sentences."""
        if not self.runs:
            return f"{self.profile.purpose}."
        said = captions.numbers(self.counted, len(self.missing), self.profile.purpose)
        return f"{said} Missing: {missing_in_words(self.missing)}." if self.missing else said

    @property
    def sample_size(self) -> str:
        """The sample of an answer, in a sentence: seeds, episodes, and what is missing."""
        return captions.sample_size(self.counted, len(self.missing))

    @property
    def remark(self) -> str:
        """What a reader of the figure alone must not miss: that perception was given, and how much is missing."""
        trained = [result.spec for result in self.results if result.spec.training]
        wanted = len(self.counted) + len(self.missing)
        given = bool(trained) and all(spec.observation == "keypoints" for spec in trained)
        parts = ["from keypoints: perception is given"] * given
        parts += [f"{len(self.missing)} of {wanted} runs are missing"] * bool(self.missing)
        return "; ".join(parts)


def load_or_run(runs: list[LabelledRun], profile: Profile, folder: Path) -> Data:
    """Compute what is missing of `runs`, unless MOVE_STORED_ONLY is set, and return all there is, with its labels.

    What is computed is stored under build/; the shipped results are only read.

    Raises:
        BadInput: there is nothing at all to draw; the message says why.
    """
    if not runs:
        raise BadInput(f"profile {profile.name}: has no runs of this figure; allowed is another profile")
    there, missing = _found(list(dict.fromkeys(run.spec for run in runs)), profile)
    if not there:
        raise BadInput(f"none of the {len(runs)} runs of this figure is stored; the first one: {missing[0][1]}")
    stored = {result.spec.hash: result for result in there}
    results = [replace(stored[run.spec.hash], labels=run.labels) for run in runs if run.spec.hash in stored]
    return Data(profile, folder, runs, results, missing)


def _found(specs: list[RunSpec], profile: Profile) -> tuple[list[Result], list[tuple[RunSpec, str]]]:
    """What is there of `specs`, shipped or a reader's own, computed where allowed; and what is missing, with why."""
    shipped, lacking = split(specs, profile.results)
    unusable = {spec.hash: why for spec, why in lacking if why != NOT_COMPUTED}
    stored_only = os.environ.get("MOVE_STORED_ONLY") == "1"
    own, missing = (split if stored_only else execute)([spec for spec, _ in lacking], profile.own_results)
    return shipped + own, [(spec, unusable.get(spec.hash, why) if why == NOT_COMPUTED else why)
                           for spec, why in missing]

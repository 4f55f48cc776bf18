"""What a figure is made of: its runs, what is stored of them, and what is missing."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from move.errors import BadInput
from move.figures.page import captions
from move.figures.page.noise import known_noise
from move.statistics.training_noise import TrainingNoise
from move.study.execute import execute
from move.study.labels import LabelledRun
from move.study.plan import minutes_left
from move.study.profiles import Profile
from move.study.results import NOT_COMPUTED, Result, missing_in_words, split, table
from move.study.spec import RunSpec


@dataclass(frozen=True)
class Data:
    """The runs of one figure: what is stored, as results and as episodes, and what is missing.

    Args:
        folder: where the figure is written, and whatever else it makes, such as films.
        postponed: how long computing what is missing would take and how to start it; empty where nothing waits for it.
        seen: what the function `seen` of the figure's file gave.
        noises: what `noise` has given so far, by observation and whether it is of a grid.
    """

    profile: Profile
    folder: Path
    runs: list[LabelledRun] = field(default_factory=list)
    results: list[Result] = field(default_factory=list)
    missing: list[tuple[RunSpec, str]] = field(default_factory=list)
    postponed: str = ""
    seen: Any = None
    noises: dict[tuple[str, bool], TrainingNoise] = field(default_factory=dict, init=False)

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
        if (observation, grid) not in self.noises:
            self.noises[observation, grid] = known_noise(self.profile, observation, grid)
        return self.noises[observation, grid]

    def with_missing(self, rates: pd.DataFrame, by: list[str]) -> pd.DataFrame:
        """A `rate_table` with a row for all that the runs were to give, NaN where it is missing, in their order."""
        wanted = pd.DataFrame([{**run.labels, "task": run.spec.task, "method": run.spec.method,
                                "observation": run.spec.observation, "timesteps": run.spec.collection.timesteps}
                               for run in self.runs if run.spec.collection])
        whole = wanted[by].drop_duplicates().merge(rates, on=by, how="left")
        return whole.assign(seeds=[seeds if isinstance(seeds, list) else [] for seeds in whole.seeds])

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


def load_or_run(runs: list[LabelledRun], profile: Profile, folder: Path, most_minutes: float = math.inf) -> Data:
    """Compute what is missing of `runs`, unless MOVE_STORED_ONLY is set, and return all there is, with its labels.

    What is computed is stored under build/; the shipped results are only read.

    Args:
        most_minutes: that computing may take here; longer ones are left missing, and `Data.postponed` says so.

    Raises:
        BadInput: there is nothing at all to draw; the message says why.
    """
    if not runs:
        raise BadInput(f"profile {profile.name}: has no runs of this figure with these parameters; allowed are others, "
                       "or another profile")
    wanted = list(dict.fromkeys(run.spec for run in runs))
    there, missing, postponed = _found(wanted, profile, most_minutes)
    if not there:
        why = postponed or f"the first one: {missing[0][1]}"
        raise BadInput(f"none of the {len(wanted)} runs of this figure is stored; {why}")
    stored = {result.spec.hash: result for result in there}
    results = [replace(stored[run.spec.hash], labels=run.labels) for run in runs if run.spec.hash in stored]
    return Data(profile, folder, runs, results, missing, postponed)


def _found(
    specs: list[RunSpec], profile: Profile, most_minutes: float
) -> tuple[list[Result], list[tuple[RunSpec, str]], str]:
    """What is there of `specs`, shipped or a reader's own, computed where allowed; what is missing, why; how to go on.
    """
    shipped, lacking = split(specs, profile.results)
    unusable = {spec.hash: why for spec, why in lacking if why != NOT_COMPUTED}
    own, missing = split([spec for spec, _ in lacking], profile.own_results)
    postponed = ""
    if missing and os.environ.get("MOVE_STORED_ONLY") != "1":
        left = minutes_left(profile, shipped + own, [spec for spec, _ in missing]) / (os.cpu_count() or 1)
        if left <= most_minutes:
            own, missing = execute([spec for spec, _ in lacking], profile.own_results)
        else:
            postponed = (f"computing {len(missing)} of {len(specs)} runs would take {_duration(left)} here: to do it, "
                         "set compute = True and run the cells again")
    return shipped + own, [(spec, unusable.get(spec.hash, why) if why == NOT_COMPUTED else why)
                           for spec, why in missing], postponed


def _duration(minutes: float) -> str:
    """About how long, in words.

    >>> _duration(7.4), _duration(200), _duration(math.inf)
    ('about 7 minutes', 'about 3.3 hours', 'hours (`move plan` says how many)')
    """
    if math.isinf(minutes):
        return "hours (`move plan` says how many)"
    return f"about {minutes:.0f} minutes" if minutes < 100 else f"about {minutes / 60:.1f} hours"

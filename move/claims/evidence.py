"""What claims are decided from: a profile's stored runs, picked by what they are, with what is missing and its cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, cached_property
from statistics import median
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from move.claims.rule import Finding, Item, Missing
from move.experiments import registry
from move.experiments.noise import known_noise
from move.paths import results
from move.statistics.cells import successes
from move.statistics.estimates import (
    Estimate,
    TrainingNoise,
    difference,
    mean_difference,
    relative_gain,
    success_rate,
    unpaired_difference,
)
from move.statistics.intervals import CONFIDENCE
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.results import Result, split, table

Where = dict[str, Any]
ON_A_GRID = ("fig1_sparse", "few_demonstrations", "fig3_dense", "fig5_circle")
EPISODE_COLUMNS = ["run", "kind", "task", "method", "observation", "timesteps", "factors", "hand_spread", "seed",
                   "trial", "group", "success", "steps", "object_x", "object_y"]


class Evidence:
    """The stored runs of a profile; nothing is computed anew.

    `where` always means: of one experiment the rows whose columns have these values, as in
    `move.study.results.table`, labels included.
    """

    def __init__(self, profile: Profile) -> None:
        self.profile = profile
        self.episodes = cache(self._episodes)  # by experiment: all stored episodes
        self.asked = cache(self._asked)  # by experiment: one row a run, stored or not

    def rate(self, what: str, experiment: str, where: Where, above: float, paper: float = float("nan")) -> Item:
        """A success rate, said to be above a value."""
        rows = self._rows(experiment, where)
        if rows.empty:
            return self.missing(what, experiment, where)
        return _finding(what, success_rate(successes(rows), self.noise(experiment)), rows, above, paper)

    def failure(self, what: str, experiment: str, where: Where, above: float) -> Item:
        """The share of episodes that fail, said to be above a value."""
        rows = self._rows(experiment, where)
        if rows.empty:
            return self.missing(what, experiment, where)
        return _finding(what, success_rate(1 - successes(rows), self.noise(experiment)), rows, above, float("nan"))

    def difference(self, what: str, experiment: str, one: Where, other: Where, paper: float = float("nan"),
                   above: float = 0.0) -> Item:
        """The success rate where `one` holds minus that where `other` does, paired by configuration."""
        first, second = self._rows(experiment, one), self._rows(experiment, other)
        if first.empty or second.empty:
            return self.missing(what, experiment, *[where for where, rows in ((one, first), (other, second))
                                                    if rows.empty])
        return self.apart(what, first, second, self.noise(experiment), paper, above)

    def apart(self, what: str, first: pd.DataFrame, second: pd.DataFrame, noise: TrainingNoise,
              paper: float = float("nan"), above: float = 0.0, paired: bool = True) -> Finding:
        """The same of episodes that are given; not paired where each side has configurations of its own."""
        compare = difference if paired else unpaired_difference
        found = compare(successes(first), successes(second), noise)
        return _finding(what, found, pd.concat([first, second]), above, paper)

    def mean_difference(self, what: str, experiment: str, tasks: list[str], one: Where, other: Where,
                        paper: float = float("nan")) -> Item:
        """The mean over `tasks` of such a difference."""
        return self._over_tasks(mean_difference, what, experiment, tasks, one, other, paper)

    def relative_gain(self, what: str, experiment: str, tasks: list[str], one: Where, other: Where,
                      paper: float = float("nan")) -> Item:
        """The mean success over `tasks` where `one` holds over that where `other` does, minus 1."""
        return self._over_tasks(relative_gain, what, experiment, tasks, one, other, paper)

    def over_seeds(self, what: str, values: list[float], rows: pd.DataFrame, above: float = 0.0,
                   paper: float = float("nan"), below: float = float("inf")) -> Finding:
        """A number that each seed gives for itself, three or more: Student's interval of its mean."""
        mean, error = float(np.mean(values)), max(float(stats.sem(values)), 1e-3)
        low, high = stats.t.interval(CONFIDENCE, len(values) - 1, mean, error)
        return Finding(what, mean, float(low), float(high), above, below, paper, runs=_runs(rows))

    def rows(self, experiment: str, **where: Any) -> pd.DataFrame:
        """The episodes of an experiment where the columns have these values."""
        return self._rows(experiment, where)

    def results(self, experiment: str) -> list[Result]:
        """The stored results of an experiment."""
        runs = registry.runs(experiment, self.profile)
        return split([run.spec for run in runs], results(self.profile))[0]

    def missing(self, what: str, experiment: str, *wheres: Where) -> Missing:
        """What is not stored of an experiment's runs, and its core-minutes by those of stored runs like it."""
        asked = self.asked(experiment)
        lacking = pd.concat([_where(asked[~asked.stored], where) for where in wheres]) if len(asked) else asked
        if lacking.empty:
            return Missing(f"{what} (profile {self.profile.name} has no runs for it)", 0, 0.0)
        lacking = lacking.drop_duplicates("run")
        return Missing(what, len(lacking), float(lacking.steps.sum() * self._minutes_a_step))

    def noise(self, experiment: str) -> TrainingNoise:
        """How much an experiment's rates vary from training to training; from pixels, where the profile has images."""
        return self._known(experiment in ON_A_GRID)

    @cache  # noqa: B019, an evidence lives as long as its ledger
    def _known(self, grid: bool) -> TrainingNoise:
        return known_noise(self.profile, "rgb" if self.profile.training.get("rgb") else "keypoints", grid)

    def _over_tasks(self, estimate: Callable[..., Estimate], what: str, experiment: str, tasks: list[str], one: Where,
                    other: Where, paper: float) -> Item:
        pairs = [(self._rows(experiment, {"task": task, **one}), self._rows(experiment, {"task": task, **other}))
                 for task in tasks]
        if any(first.empty or second.empty for first, second in pairs):
            return self.missing(what, experiment, one, other)
        found = estimate([(successes(first), successes(second)) for first, second in pairs], self.noise(experiment))
        return _finding(what, found, pd.concat([part for pair in pairs for part in pair]), 0.0, paper)

    def _rows(self, experiment: str, where: Where) -> pd.DataFrame:
        return _where(self.episodes(experiment), where)

    def _episodes(self, experiment: str) -> pd.DataFrame:
        runs = registry.runs(experiment, self.profile)
        stored = {result.spec.hash: result for result in split([run.spec for run in runs], results(self.profile))[0]}
        found = table([replace(stored[run.spec.hash], labels=run.labels) for run in runs if run.spec.hash in stored])
        return found if len(found) else pd.DataFrame(columns=EPISODE_COLUMNS)

    def _asked(self, experiment: str) -> pd.DataFrame:
        there = set(self.episodes(experiment).run)
        return pd.DataFrame([_row(run, run.spec.hash in there) for run in registry.runs(experiment, self.profile)])

    @cached_property
    def _minutes_a_step(self) -> float:
        """Core-minutes of a run for each gradient step, the median of table 2's from pixels."""
        spent = [sum(result.seconds.values()) / 60 / result.spec.training.gradient_steps
                 for result in self.results("table2_main") if result.spec.training and result.spec.observation == "rgb"]
        return median(spent) if spent else 0.0


def _row(run: LabelledRun, stored: bool) -> dict[str, Any]:
    spec = run.spec
    return {"run": spec.hash, "stored": stored, "task": spec.task, "method": spec.method, "kind": spec.kind,
            "observation": spec.observation, "timesteps": spec.collection.timesteps if spec.collection else 0,
            "factors": spec.evaluation.factors, "seed": spec.seed,
            "hand_spread": spec.collection.hand_spread if spec.collection else 0.0,
            "steps": spec.training.gradient_steps if spec.training else 0, **run.labels}


def _where(rows: pd.DataFrame, where: Where) -> pd.DataFrame:
    for column, value in where.items():
        if column in rows:
            rows = rows[rows[column] == value]
    return rows


def _finding(what: str, found: Estimate, rows: pd.DataFrame, above: float, paper: float) -> Finding:
    p_value = found.p_value if above == 0 else float("nan")
    return Finding(what, found.value, found.low, found.high, above, paper=paper, p_value=p_value, runs=_runs(rows))


def _runs(rows: pd.DataFrame) -> tuple[str, ...]:
    return tuple(dict.fromkeys(rows.run)) if "run" in rows else ()

"""What claims are decided from: a profile's stored runs, picked by what they are, with what is missing and its cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, cached_property
from statistics import median
from typing import Any

import numpy as np
import pandas as pd

from move.claims.claims import Quantity, Where
from move.figures.fig1_sparse import from_grasps
from move.figures.page.noise import known_noise
from move.figures.page.parameters import runs
from move.sim.grasp_points import CIRCLE
from move.statistics.estimates import Estimate
from move.statistics.intervals import LEAST_ERROR, mean_interval
from move.statistics.needed import Design, Seeds
from move.statistics.training_noise import TrainingNoise
from move.statistics.verdicts import Finding, Missing
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.results import Result, hand_start, split, table

ON_A_GRID = ("fig1_sparse", "few_demonstrations", "fig3_dense", "fig5_circle", "decided_places")
EPISODE_COLUMNS = ["run", "kind", "task", "method", "observation", "timesteps", "factors", "hand", "seed",
                   "trial", "group", "success", "steps", "object_x", "object_y"]


class Evidence:
    """The stored runs of a profile; nothing is computed anew.

    `where` always means: of one experiment the rows whose columns have these values, as in
    `move.study.results.table`, labels included. Over a grid there are two more: `from_grasps`, metres from the nearest
    grasp point of the demonstrations, and `circle`, "inside" or "outside" of figure 5's.
    """

    def __init__(self, profile: Profile) -> None:
        self.profile = profile
        self.episodes = cache(self._episodes)  # by experiment: all stored episodes
        self.asked = cache(self._asked)  # by experiment: one row a run, stored or not
        self.stored = cache(self._read)  # by experiment and hash: the stored results
        self._known = cache(self._law)

    def rows(self, experiment: str, *wheres: Where) -> pd.DataFrame:
        """The episodes of an experiment where the columns have these values."""
        return chosen(self.episodes(experiment), *wheres)

    def noise(self, experiment: str) -> TrainingNoise:
        """How much an experiment's rates vary from training to training; from pixels, where the profile has images."""
        return self._known(experiment in ON_A_GRID)

    def missing(self, what: str, experiment: str, *wheres: Where) -> Missing:
        """What is not stored of an experiment's runs, and its core-minutes by those of stored runs like it."""
        asked = self.asked(experiment)
        lacking = pd.concat([chosen(asked[~asked.stored], where) for where in wheres]) if len(asked) else asked
        if lacking.empty:
            why = f"profile {self.profile.name} has no runs for it{self._absent(experiment, wheres)}"
            return Missing(f"{what} ({why})", 0, 0.0)
        lacking = lacking.drop_duplicates("run")
        collected = int((lacking.steps == 0).sum())
        return Missing(what, len(lacking), float(lacking.steps.sum() * self._minutes_a_step
                                                 + collected * self._minutes_without_training))

    def columns(self, experiment: str) -> set[str]:
        """What runs and episodes of an experiment can be picked by; none where nothing is stored."""
        return {*self.asked(experiment), *self.episodes(experiment)} if len(self.episodes(experiment)) else set()

    def _absent(self, experiment: str, wheres: Sequence[Where]) -> str:
        """The first value that is asked for and that nothing of an experiment has, and what there is in its place."""
        for column, value in [pair for where in wheres for pair in where.items()]:
            if isinstance(value, dict | list):
                continue
            there = {each for rows in (self.asked(experiment), self.episodes(experiment)) if column in rows
                     for each in rows[column].unique()}
            if there and value not in there:
                return f": {column} {value!r}; there are {', '.join(sorted(map(str, there)))}"
        return ""

    def finding(self, what: str, found: Estimate, rows: pd.DataFrame, quantity: Quantity, **more: Any) -> Finding:
        """An estimate from episodes, as a finding of what a claim says of it."""
        return Finding(what, found.value, found.low, found.high, **quantity.region, runs=runs_of(rows), **more)

    def with_design(self, finding: Finding, experiment: str, sides: Sequence[pd.DataFrame]) -> Finding:
        """A difference of two sides with what it was measured with and what its runs cost; as it is without times."""
        stored = self.stored(experiment)
        spent = [[stored[run].seconds for run in rows.run.unique() if run in stored] for rows in sides]
        if not all(spent):
            return finding
        noise = self.noise(experiment)
        rate = float(np.mean([rows.success.mean() for rows in sides]))
        variance = 4 * rate * (1 - rate) * noise.variance * noise.degrees / (noise.degrees - 2) if noise.degrees else 0
        count = min(rows.groupby("run").size().min() for rows in sides)
        whole, tried = (sum(median(map(part, each)) for each in spent) / 60 for part in (
            lambda seconds: sum(seconds.values()), lambda seconds: seconds.get("evaluate", 0.0)))
        return replace(finding, design=Design(min(rows.seed.nunique() for rows in sides), int(count),
                                              (finding.high - finding.low) / 2, variance, whole, tried * 100 / count))

    def with_seeds(self, finding: Finding, experiment: str, rows: pd.DataFrame, fixed: float = 0.0) -> Finding:
        """A finding with what more seeds of the runs of `rows` would tell and cost; as it is where no run has times.

        Args:
            fixed: the part of half its interval that configurations make.
        """
        stored = self.stored(experiment)
        spent = [sum(stored[run].seconds.values()) / 60 for run in rows.run.unique() if run in stored]
        seeds = rows.seed.nunique()
        return replace(finding, design=Seeds(seeds, (finding.high - finding.low) / 2, sum(spent) / seeds, fixed)
                       ) if spent else finding

    def _law(self, grid: bool) -> TrainingNoise:
        return known_noise(self.profile, "rgb" if self.profile.training.get("rgb") else "keypoints", grid)

    def _read(self, experiment: str) -> dict[str, Result]:
        specs = [run.spec for run in runs(experiment, self.profile)]
        return {result.spec.hash: result for result in split(specs, self.profile.results)[0]}

    def _episodes(self, experiment: str) -> pd.DataFrame:
        stored = self.stored(experiment)
        found = table([replace(stored[run.spec.hash], labels=run.labels)
                       for run in runs(experiment, self.profile) if run.spec.hash in stored])
        if found.empty:
            return pd.DataFrame(columns=EPISODE_COLUMNS)
        return placed(found) if experiment in ON_A_GRID else found

    def _asked(self, experiment: str) -> pd.DataFrame:
        there = set(self.episodes(experiment).run)
        return pd.DataFrame([_row(run, run.spec.hash in there) for run in runs(experiment, self.profile)])

    @cached_property
    def _minutes_a_step(self) -> float:
        """Core-minutes of a run for each gradient step, the median of table 2's from pixels."""
        spent = [sum(result.seconds.values()) / 60 / result.spec.training.gradient_steps
                 for result in self.stored("table2_main").values()
                 if result.spec.training and result.spec.observation == "rgb"]
        return median(spent) if spent else 0.0

    @cached_property
    def _minutes_without_training(self) -> float:
        """Core-minutes of a run that only collects, the median of table 6's."""
        spent = [sum(result.seconds.values()) / 60 for result in self.stored("table6_collection").values()]
        return median(spent) if spent else 0.0


def over_seeds(what: str, values: Sequence[float], each: Quantity, runs: tuple[str, ...] = ()) -> Finding:
    """A number that each seed gives for itself, three or more: Student's interval of its mean."""
    return Finding(what, *mean_interval(values, LEAST_ERROR), **each.region, runs=runs)


def chosen(rows: pd.DataFrame, *wheres: Where) -> pd.DataFrame:
    """The rows whose columns are as each `where` says; a column that is not there is left alone."""
    for column, value in [pair for where in wheres for pair in where.items() if pair[0] in rows]:
        if isinstance(value, dict):
            (kind, number), = value.items()
            rows = rows[rows[column] > number if kind == "above" else rows[column] <= number]
        else:
            rows = rows[rows[column].isin(value if isinstance(value, list) else [value])]
    return rows


def placed(episodes: pd.DataFrame) -> pd.DataFrame:
    """Episodes over a grid with `from_grasps` (metres, NaN where there are no grasp points) and `circle`."""
    inside = [CIRCLE.contains((x, y, 0.0)) for x, y in zip(episodes.object_x, episodes.object_y, strict=True)]
    return episodes.assign(from_grasps=from_grasps(episodes), circle=np.where(inside, "inside", "outside"))


def runs_of(*sides: pd.DataFrame) -> tuple[str, ...]:
    """The hashes of the runs that episodes are of."""
    return tuple(dict.fromkeys(run for rows in sides if "run" in rows for run in rows.run))


def _row(run: LabelledRun, stored: bool) -> dict[str, Any]:
    spec = run.spec
    return {"run": spec.hash, "stored": stored, "task": spec.task, "method": spec.method, "kind": spec.kind,
            "observation": spec.observation, "timesteps": spec.collection.timesteps if spec.collection else 0,
            "factors": spec.evaluation.factors, "seed": spec.seed,
            "hand": hand_start(spec),
            "steps": spec.training.gradient_steps if spec.training else 0, **run.labels}

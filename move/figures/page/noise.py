"""How much a rate varies from training to training: the law of all cells that have several seeds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from move.figures import load, names
from move.figures.page.parameters import runs
from move.statistics.training_noise import TrainingNoise, training_noise_of
from move.study.profiles import Profile
from move.study.results import Result, split
from move.study.spec import RunSpec


def known_noise(profile: Profile, observation: str, grid: bool = False) -> TrainingNoise:
    """How much a rate varies from training to training, from the profile's stored runs that differ in their seed alone.

    The same in every figure, so that a rate has one interval wherever it is shown. Nothing is known where no cell has
    two seeds, or without a recipe for this observation. The runs are those of the figures that repeat a training three
    times or more and say so (`REPEATED = True` in their file).

    Args:
        grid: of success over a grid of places (figures 1, 3 and 5), where trainings differ more than where everything
            is random.
    """
    return training_noise_of(_cells(profile, observation, grid) if observation in profile.training else ())


def _cells(profile: Profile, observation: str, grid: bool) -> Iterator[np.ndarray]:
    seeds: dict[str, list[Result]] = {}
    for result in split(_repeated(profile, observation, grid), profile.results)[0]:
        seeds.setdefault(result.spec.model_copy(update={"seed": 0}).hash, []).append(result)
    for repeated in seeds.values():
        if len(repeated) > 1:
            yield np.array([result.successes for result in sorted(repeated, key=lambda result: result.spec.seed)])


@cache
def _repeated(profile: Profile, observation: str, grid: bool) -> list[RunSpec]:
    repeating = [name for name in names() if getattr(load(name), "REPEATED", False)]
    found = {run.spec for name in repeating for run in runs(name, profile)
             if run.spec.training and run.spec.observation == observation
             and (run.spec.evaluation.starts == "grid") == grid}
    return sorted(found, key=lambda spec: spec.hash)

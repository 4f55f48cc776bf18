"""What would decide an open claim: seeds, evaluation configurations and core-minutes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

FIXED, SHARED_BY_SEEDS = 0.02, 0.32
"""Variance of a difference of two methods at one configuration: what all seeds share, and what is each seed's own.

Measured on table 2 from pixels: with S seeds and N configurations the variance of a difference is
(0.02 + 0.32 / S) / N + 2 * training variance / S."""
LEAST_EFFECT = 0.05  # of a difference that is worth deciding
MOST_SEEDS = 30
CONFIGURATIONS = (100, 200, 400)


@dataclass(frozen=True)
class Design:
    """What a difference of two methods was measured with.

    Args:
        seeds, configurations: of each method.
        training_variance: of a rate, from training to training.
        minutes: core-minutes of a run of each method together, evaluation included.
        evaluation_minutes: the same of the evaluation of a hundred configurations alone.
    """

    seeds: int
    configurations: int
    training_variance: float
    minutes: float
    evaluation_minutes: float

    def half_width(self, seeds: int, configurations: int) -> float:
        """Half the 95 % interval that so many seeds and configurations would give."""
        variance = (FIXED + SHARED_BY_SEEDS / seeds) / configurations + 2 * self.training_variance / seeds
        return 1.96 * float(np.sqrt(variance))

    def cost(self, seeds: int, configurations: int) -> float:
        """Core-minutes: policies are not kept, so that more configurations need every run again."""
        if configurations == self.configurations:
            return self.minutes * max(seeds - self.seeds, 0)
        return seeds * (self.minutes + self.evaluation_minutes * (configurations - self.configurations) / 100)

    def needed(self, distance: float) -> str:
        """The cheapest way to know a difference as well as its distance from what is claimed, in words.

        >>> Design(1, 100, 0.00115, 30.0, 2.0).needed(0.12)
        '2 seeds of 100 configurations, about 30 core-minutes, would tell it to +-0.11'
        """
        wanted = max(abs(distance), LEAST_EFFECT)
        options = [(self.cost(seeds, count), seeds, count)
                   for seeds, count in product(range(1, MOST_SEEDS + 1), {*CONFIGURATIONS, self.configurations})
                   if self.half_width(seeds, count) <= wanted and self.cost(seeds, count) > 0]
        if not options:
            return f"{MOST_SEEDS} seeds of {max(CONFIGURATIONS)} configurations would not tell it to +-{wanted:.2g}"
        minutes, seeds, count = min(options)
        return (f"{seeds} seeds of {count} configurations, about {minutes:.0f} core-minutes, would tell it to "
                f"+-{self.half_width(seeds, count):.2g}")


@dataclass(frozen=True)
class Trials:
    """Two rates of independent trials, as a robot's."""

    one: float
    other: float

    def needed(self, distance: float) -> str:
        """How many trials of each would tell their difference as well as its distance from what is claimed.

        >>> Trials(11 / 30, 7 / 30).needed(0.13)
        '94 trials of each would tell it to +-0.13'
        """
        wanted = max(abs(distance), LEAST_EFFECT)
        variance = self.one * (1 - self.one) + self.other * (1 - self.other)
        return f"{math.ceil(1.96**2 * variance / wanted**2)} trials of each would tell it to +-{wanted:.2g}"


@dataclass(frozen=True)
class Seeds:
    """A number over fixed configurations, such as all places of a grid: more seeds of the same runs tell it better.

    Args:
        seeds: of each of its runs.
        half_width: half its 95 % interval, which narrows with the root of the number of seeds.
        minutes: core-minutes of one seed of all its runs.
    """

    seeds: int
    half_width: float
    minutes: float

    def needed(self, distance: float) -> str:
        """How many seeds would tell the number as well as its distance from what is claimed.

        >>> Seeds(3, 0.33, 30.0).needed(0.19)
        '10 seeds, about 210 core-minutes, would tell it to +-0.18'
        """
        wanted = max(abs(distance), LEAST_EFFECT)
        seeds = max(math.ceil(self.seeds * (self.half_width / wanted) ** 2), self.seeds + 1)
        if seeds > MOST_SEEDS:
            return f"{MOST_SEEDS} seeds would not tell it to +-{wanted:.2g}"
        return (f"{seeds} seeds, about {self.minutes * (seeds - self.seeds):.0f} core-minutes, would tell it to "
                f"+-{self.half_width * math.sqrt(self.seeds / seeds):.2g}")

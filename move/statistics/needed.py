"""What would decide an open claim four times in five: seeds, evaluation configurations and core-minutes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

from scipy.special import ndtri

FIXED, SHARED_BY_SEEDS = 0.02, 0.32
"""Variance of a difference of two methods at one configuration: what all seeds share, and what is each seed's own.

Measured on table 2 from pixels: with S seeds and N configurations the variance of a difference is
(0.02 + 0.32 / S) / N + 2 * training variance / S."""
LEAST_EFFECT = 0.05  # of a difference that is worth deciding
MOST_SEEDS = 30
CONFIGURATIONS = (100, 200, 400)
POWER = 0.8
HALF = float(ndtri(0.975) / (ndtri(0.975) + ndtri(POWER)))
"""Half an interval over a true distance: where it is no more, the interval leaves the edge out with the chance `POWER`.
An interval as wide as the distance itself would do so every second time."""


@dataclass(frozen=True)
class Design:
    """What a difference of two methods was measured with.

    Args:
        seeds, configurations: of each method.
        half_width: half its 95 % interval.
        training_variance: of a rate, from training to training.
        minutes: core-minutes of a run of each method together, evaluation included.
        evaluation_minutes: the same of the evaluation of a hundred configurations alone.
    """

    seeds: int
    configurations: int
    half_width: float
    training_variance: float
    minutes: float
    evaluation_minutes: float

    def forecast(self, seeds: int, configurations: int) -> float:
        """Half the 95 % interval that so many seeds and configurations would give, from the one that there is."""
        return self.half_width * math.sqrt(self._variance(seeds, configurations)
                                           / self._variance(self.seeds, self.configurations))

    def _variance(self, seeds: int, configurations: int) -> float:
        return (FIXED + SHARED_BY_SEEDS / seeds) / configurations + 2 * self.training_variance / seeds

    def cost(self, seeds: int, configurations: int) -> float:
        """Core-minutes: policies are not kept, so that more configurations need every run again."""
        if configurations == self.configurations:
            return self.minutes * max(seeds - self.seeds, 0)
        return seeds * (self.minutes + self.evaluation_minutes * (configurations - self.configurations) / 100)

    def needed(self, distance: float) -> str:
        """The cheapest way to decide a difference that is `distance` from the edge of what is claimed, in words.

        >>> Design(1, 100, 0.147, 0.00115, 30.0, 2.0).needed(0.12)
        '2 seeds of 400 configurations, about 72 core-minutes, would decide it four times in five (+-0.078)'
        """
        wanted = _wanted(distance)
        options = [(self.cost(seeds, count), seeds, count)
                   for seeds, count in product(range(1, MOST_SEEDS + 1), {*CONFIGURATIONS, self.configurations})
                   if self.forecast(seeds, count) <= wanted and self.cost(seeds, count) > 0]
        if not options:
            return f"{MOST_SEEDS} seeds of {max(CONFIGURATIONS)} configurations would not decide it"
        minutes, seeds, count = min(options)
        return _told(f"{seeds} seeds of {count} configurations, about {minutes:.0f} core-minutes,", distance,
                     self.forecast(seeds, count), self.half_width)


@dataclass(frozen=True)
class Trials:
    """Two rates of independent trials, as a robot's."""

    one: float
    other: float

    def needed(self, distance: float) -> str:
        """How many trials of each would decide a difference that is `distance` from the edge of what is claimed.

        >>> Trials(11 / 30, 7 / 30).needed(0.13)
        '191 trials of each would decide it four times in five (+-0.091)'
        """
        wanted = _wanted(distance)
        variance = self.one * (1 - self.one) + self.other * (1 - self.other)
        return _told(f"{math.ceil(ndtri(0.975)**2 * variance / wanted**2)} trials of each", distance, wanted)


@dataclass(frozen=True)
class Seeds:
    """A number over fixed configurations, such as all places of a grid: more seeds of the same runs tell it better.

    Args:
        seeds: of each of its runs.
        half_width: half its 95 % interval.
        minutes: core-minutes of one seed of all its runs.
        fixed: the part of `half_width` that configurations make, and no seed narrows.
    """

    seeds: int
    half_width: float
    minutes: float
    fixed: float = 0.0

    def forecast(self, seeds: int) -> float:
        """Half the 95 % interval that so many seeds would give: all but the fixed part narrows with their root."""
        own = max(self.half_width**2 - self.fixed**2, 0.0)
        return math.sqrt(min(self.fixed, self.half_width) ** 2 + own * self.seeds / seeds)

    def needed(self, distance: float) -> str:
        """How many seeds would decide a number that is `distance` from the edge of what is claimed.

        >>> Seeds(3, 0.33, 30.0).needed(0.19)
        '19 seeds, about 480 core-minutes, would decide it four times in five (+-0.13)'
        >>> Seeds(3, 0.33, 30.0, fixed=0.2).needed(0.19)
        'no number of seeds would decide it: it takes more configurations'
        """
        wanted = _wanted(distance)
        if self.fixed > wanted:
            return "no number of seeds would decide it: it takes more configurations"
        seeds = next((seeds for seeds in range(self.seeds + 1, MOST_SEEDS + 1) if self.forecast(seeds) <= wanted), None)
        if seeds is None:
            return f"{MOST_SEEDS} seeds would not decide it"
        return _told(f"{seeds} seeds, about {self.minutes * (seeds - self.seeds):.0f} core-minutes,", distance,
                     self.forecast(seeds), self.half_width)


def _wanted(distance: float) -> float:
    """The half interval that would decide a number so far from the edge."""
    return HALF * max(abs(distance), LEAST_EFFECT)


def _told(amount: str, distance: float, half_width: float, there: float = math.inf) -> str:
    """What an amount would do; of a number that is very near to the edge, what it would do for one that is not."""
    if abs(distance) >= LEAST_EFFECT:
        return f"{amount} would decide it four times in five (+-{half_width:.2g})"
    if there <= _wanted(distance):
        return f"the runs there are would see {LEAST_EFFECT:g} from the edge; it is nearer than that"
    return f"{amount} would see {LEAST_EFFECT:g} from the edge four times in five (+-{half_width:.2g}); it is nearer"

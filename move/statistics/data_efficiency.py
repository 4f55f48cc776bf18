"""How many times MOVE's timesteps static needs for the same success: figure 4 as one number a task.

Success is taken to rise with the logarithm of the timesteps: an isotonic fit through the rates of each method, straight
between budgets. The level asked for is MOVE's fitted success at one budget; static's fit says at which budget it has as
much. Below static's smallest budget and above its largest nothing is known: it is then "at most" or "more than".
The interval resamples configurations, the same ones for all budgets and both methods, and lets every rate differ by
what trainings differ, with the tails of the Student's t that this is known by.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from move.statistics.intervals import CONFIDENCE
from move.statistics.training_noise import UNKNOWN, TrainingNoise, training_scale

Curve = Mapping[int, np.ndarray]
"""Timesteps -> successes, (seeds, configurations)."""


@dataclass(frozen=True)
class Efficiency:
    """Static's timesteps over MOVE's for the same success; `inf` where static's curve does not reach it.

    `least` and `most` are the ratios of static's smallest and largest budget: the answer cannot lie outside them.
    `draws` are the ratios of all resamples; empty where they are not kept.
    """

    ratio: float
    low: float
    high: float
    least: float
    most: float
    draws: np.ndarray = field(default_factory=lambda: np.empty(0), repr=False, compare=False)

    def __str__(self) -> str:
        return f"{self._text(self.ratio)} [{self._text(self.low)}, {self._text(self.high)}]"

    def surely(self, ratio: float, above: float) -> float:
        """`ratio` as far as it tells whether it is above a number: of `inf` only "more than `most`" is known."""
        return ratio if ratio <= self.most or self.most >= above else self.most

    def p_value(self, above: float) -> float:
        """Twice the share of resamples that are not surely above a number, one resample at the least."""
        sure = np.where((self.draws <= self.most) | (self.most >= above), self.draws, self.most)
        return min(1.0, 2 * max(int((sure <= above).sum()), 1) / len(self.draws))

    def _text(self, ratio: float) -> str:
        if ratio > self.most:
            return f"> {self.most:.2g}"
        return f"<= {self.least:.2g}" if ratio <= self.least else f"{ratio:.2g}"


def isotonic(rates: np.ndarray) -> np.ndarray:
    """The rising sequences nearest to `rates` along the last axis, as `scipy.optimize.isotonic_regression` finds one.

    By the minimax formula, for all leading axes at once: of the means from any place up to here to any from here on,
    the largest of the smallest.
    """
    count = rates.shape[-1]
    sums = np.concatenate([np.zeros((*rates.shape[:-1], 1)), rates.cumsum(axis=-1)], axis=-1)
    means = [[(sums[..., last + 1] - sums[..., first]) / (last + 1 - first) for last in range(first, count)]
             for first in range(count)]
    return np.stack([np.max([np.min(means[first][place - first:], axis=0) for first in range(place + 1)], axis=0)
                     for place in range(count)], axis=-1)


def needed(budgets: np.ndarray, rates: np.ndarray, levels: float | np.ndarray) -> np.ndarray:
    """The timesteps at which monotone curves through (budgets, rates) have their level; `inf` where one never does.

    Args:
        budgets: timesteps, increasing, (n,).
        rates: success rates, (..., n).
        levels: (...).

    >>> round(float(needed(np.array([1000, 10_000]), np.array([.2, .4]), .3)))
    3162
    """
    fitted, levels = isotonic(rates), np.asarray(levels, float)[..., None]
    reached = np.argmax(fitted >= levels - 1e-12, axis=-1)[..., None]
    before = np.maximum(reached - 1, 0)
    below, above = (np.take_along_axis(fitted, place, -1) for place in (before, reached))
    share = (levels - below) / np.where(above > below, above - below, 1)
    found = np.where(reached > 0, budgets[before] * (budgets[reached] / budgets[before]) ** share, budgets[0])
    return np.where(levels > fitted[..., -1:] + 1e-12, np.inf, found)[..., 0]


def data_efficiency(
    static: Curve, move: Curve, budget: int, noise: TrainingNoise = UNKNOWN, draws: int = 1000
) -> Efficiency:
    """Static's timesteps over `budget` for the success that MOVE has at `budget`, with a 95 % interval.

    Args:
        static, move: at two budgets or more each; all with the same configurations in the same order.
        noise: how much rates differ from training to training.

    Raises:
        ValueError: a curve of one budget, or MOVE has not `budget`.
    """
    if min(len(static), len(move)) < 2 or budget not in move:
        raise ValueError(f"data_efficiency: {sorted(static)} and {sorted(move)} timesteps given; allowed are two "
                         f"budgets or more of each, {budget} among MOVE's")
    rng, configurations = np.random.default_rng(0), next(iter(move.values())).shape[1]
    drawn = rng.integers(0, configurations, (draws, configurations))
    places = drawn + configurations * np.arange(draws)[:, None]
    counts = np.bincount(places.ravel(), minlength=drawn.size).reshape(drawn.shape) / configurations
    ratio = float(_ratio(static, move, budget, np.full((1, configurations), 1 / configurations), UNKNOWN, rng)[0])
    ratios = _ratio(static, move, budget, counts, noise, rng)
    low, high = np.quantile(ratios, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], method="nearest")
    return Efficiency(ratio, float(low), float(high), min(static) / budget, max(static) / budget, ratios)


def _ratio(
    static: Curve, move: Curve, budget: int, weights: np.ndarray, noise: TrainingNoise, rng: np.random.Generator
) -> np.ndarray:
    """One ratio a row of `weights`, which are the configurations' (draws, configurations)."""
    (sizes, rates), (more, others) = ((np.array(sorted(curve)), np.stack(
        [_rates(curve[size], weights, noise, rng) for size in sorted(curve)], axis=-1)) for curve in (static, move))
    level = isotonic(others)[:, list(more).index(budget)]
    return needed(sizes, rates, level) / budget


def _rates(
    successes: np.ndarray, weights: np.ndarray, noise: TrainingNoise, rng: np.random.Generator
) -> np.ndarray:
    rates = weights @ successes.mean(axis=0)
    scale, degrees = training_scale(successes, noise)
    return rates + np.sqrt(max(float(scale), 0)) * rng.standard_t(degrees, len(rates)) if noise.degrees else rates

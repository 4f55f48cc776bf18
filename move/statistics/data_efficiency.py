"""How many times MOVE's timesteps static needs for the same success: figure 4 as one number a task.

Success is taken to rise with the logarithm of the timesteps: an isotonic fit through the rates of each method, straight
between budgets. The level asked for is MOVE's fitted success at one budget; static's fit says at which budget it has as
much. Below static's smallest budget and above its largest nothing is known: it is then "at most" or "more than".
The interval resamples configurations, the same ones for all budgets and both methods, and lets every rate differ by
what trainings differ.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import isotonic_regression

from move.statistics.estimates import UNKNOWN, TrainingNoise
from move.statistics.intervals import CONFIDENCE

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
        return f"{self._told(self.ratio)} [{self._told(self.low)}, {self._told(self.high)}]"

    def surely(self, ratio: float, above: float) -> float:
        """`ratio` as far as it tells whether it is above a number: of `inf` only "more than `most`" is known."""
        return ratio if ratio <= self.most or self.most >= above else self.most

    def p_value(self, above: float) -> float:
        """Twice the share of resamples that are not surely above a number, one resample at the least.

        Raises:
            ValueError: the resamples were not kept.
        """
        if not len(self.draws):
            raise ValueError("p_value: no resample is kept; allowed is one or more")
        short = sum(self.surely(ratio, above) <= above for ratio in self.draws)
        return min(1.0, 2 * max(short, 1) / len(self.draws))

    def _told(self, ratio: float) -> str:
        if ratio > self.most:
            return f"> {self.most:.2g}"
        return f"<= {self.least:.2g}" if ratio <= self.least else f"{ratio:.2g}"


def needed(budgets: np.ndarray, rates: np.ndarray, level: float) -> float:
    """The timesteps at which a monotone curve through (budgets, rates) has `level`; `inf` where it never does.

    Args:
        budgets: timesteps, increasing, (n,).
        rates: success rates, (n,).

    >>> round(needed(np.array([1000, 10_000]), np.array([.2, .4]), .3))
    3162
    """
    fitted = isotonic_regression(rates).x
    if level > fitted[-1] + 1e-12:
        return float("inf")
    reached = int(np.argmax(fitted >= level - 1e-12))
    if reached == 0:
        return float(budgets[0])
    below, above = fitted[reached - 1], fitted[reached]
    share = (level - below) / (above - below)
    logs = np.log(budgets)
    return float(np.exp(logs[reached - 1] + share * (logs[reached] - logs[reached - 1])))


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
    rng = np.random.default_rng(0)
    ratios = [_ratio(static, move, budget, None, 0.0, rng)]
    configurations = next(iter(move.values())).shape[1]
    for _ in range(draws):
        drawn = rng.integers(0, configurations, (configurations,))
        ratios.append(_ratio(static, move, budget, drawn, noise.deviation, rng))
    low, high = np.quantile(ratios[1:], [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], method="nearest")
    return Efficiency(ratios[0], float(low), float(high), min(static) / budget, max(static) / budget,
                      np.array(ratios[1:]))


def _ratio(
    static: Curve, move: Curve, budget: int, drawn: np.ndarray | None, deviation: float, rng: np.random.Generator
) -> float:
    curves = []
    for curve in (static, move):
        budgets = np.array(sorted(curve))
        rates = np.array([_rate(curve[size], drawn, deviation, rng) for size in budgets])
        curves.append((budgets, rates))
    level = isotonic_regression(curves[1][1]).x[list(curves[1][0]).index(budget)]
    return needed(*curves[0], level) / budget


def _rate(successes: np.ndarray, drawn: np.ndarray | None, deviation: float, rng: np.random.Generator) -> float:
    if drawn is None:
        return float(successes.mean())
    return float(successes[:, drawn].mean() + rng.normal(0, deviation / np.sqrt(len(successes))))

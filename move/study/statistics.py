"""Rates with intervals: pure functions of arrays, nothing read and nothing drawn.

Layout everywhere: `successes` has shape (seeds, configurations), one row an independent collection and training, one
column a configuration that all seeds share.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from move.intervals import CONFIDENCE, wilson_interval

DRAWS = 2000  # of the bootstrap


@dataclass(frozen=True)
class Rate:
    """A success rate in [0, 1] with its 95 % interval."""

    value: float
    low: float
    high: float
    seeds: int
    episodes: int

    def __str__(self) -> str:
        return f"{self.value:.3f} [{self.low:.3f}, {self.high:.3f}]"


def design_effect(successes: np.ndarray) -> float:
    """How much more the seeds' rates vary than episodes of one seed would: at least 1.

    The variance of the seeds' means over the binomial variance of one mean; 1 for a single seed, whose spread cannot
    be known.
    """
    seeds, configurations = successes.shape
    rate = successes.mean()
    if seeds < 2 or rate in (0.0, 1.0):
        return 1.0
    return max(1.0, float(successes.mean(axis=1).var(ddof=1) / (rate * (1 - rate) / configurations)))


def success_rate(successes: np.ndarray) -> Rate:
    """Mean success of all episodes with Wilson's 95 % interval at the effective number of episodes.

    The episodes are divided by the design effect, so that seeds that disagree widen the interval.

    Args:
        successes: (seeds, configurations) of bool or 0/1.

    Raises:
        ValueError: no episode.

    >>> print(success_rate(np.array([[1] * 8 + [0] * 12])))
    0.400 [0.219, 0.613]
    """
    successes = np.atleast_2d(np.asarray(successes, float))
    if successes.size == 0:
        raise ValueError("success_rate: no episode given; allowed is at least one")
    effective = successes.size / design_effect(successes)
    rate = float(successes.mean())
    low, high = wilson_interval(rate, effective)
    return Rate(rate, low, high, seeds=len(successes), episodes=successes.size)


def difference(first: np.ndarray, second: np.ndarray, rng: np.random.Generator) -> tuple[float, float, float]:
    """Rate of `first` minus rate of `second` with a 95 % bootstrap interval.

    Configurations are resampled in pairs, and seeds are resampled within each method where there are several.

    Args:
        first, second: (seeds, configurations), the same configurations in the same order.

    Returns:
        difference, low, high.

    Raises:
        ValueError: different configurations.
    """
    return mean_difference([(first, second)], rng)


def mean_difference(
    pairs: list[tuple[np.ndarray, np.ndarray]], rng: np.random.Generator
) -> tuple[float, float, float]:
    """Mean over tasks of `difference`, with a 95 % bootstrap interval; the tasks themselves are not resampled.

    Args:
        pairs: one a task, each as `difference` takes them.

    Returns:
        mean difference, low, high.

    Raises:
        ValueError: different configurations.
    """
    each = [_bootstrap(first, second, rng) for first, second in pairs]
    low, high = np.quantile(np.mean(each, axis=0), [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    return float(np.mean([np.mean(first) - np.mean(second) for first, second in pairs])), float(low), float(high)


def _bootstrap(first: np.ndarray, second: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """DRAWS differences of the rates of resampled seeds and configurations."""
    first, second = np.atleast_2d(np.asarray(first, float)), np.atleast_2d(np.asarray(second, float))
    if first.shape[1] != second.shape[1]:
        raise ValueError(f"difference: {first.shape[1]} and {second.shape[1]} configurations; they must be the same")
    draws = np.empty(DRAWS)
    for index in range(DRAWS):
        columns = rng.integers(first.shape[1], size=first.shape[1])
        draws[index] = _resampled(first, columns, rng) - _resampled(second, columns, rng)
    return draws


def _resampled(successes: np.ndarray, columns: np.ndarray, rng: np.random.Generator) -> float:
    rows = rng.integers(len(successes), size=len(successes))
    return successes[rows][:, columns].mean()


"""What success rates can say: intervals that count configurations once and include how trainings differ.

Layout everywhere: `successes` has shape (..., seeds, configurations), one row an independent collection and training,
one column an evaluation configuration that all seeds (and all methods) share. An outcome is taken as a mean, plus what
this training does to all configurations, plus what this configuration does to all trainings, plus the rest: the
two-way layout with random effects. A rate's variance is then

    training variance / seeds  +  variance over configurations / configurations,

and the same holds for a difference of two methods at the same configurations, with two trainings' variances.

The first part is known as `move.statistics.training_noise` says, and the sum has the interval of a `Spread`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr

from move.statistics.spread import Spread
from move.statistics.training_noise import UNKNOWN, TrainingNoise, as_cell, moderated, residual, shrunk_rate


@dataclass(frozen=True)
class Estimate:
    """A rate, or a difference of rates, with its 95 % interval and how much the interval knows about training.

    `trainings` is "moderated" (own seeds and like cells), "own" (own seeds alone), "like cells" (of a single seed) or
    "unknown" (evaluation alone); `p_value` is two-sided, that a difference is 0, and NaN for a rate.
    """

    value: float
    low: float
    high: float
    seeds: int
    episodes: int
    trainings: str
    p_value: float = float("nan")

    def __str__(self) -> str:
        return f"{self.value:.3f} [{self.low:.3f}, {self.high:.3f}]"


def success_rate(successes: np.ndarray, noise: TrainingNoise = UNKNOWN) -> Estimate:
    """Mean success of all episodes with a 95 % interval, centred as Agresti and Coull's and never of zero width.

    Args:
        successes: (seeds, configurations) of bool or 0/1.
        noise: the training variance of like cells.

    Raises:
        ValueError: no episode.

    >>> print(success_rate(np.array([[1] * 8 + [0] * 12])))
    0.400 [0.181, 0.652]
    """
    cell = as_cell(successes)
    low, high = rate_interval(cell, noise)
    return Estimate(float(cell.mean()), float(low), float(high), len(cell), cell.size, _known(noise, cell))


def rate_interval(cells: np.ndarray, noise: TrainingNoise = UNKNOWN) -> tuple[np.ndarray, np.ndarray]:
    """The 95 % intervals of `success_rate`, low and high, of cells (..., seeds, configurations)."""
    rate, spread = _rate(cells, noise)
    centre, half = shrunk_rate(cells), spread.half_width
    return np.clip(np.minimum(rate, centre - half), 0, 1), np.clip(np.maximum(rate, centre + half), 0, 1)


def difference(first: np.ndarray, second: np.ndarray, noise: TrainingNoise = UNKNOWN) -> Estimate:
    """Rate of `first` minus rate of `second` at the same configurations, with a 95 % interval and a p value.

    Args:
        first, second: (seeds, configurations), the same configurations in the same order.
        noise: the training variance of like cells.

    Raises:
        ValueError: different configurations.
    """
    return contrast([first, second], [1.0, -1.0], noise)


def contrast(cells: Sequence[np.ndarray], weights: Sequence[float], noise: TrainingNoise = UNKNOWN) -> Estimate:
    """The sum of several rates times their weights, all at the same configurations, with interval and p value.

    Args:
        cells: each (seeds, configurations), the same configurations in the same order.

    Raises:
        ValueError: different configurations.

    >>> print(contrast([np.array([[1] * 8 + [0] * 12])] * 3, [1, -2, 1]))
    0.000 [-0.218, 0.218]
    """
    listed = [as_cell(cell) for cell in cells]
    return _estimate(*paired_contrast(listed, weights, noise), listed, noise)


def mean_difference(pairs: Sequence[tuple[np.ndarray, np.ndarray]], noise: TrainingNoise = UNKNOWN) -> Estimate:
    """Mean over tasks of `difference`: what another training and other configurations of these same tasks would give.

    Args:
        pairs: one a task, each as `difference` takes them.

    Raises:
        ValueError: different configurations.
    """
    return mean_contrast(pairs, (1.0, -1.0), noise)


def mean_contrast(
    tasks: Sequence[Sequence[np.ndarray]], weights: Sequence[float], noise: TrainingNoise = UNKNOWN
) -> Estimate:
    """Mean over tasks of `contrast`, each task with cells of its own.

    Raises:
        ValueError: different configurations within a task.
    """
    cells = [[as_cell(cell) for cell in task] for task in tasks]
    found = _mean([paired_contrast(task, weights, noise) for task in cells])
    return _estimate(*found, [cell for task in cells for cell in task], noise)


def unpaired_difference(first: np.ndarray, second: np.ndarray, noise: TrainingNoise = UNKNOWN) -> Estimate:
    """Rate of `first` minus rate of `second` where each has configurations of its own, as with other factors random.

    Args:
        first, second: (seeds, configurations).
        noise: the training variance of like cells.

    >>> print(unpaired_difference(np.array([[1] * 12 + [0] * 8]), np.array([[1] * 4 + [0] * 16])))
    0.400 [0.098, 0.702]
    """
    cells = [as_cell(first), as_cell(second)]
    (one, spread), (other, more) = (_rate(cell, noise) for cell in cells)
    return _estimate(one - other, Spread.total([spread, more]), cells, noise)


def relative_gain(pairs: Sequence[tuple[np.ndarray, np.ndarray]], noise: TrainingNoise = UNKNOWN) -> Estimate:
    """Mean rate of the firsts over that of the seconds, minus 1, with the interval of the logarithm of that ratio.

    Both rates are taken as uncertain, and as independent: that the configurations are the same narrows nothing.

    Args:
        pairs: one a task, each as `difference` takes them.

    Raises:
        ValueError: one of the mean rates is 0, so that there is no ratio.
    """
    means = [_mean([_rate(as_cell(pair[place]), noise) for pair in pairs]) for place in (0, 1)]
    if not all(value for value, _ in means):
        raise ValueError("relative_gain: a mean rate of 0 given; allowed is above 0")
    half = Spread.total(spread.times(1 / value) for value, spread in means).half_width
    ratio = means[0][0] / means[1][0]
    cells = [as_cell(cell) for pair in pairs for cell in pair]
    return Estimate(float(ratio - 1), float(ratio * np.exp(-half) - 1), float(ratio * np.exp(half) - 1),
                    min(map(len, cells)), sum(cell.size for cell in cells), _known(noise, *cells))


def holm(p_values: Sequence[float]) -> np.ndarray:
    """The p values of several comparisons, adjusted by Holm so that a wrong one among all is as rare as for one.

    >>> holm([0.01, 0.04, 0.03])
    array([0.03, 0.06, 0.06])
    """
    values = np.asarray(p_values, float)
    order, adjusted = np.argsort(values, kind="stable"), np.empty(len(values))
    not_smaller = np.arange(len(values), 0, -1)
    adjusted[order] = np.minimum(np.maximum.accumulate(values[order] * not_smaller), 1)
    return adjusted


def _known(noise: TrainingNoise, *cells: np.ndarray) -> str:
    single = any(len(cell) < 2 for cell in cells)
    if noise.degrees:
        return "like cells" if single else "moderated"
    return "unknown" if single else "own"


def of_configurations(
    cells: Sequence[np.ndarray], weights: Sequence[float], rests: Sequence[np.ndarray] | None = None
) -> Spread:
    """What configurations alone add to the weighted sum of the rates of `cells`, and no further training narrows.

    Args:
        rests: of each cell, where they are known, what `residual` gives.
    """
    rests = [residual(cell) for cell in cells] if rests is None else rests
    by_configuration = sum(weight * cell.mean(axis=-2) for weight, cell in zip(weights, cells, strict=True))
    count = by_configuration.shape[-1]
    over = by_configuration.var(axis=-1, ddof=1) / count if count > 1 else np.full(by_configuration.shape[:-1], 0.25)
    counted = sum(weight**2 * rest / cell.shape[-2] for weight, cell, rest in zip(weights, cells, rests, strict=True))
    return Spread.of(np.maximum(over - counted, 0), max(count - 1, 1))


def _spread(cells: Sequence[np.ndarray], weights: Sequence[float], noise: TrainingNoise) -> Spread:
    """Of the weighted sum of the rates of `cells` at the same configurations, each cell trained for itself."""
    parts, rests = [], []
    for weight, cell in zip(weights, cells, strict=True):
        variance, rest, degrees = moderated(cell, noise)
        parts.append(Spread.of(variance / cell.shape[-2], degrees).times(weight))
        rests.append(rest)
    return Spread.total([of_configurations(cells, weights, rests), *parts])


def _rate(cells: np.ndarray, noise: TrainingNoise) -> tuple[np.ndarray, Spread]:
    centre, seeds = shrunk_rate(cells), cells.shape[-2]
    least = np.maximum(centre * (1 - centre) / (seeds * cells.shape[-1]), residual(cells) / seeds)
    return cells.mean(axis=(-2, -1)), _spread([cells], [1.0], noise).at_least(least)


def paired_contrast(
    cells: Sequence[np.ndarray], weights: Sequence[float], noise: TrainingNoise
) -> tuple[np.ndarray, Spread]:
    """Weighted sums of rates and what they may be off by, of cells (..., seeds, configurations).

    Raises:
        ValueError: different configurations.
    """
    counts = sorted({cell.shape[-1] for cell in cells})
    if len(counts) > 1:
        raise ValueError(f"cells: {counts[0]} and {counts[-1]} configurations given; allowed are the same ones for all")
    value = sum(weight * cell.mean(axis=(-2, -1)) for weight, cell in zip(weights, cells, strict=True))
    pairs = np.square(weights).sum() / min(cell.shape[-2] for cell in cells)
    return value, _spread(cells, weights, noise).at_least(pairs / (counts[0] + 2) ** 2)  # as one more pair each way


def _mean(parts: Sequence[tuple[np.ndarray, Spread]]) -> tuple[np.ndarray, Spread]:
    """The mean of independent estimates."""
    values, spreads = zip(*parts, strict=True)
    return np.mean(values, axis=0), Spread.total(spreads).times(1 / len(parts))


def _estimate(value: np.ndarray, spread: Spread, cells: Sequence[np.ndarray], noise: TrainingNoise) -> Estimate:
    exact = round(float(value), 12) + 0.0  # equal counts differ by 0, not by -2e-18
    half, (scale, degrees) = float(spread.half_width), spread.student
    return Estimate(exact, max(-1.0, exact - half), min(1.0, exact + half), min(map(len, cells)),
                    sum(cell.size for cell in cells), _known(noise, *cells),
                    float(2 * stdtr(degrees, -abs(exact) / scale)))

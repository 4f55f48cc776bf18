"""What success rates can say: intervals that count configurations once and know that another training differs.

Layout everywhere: `successes` has shape (seeds, configurations), one row an independent collection and training, one
column an evaluation configuration that all seeds (and all methods) share. An outcome is taken as a mean, plus what
this training does to all configurations, plus what this configuration does to all trainings, plus the rest: the
two-way layout with random effects. A rate's variance is then

    training variance / seeds  +  variance over configurations / configurations,

and the same holds for a difference of two methods at the same configurations, with two trainings' variances. With
three seeds or more a method's own spread tells its training variance; with fewer it is pooled over other cells, and
where nothing tells it the interval knows about evaluation alone. Student's quantiles with Welch-Satterthwaite degrees
of freedom account for how well each part is known.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats
from statsmodels.stats.multitest import multipletests

from move.statistics.intervals import CONFIDENCE

OWN_SEEDS = 3  # from so many on a cell's own seeds tell its training variance
RATE_SHARE, DIFFERENCE_SHARE = 0.3, 1.3
"""One over the degrees of freedom of a sum is the sum over its parts of share ** this / degrees.

Welch and Satterthwaite have 2, for which three seeds that agree by chance claim too much: a rate's interval then covers
.91 where trainings differ by .2. These two values were chosen by simulation, and the tests hold them to .93 to .97.
"""


@dataclass(frozen=True)
class TrainingNoise:
    """How much a success rate varies from training to training: variance of a rate in [0, 1], and how well known."""

    variance: float
    degrees: float  # of freedom; 0 where nothing is known

    @property
    def deviation(self) -> float:
        """Standard deviation, a rate in [0, 1]."""
        return float(np.sqrt(self.variance))


UNKNOWN = TrainingNoise(0.0, 0.0)


@dataclass(frozen=True)
class Estimate:
    """A rate, or a difference of rates, with its 95 % interval and what the interval knows about training.

    `trainings` is "own" (from the cell's own seeds), "pooled" (from other cells) or "unknown" (evaluation alone);
    `p_value` is two-sided, that a difference is 0, and NaN for a rate.
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


def pooled_noise(cells: Iterable[np.ndarray]) -> TrainingNoise:
    """The training variance that cells of two seeds or more share: the mean of their own, by degrees of freedom.

    Args:
        cells: each (seeds, configurations); those of one seed tell nothing.
    """
    own = [(_training_variance(cell), len(cell) - 1) for cell in map(_as_cell, cells) if len(cell) > 1]
    if not own:
        return UNKNOWN
    variances, degrees = np.array(own, float).T
    return TrainingNoise(max(0.0, float(np.average(variances, weights=degrees))), float(degrees.sum()))


def success_rate(successes: np.ndarray, pooled: TrainingNoise = UNKNOWN) -> Estimate:
    """Mean success of all episodes with a 95 % interval, centred as Agresti and Coull's and never of zero width.

    Args:
        successes: (seeds, configurations) of bool or 0/1.
        pooled: the training variance of like cells, used below three seeds.

    Raises:
        ValueError: no episode.

    >>> print(success_rate(np.array([[1] * 8 + [0] * 12])))
    0.400 [0.181, 0.652]
    """
    cell = _as_cell(successes)
    rate, variance, degrees = _rate(cell, pooled)
    centre, half = _centre(cell), _quantile(degrees) * np.sqrt(variance)
    return Estimate(rate, max(0.0, min(rate, centre - half)), min(1.0, max(rate, centre + half)), len(cell), cell.size,
                    _known(pooled, cell))


def difference(first: np.ndarray, second: np.ndarray, pooled: TrainingNoise = UNKNOWN) -> Estimate:
    """Rate of `first` minus rate of `second` at the same configurations, with a 95 % interval and a p value.

    Args:
        first, second: (seeds, configurations), the same configurations in the same order.
        pooled: the training variance of like cells, used for a method of fewer than three seeds.

    Raises:
        ValueError: different configurations.
    """
    value, variance, degrees = _difference(_as_cell(first), _as_cell(second), pooled)
    return _estimate(value, variance, degrees, [_as_cell(first), _as_cell(second)], pooled)


def mean_difference(pairs: Sequence[tuple[np.ndarray, np.ndarray]], pooled: TrainingNoise = UNKNOWN) -> Estimate:
    """Mean over tasks of `difference`: what another training and other configurations of these same tasks would give.

    Args:
        pairs: one a task, each as `difference` takes them.

    Raises:
        ValueError: different configurations.
    """
    value, variance, degrees = _mean([_difference(_as_cell(first), _as_cell(second), pooled)
                                      for first, second in pairs])
    return _estimate(value, variance, degrees, [_as_cell(cell) for pair in pairs for cell in pair], pooled)


def unpaired_difference(first: np.ndarray, second: np.ndarray, pooled: TrainingNoise = UNKNOWN) -> Estimate:
    """Rate of `first` minus rate of `second` where each has configurations of its own, as with other factors random.

    Args:
        first, second: (seeds, configurations).
        pooled: the training variance of like cells, used for a method of fewer than three seeds.

    >>> print(unpaired_difference(np.array([[1] * 12 + [0] * 8]), np.array([[1] * 4 + [0] * 16])))
    0.400 [0.099, 0.701]
    """
    cells = [_as_cell(first), _as_cell(second)]
    (one, *first_part), (other, *second_part) = (_rate(cell, pooled) for cell in cells)
    return _estimate(one - other, *_sum([first_part, second_part]), cells, pooled)


def relative_gain(pairs: Sequence[tuple[np.ndarray, np.ndarray]], pooled: TrainingNoise = UNKNOWN) -> Estimate:
    """Mean rate of the firsts over that of the seconds, minus 1, with the interval of the logarithm of that ratio.

    Both rates are taken as uncertain, and as independent: that the configurations are the same narrows nothing.

    Args:
        pairs: one a task, each as `difference` takes them.

    Raises:
        ValueError: one of the mean rates is 0, so that there is no ratio.
    """
    means = [_mean([_rate(_as_cell(pair[place]), pooled) for pair in pairs]) for place in (0, 1)]
    if not all(value for value, _, _ in means):
        raise ValueError("relative_gain: a mean rate of 0 given; allowed is above 0")
    variance, degrees = _sum([(variance / value**2, degrees) for value, variance, degrees in means])
    ratio, half = means[0][0] / means[1][0], _quantile(degrees) * np.sqrt(variance)
    cells = [_as_cell(cell) for pair in pairs for cell in pair]
    return Estimate(float(ratio - 1), float(ratio * np.exp(-half) - 1), float(ratio * np.exp(half) - 1),
                    min(map(len, cells)), sum(cell.size for cell in cells), _known(pooled, *cells))


def holm(p_values: Sequence[float]) -> np.ndarray:
    """The p values of several comparisons, adjusted by Holm so that a wrong one among all is as rare as for one."""
    return multipletests(p_values, method="holm")[1]


def _as_cell(successes: np.ndarray) -> np.ndarray:
    cell = np.atleast_2d(np.asarray(successes, float))
    if cell.size == 0:
        raise ValueError("successes: no episode given; allowed is at least one")
    return cell


def _has_own(cell: np.ndarray) -> bool:
    return len(cell) >= OWN_SEEDS


def _known(pooled: TrainingNoise, *cells: np.ndarray) -> str:
    if all(_has_own(cell) for cell in cells):
        return "own"
    return "pooled" if pooled.degrees else "unknown"


def _rest(cell: np.ndarray) -> float:
    """What neither training nor configuration explains, as it enters the variance of the cell's mean."""
    seeds, configurations = cell.shape
    if seeds < 2 or configurations < 2:
        return 0.0
    residual = cell - cell.mean(axis=0) - cell.mean(axis=1, keepdims=True) + cell.mean()
    return float((residual**2).sum() / ((seeds - 1) * (configurations - 1)) / cell.size)


def _training_variance(cell: np.ndarray) -> float:
    """Unbiased estimate of the training variance of one cell; may be below 0."""
    return float(cell.mean(axis=1).var(ddof=1)) - _rest(cell) * len(cell)


def _over_trainings(cell: np.ndarray, pooled: TrainingNoise) -> tuple[float, float, float]:
    """Training variance of the cell's mean, its degrees of freedom, and by how much its estimate fell below 0."""
    if _has_own(cell):
        net = _training_variance(cell) / len(cell)
        return max(net, 0.0), len(cell) - 1, min(net, 0.0)
    return pooled.variance / len(cell), pooled.degrees, 0.0


def _total(
    by_configuration: np.ndarray, cells: list[np.ndarray], pooled: TrainingNoise, least: float, power: float
) -> tuple[float, float]:
    """Variance and degrees of freedom of a mean over configurations, for which each of `cells` was trained."""
    count = len(by_configuration)
    parts: list[tuple[float, float]] = [
        (float(by_configuration.var(ddof=1)) / count, count - 1) if count > 1 else (0.25, 1)]
    below = 0.0
    for cell in cells:
        variance, degrees, chance = _over_trainings(cell, pooled)
        parts, below = [*parts, (variance, degrees)], below + chance
    whole = sum(variance for variance, _ in parts)
    if not whole:
        return least, parts[0][1]
    weights = sum((variance / whole) ** power / degrees for variance, degrees in parts if variance)
    return max(whole + below, parts[0][0], least), 1 / weights


def _quantile(degrees: float) -> float:
    return float(stats.t.ppf((1 + CONFIDENCE) / 2, degrees))


def _centre(cell: np.ndarray) -> float:
    """The rate with two successes and two failures more: never 0 or 1."""
    trials = cell.shape[1]
    return float((cell.mean() * trials + 2) / (trials + 4))


def _rate(cell: np.ndarray, pooled: TrainingNoise) -> tuple[float, float, float]:
    """Value, variance and degrees of freedom."""
    centre = _centre(cell)
    least = max(centre * (1 - centre) / cell.size, _rest(cell))
    return float(cell.mean()), *_total(cell.mean(axis=0), [cell], pooled, least, RATE_SHARE)


def _difference(first: np.ndarray, second: np.ndarray, pooled: TrainingNoise) -> tuple[float, float, float]:
    """Value, variance and degrees of freedom."""
    if first.shape[1] != second.shape[1]:
        raise ValueError(f"difference: {first.shape[1]} and {second.shape[1]} configurations; they must be the same")
    apart = first.mean(axis=0) - second.mean(axis=0)
    least = 2 / (len(apart) + 2) ** 2 / min(len(first), len(second))  # as one more pair each way: no zero width
    return float(apart.mean()), *_total(apart, [first, second], pooled, least, DIFFERENCE_SHARE)


def _sum(parts: Iterable[Sequence[float]]) -> tuple[float, float]:
    """Variance of a sum of independent parts, each (variance, degrees of freedom), and its own degrees of freedom."""
    variances, degrees = np.array(list(parts)).T
    return float(variances.sum()), float(variances.sum() ** 2 / (variances**2 / degrees).sum())


def _mean(parts: Sequence[tuple[float, float, float]]) -> tuple[float, float, float]:
    """The mean of independent parts, each (value, variance, degrees of freedom), as such a part."""
    variance, degrees = _sum(part[1:] for part in parts)
    return float(np.mean([part[0] for part in parts])), variance / len(parts) ** 2, degrees


def _estimate(
    value: float, variance: float, degrees: float, cells: list[np.ndarray], pooled: TrainingNoise
) -> Estimate:
    deviation = np.sqrt(variance)
    half = _quantile(degrees) * deviation
    return Estimate(value, max(-1.0, value - half), min(1.0, value + half), min(map(len, cells)),
                    sum(cell.size for cell in cells), _known(pooled, *cells),
                    float(2 * stats.t.sf(abs(value) / deviation, degrees)))

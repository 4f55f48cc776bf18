"""What success rates can say: intervals that count configurations once and include how trainings differ.

Layout everywhere: `successes` has shape (..., seeds, configurations), one row an independent collection and training,
one column an evaluation configuration that all seeds (and all methods) share. An outcome is taken as a mean, plus what
this training does to all configurations, plus what this configuration does to all trainings, plus the rest: the
two-way layout with random effects. A rate's variance is then

    training variance / seeds  +  variance over configurations / configurations,

and the same holds for a difference of two methods at the same configurations, with two trainings' variances.

Three seeds hardly tell a training variance, and cells differ in it. So it is moderated as limma does (Smyth 2004): over
like cells it follows a scaled inverse chi-squared law (`TrainingNoise`), and a cell's own seeds count as so many more
degrees of freedom. One seed has the law alone. Near 0 and 1 rates have no room to differ: the law's scale goes with
4 rate (1 - rate), as that of a beta-binomial does.

Each part of a variance that is known by so many degrees of freedom is a scaled Student's t; a sum of them is taken as
the Student's t of the same variance and the same fourth cumulant.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import betaln, stdtr, stdtrit, xlogy

from move.statistics.intervals import CONFIDENCE

FEWEST_DEGREES = 5.0  # a Student's t of four or fewer has no fourth cumulant
PRIOR_DEGREES = (5.0, 6.0, 8.0, 11.0, 16.0, 32.0, 1000.0)
CURVATURE = 2.4
"""An interval of 95 % whose variance is off by so much, relative variance, covers less than it should on the average:
chi-squared's second derivative over its first, (1.96^2 + 1) / 2. So much more variance makes up for it."""
UNDECIDED = 1.0  # log-likelihood below the largest that still speaks for a law


@dataclass(frozen=True)
class TrainingNoise:
    """How much success rates vary from training to training, over cells: a scaled inverse chi-squared law.

    `variance` is the law's scale for a rate of one half, `degrees` its degrees of freedom (the fewer, the more do cells
    differ in how much their trainings do; 0: nothing is known), `repeats` how many repeated trainings tell it.
    """

    variance: float
    degrees: float
    repeats: int = 0

    @property
    def deviation(self) -> float:
        """Standard deviation of a typical cell's rates around one half."""
        return float(np.sqrt(self.variance))


UNKNOWN = TrainingNoise(0.0, 0.0)


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


class Spread(NamedTuple):
    """What an estimate may be off by: variance and fourth cumulant, arrays of one shape; sums of both are of sums."""

    variance: np.ndarray
    fourth: np.ndarray

    @staticmethod
    def of(scale: np.ndarray, degrees: float) -> Spread:
        """A Student's t with that squared scale; of fewer than five degrees, five with the same 95 % interval."""
        if not degrees:
            return Spread(np.zeros_like(scale), np.zeros_like(scale))
        if degrees < FEWEST_DEGREES:
            scale = scale * (stdtrit(degrees, 0.975) / stdtrit(FEWEST_DEGREES, 0.975)) ** 2
            degrees = FEWEST_DEGREES
        variance = scale * degrees / (degrees - 2)
        return Spread(variance, 6 / (degrees - 4) * variance**2)

    @staticmethod
    def total(parts: Iterable[Spread]) -> Spread:
        """Of a sum of independent parts."""
        return Spread(*(np.sum(each, axis=0) for each in zip(*parts, strict=True)))

    def times(self, factor: float | np.ndarray) -> Spread:
        """Of so many times the estimate."""
        return Spread(self.variance * factor**2, self.fourth * factor**4)

    def at_least(self, variance: float | np.ndarray) -> Spread:
        """The same with no less than that variance."""
        return Spread(np.maximum(self.variance, variance), self.fourth)

    @property
    def student(self) -> tuple[np.ndarray, np.ndarray]:
        """Scale and degrees of freedom of the Student's t with this variance and fourth cumulant."""
        degrees = 4 + 6 * self.variance**2 / np.maximum(self.fourth, 1e-300)
        return np.sqrt(self.variance * (degrees - 2) / degrees), np.minimum(degrees, 1e6)

    @property
    def half_width(self) -> np.ndarray:
        """Half the width of the 95 % interval."""
        scale, degrees = self.student
        return stdtrit(degrees, (1 + CONFIDENCE) / 2) * scale


def training_noise_of(cells: Iterable[np.ndarray]) -> TrainingNoise:
    """The law that the training variances of cells of two seeds or more follow.

    Its mean is that of their unbiased estimates, and a little more, for a mean of few cells is off itself. A variance
    between seeds, over the law's scale plus what evaluation adds, follows an F law; of the degrees of freedom the
    fewest are taken that this likelihood does not speak against, for that few cells agree does not show that all do.

    Args:
        cells: each (seeds, configurations); those of one seed, or of one outcome alone, tell nothing.
    """
    told = [cell for cell in map(_as_cell, cells) if len(cell) > 1 and np.ptp(cell) > 0]
    if not told:
        return UNKNOWN
    own, rest, room, degrees = np.array([(_between(cell), _residual(cell), _room(cell), len(cell) - 1)
                                         for cell in told]).T
    mean = max(float((degrees * (own - rest)).sum() / (degrees * room).sum()), _LEAST_VARIANCE)
    off = float(np.square(degrees * (own - rest - mean * room)).sum() / (degrees * room).sum() ** 2) / mean**2
    mean *= 1 + min(CURVATURE * off, 1.0)
    likelihood = np.array([_law(few, mean * room, np.maximum(own, _LEAST_VARIANCE), rest, degrees)
                           for few in PRIOR_DEGREES])
    few = PRIOR_DEGREES[int(np.argmax(likelihood >= likelihood.max() - UNDECIDED))]
    return TrainingNoise(mean * (few - 2) / few, few, int(degrees.sum()))


def _law(few: float, mean: np.ndarray, own: np.ndarray, rest: np.ndarray, degrees: np.ndarray) -> float:
    """Log-likelihood of variances between seeds where training's follow a law of those means and degrees of freedom."""
    scale = mean * (few - 2) / few + rest
    return float((_log_f(own / scale, degrees, few) - np.log(scale)).sum())


def _log_f(ratio: np.ndarray, first: np.ndarray, second: float) -> np.ndarray:
    """Logarithm of the density of the F law with these degrees of freedom; `scipy.stats` takes a second to import."""
    return (second / 2 * np.log(second) + first / 2 * np.log(first) + xlogy(first / 2 - 1, ratio)
            - ((first + second) / 2 * np.log(second + first * ratio) + betaln(first / 2, second / 2)))


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
    cell = _as_cell(successes)
    low, high = rate_interval(cell, noise)
    return Estimate(float(cell.mean()), float(low), float(high), len(cell), cell.size, _known(noise, cell))


def rate_interval(cells: np.ndarray, noise: TrainingNoise = UNKNOWN) -> tuple[np.ndarray, np.ndarray]:
    """The 95 % intervals of `success_rate`, low and high, of cells (..., seeds, configurations)."""
    rate, spread = _rate(cells, noise)
    centre, half = _centre(cells), spread.half_width
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
    listed = [_as_cell(cell) for cell in cells]
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
    cells = [[_as_cell(cell) for cell in task] for task in tasks]
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
    cells = [_as_cell(first), _as_cell(second)]
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
    means = [_mean([_rate(_as_cell(pair[place]), noise) for pair in pairs]) for place in (0, 1)]
    if not all(value for value, _ in means):
        raise ValueError("relative_gain: a mean rate of 0 given; allowed is above 0")
    half = Spread.total(spread.times(1 / value) for value, spread in means).half_width
    ratio = means[0][0] / means[1][0]
    cells = [_as_cell(cell) for pair in pairs for cell in pair]
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


def training_scale(cells: np.ndarray, noise: TrainingNoise) -> tuple[np.ndarray, float]:
    """What a rate varies by from training to training: squared scale and degrees of freedom of a Student's t.

    Args:
        cells: (..., seeds, configurations); the rate is the mean of the seeds.
    """
    between, rest, degrees = _trained(cells, noise)
    return (between - rest) / cells.shape[-2], degrees


_LEAST_VARIANCE = 2.5e-5  # between seeds: of half an episode in a hundred


def _as_cell(successes: np.ndarray) -> np.ndarray:
    cell = np.atleast_2d(np.asarray(successes, float))
    if cell.size == 0:
        raise ValueError("successes: no episode given; allowed is at least one")
    return cell


def _known(noise: TrainingNoise, *cells: np.ndarray) -> str:
    single = any(len(cell) < 2 for cell in cells)
    if noise.degrees:
        return "like cells" if single else "moderated"
    return "unknown" if single else "own"


def _between(cells: np.ndarray) -> np.ndarray:
    """Variance of the seeds' own rates at these configurations: of trainings, and what `_residual` gives."""
    return cells.mean(axis=-1).var(axis=-1, ddof=1)


def _residual(cells: np.ndarray) -> np.ndarray:
    """What neither training nor configuration explains, as it enters the variance of one seed's rate."""
    seeds, configurations = cells.shape[-2:]
    if seeds < 2 or configurations < 2:
        return np.zeros(cells.shape[:-2])
    grand = cells.mean(axis=(-2, -1), keepdims=True)
    rest = cells - cells.mean(axis=-2, keepdims=True) - cells.mean(axis=-1, keepdims=True) + grand
    return (rest**2).sum(axis=(-2, -1)) / ((seeds - 1) * (configurations - 1)) / configurations


def _trained(cells: np.ndarray, noise: TrainingNoise) -> tuple[np.ndarray, np.ndarray, float]:
    """Moderated variance of one seed's rate, the part of it that is not training's, and its degrees of freedom."""
    seeds, rest, law = cells.shape[-2], _residual(cells), noise.variance * _room(cells)
    if seeds < 2:
        return law, rest, noise.degrees
    degrees = noise.degrees + seeds - 1
    variance = (noise.degrees * (law + rest) + (seeds - 1) * _between(cells)) / degrees
    return np.maximum(variance, rest), rest, degrees


def _spread(cells: Sequence[np.ndarray], weights: Sequence[float], noise: TrainingNoise) -> Spread:
    """Of the weighted sum of the rates of `cells` at the same configurations, each cell trained for itself."""
    by_configuration = sum(weight * cell.mean(axis=-2) for weight, cell in zip(weights, cells, strict=True))
    count = by_configuration.shape[-1]
    over = by_configuration.var(axis=-1, ddof=1) / count if count > 1 else np.full(by_configuration.shape[:-1], 0.25)
    parts, counted = [], 0.0
    for weight, cell in zip(weights, cells, strict=True):
        variance, rest, degrees = _trained(cell, noise)
        parts.append(Spread.of(variance / cell.shape[-2], degrees).times(weight))
        counted = counted + weight**2 * rest / cell.shape[-2]
    return Spread.total([Spread.of(np.maximum(over - counted, 0), max(count - 1, 1)), *parts]).at_least(over)


def _centre(cells: np.ndarray) -> np.ndarray:
    """The rate with two successes and two failures more: never 0 or 1."""
    trials = cells.shape[-1]
    return (cells.mean(axis=(-2, -1)) * trials + 2) / (trials + 4)


def _room(cells: np.ndarray) -> np.ndarray:
    """How much of the variance that a rate of one half may have is left to this one."""
    centre = _centre(cells)
    return 4 * centre * (1 - centre)


def _rate(cells: np.ndarray, noise: TrainingNoise) -> tuple[np.ndarray, Spread]:
    centre, seeds = _centre(cells), cells.shape[-2]
    least = np.maximum(centre * (1 - centre) / (seeds * cells.shape[-1]), _residual(cells) / seeds)
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

"""How much success differs from training to training, in one cell and over like cells.

Three seeds hardly tell a training variance, and cells differ in it. So it is moderated as limma does (Smyth 2004): over
like cells it follows a scaled inverse chi-squared law (`TrainingNoise`), and a cell's own seeds count as so many more
degrees of freedom. One seed has the law alone. Near 0 and 1 rates have no room to differ: the law's scale goes with
4 rate (1 - rate), as that of a beta-binomial does.

A cell is an array (..., seeds, configurations) of 0 and 1, as in `move.statistics.estimates`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.special import betaln, xlogy

PRIOR_DEGREES = (5.0, 6.0, 8.0, 11.0, 16.0, 32.0, 1000.0)
CURVATURE = 2.4
"""An interval of 95 % whose variance is off by so much, relative variance, covers less than it should on the average:
chi-squared's second derivative over its first, (1.96^2 + 1) / 2. So much more variance makes up for it."""
UNDECIDED = 1.0  # log-likelihood below the largest that still speaks for a law
LEAST_VARIANCE = 2.5e-5  # between seeds: of half an episode in a hundred


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


def training_noise_of(cells: Iterable[np.ndarray]) -> TrainingNoise:
    """The law that the training variances of cells of two seeds or more follow.

    Its mean is that of their unbiased estimates, and a little more, for a mean of few cells is off itself. A variance
    between seeds, over the law's scale plus what evaluation adds, follows an F law; of the degrees of freedom the
    fewest are taken that this likelihood does not speak against, for that few cells agree does not show that all do.

    Args:
        cells: each (seeds, configurations); those of one seed, or of one outcome alone, tell nothing.
    """
    told = [cell for cell in map(as_cell, cells) if len(cell) > 1 and np.ptp(cell) > 0]
    if not told:
        return UNKNOWN
    own, rest, room, degrees = np.array([(_between(cell), residual(cell), room_to_differ(cell), len(cell) - 1)
                                         for cell in told]).T
    mean = max(float((degrees * (own - rest)).sum() / (degrees * room).sum()), LEAST_VARIANCE)
    off = float(np.square(degrees * (own - rest - mean * room)).sum() / (degrees * room).sum() ** 2) / mean**2
    mean *= 1 + min(CURVATURE * off, 1.0)
    likelihood = np.array([_law(few, mean * room, np.maximum(own, LEAST_VARIANCE), rest, degrees)
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


def training_scale(cells: np.ndarray, noise: TrainingNoise) -> tuple[np.ndarray, float]:
    """What a rate varies by from training to training: squared scale and degrees of freedom of a Student's t.

    Args:
        cells: (..., seeds, configurations); the rate is the mean of the seeds.
    """
    between, rest, degrees = moderated(cells, noise)
    return (between - rest) / cells.shape[-2], degrees


def moderated(cells: np.ndarray, noise: TrainingNoise) -> tuple[np.ndarray, np.ndarray, float]:
    """Moderated variance of one seed's rate, the part of it that is not training's, and its degrees of freedom."""
    seeds, rest, law = cells.shape[-2], residual(cells), noise.variance * room_to_differ(cells)
    if seeds < 2:
        return law, rest, noise.degrees
    degrees = noise.degrees + seeds - 1
    variance = (noise.degrees * (law + rest) + (seeds - 1) * _between(cells)) / degrees
    return np.maximum(variance, rest), rest, degrees


def as_cell(successes: np.ndarray) -> np.ndarray:
    """Successes as an array of floats with a row a seed.

    Raises:
        ValueError: no episode.
    """
    cell = np.atleast_2d(np.asarray(successes, float))
    if cell.size == 0:
        raise ValueError("successes: no episode given; allowed is at least one")
    return cell


def _between(cells: np.ndarray) -> np.ndarray:
    """Variance of the seeds' own rates at these configurations: of trainings, and what `residual` gives."""
    return cells.mean(axis=-1).var(axis=-1, ddof=1)


def residual(cells: np.ndarray) -> np.ndarray:
    """What neither training nor configuration explains, as it enters the variance of one seed's rate."""
    seeds, configurations = cells.shape[-2:]
    if seeds < 2 or configurations < 2:
        return np.zeros(cells.shape[:-2])
    grand = cells.mean(axis=(-2, -1), keepdims=True)
    rest = cells - cells.mean(axis=-2, keepdims=True) - cells.mean(axis=-1, keepdims=True) + grand
    return (rest**2).sum(axis=(-2, -1)) / ((seeds - 1) * (configurations - 1)) / configurations


def shrunk_rate(cells: np.ndarray) -> np.ndarray:
    """The rate with two successes and two failures more: never 0 or 1."""
    trials = cells.shape[-1]
    return (cells.mean(axis=(-2, -1)) * trials + 2) / (trials + 4)


def room_to_differ(cells: np.ndarray) -> np.ndarray:
    """How much of the variance that a rate of one half may have is left to this one."""
    centre = shrunk_rate(cells)
    return 4 * centre * (1 - centre)

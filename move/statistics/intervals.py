"""Plain intervals of a share of trials and of a mean of few values; what knows of trainings is in `estimates`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri, stdtrit

from move.errors import BadInput

CONFIDENCE = 0.95
LEAST_ERROR = 1e-3  # standard, of the mean of a few values, which may agree by chance


def wilson_interval(rate: float, trials: float) -> tuple[float, float]:
    """Wilson's 95 % interval of a success rate.

    Args:
        rate: successes over trials, in [0, 1].
        trials: number of independent trials; an effective number may be fractional.

    >>> low, high = wilson_interval(0.4, 20)
    >>> round(low, 3), round(high, 3)
    (0.219, 0.613)
    """
    normal, share = -ndtri((1 - CONFIDENCE) / 2), rate * trials / trials
    whole = 1 + normal**2 / trials
    centre = (share + normal**2 / (2 * trials)) / whole
    half = normal * np.sqrt(share * (1 - share) / trials + normal**2 / (4 * trials**2)) / whole
    return min(max(float(centre - half), 0.0), rate), max(min(float(centre + half), 1.0), rate)


def exact_interval(successes: int, trials: int) -> tuple[float, float]:
    """Clopper and Pearson's 95 % interval of a success rate: never covers less often than that.

    Raises:
        BadInput: successes outside 0..trials.

    >>> low, high = exact_interval(1, 30)
    >>> round(low, 4), round(high, 4)
    (0.0008, 0.1722)
    """
    if not 0 <= successes <= trials or trials < 1:
        raise BadInput(f"{successes} successes of {trials} trials: allowed are 0..trials of at least one trial")
    from scipy.stats import beta  # slow to import, and only trials by hand ask

    low = beta.ppf((1 - CONFIDENCE) / 2, successes, trials - successes + 1) if successes else 0.0
    high = beta.isf((1 - CONFIDENCE) / 2, successes + 1, trials - successes) if successes < trials else 1.0
    return float(low), float(high)


def mean_interval(values: ArrayLike, least_error: float = 0.0) -> tuple[float, float, float]:
    """The mean of values, and the ends of Student's 95 % interval of it; NaN for a single value.

    Args:
        least_error: the least standard error that is believed.

    >>> mean, low, high = mean_interval([1.0, 2.0, 3.0])
    >>> mean, round(low, 3), round(high, 3)
    (2.0, -0.484, 4.484)
    """
    found = np.asarray(values, float)
    deviation = float(found.std(ddof=1)) if len(found) > 1 else float("nan")
    mean, half = float(found.mean()), student_half_width(max(deviation, least_error * len(found) ** 0.5), len(found))
    return mean, mean - half, mean + half


def student_half_width(deviation: float, count: int) -> float:
    """Half the width of Student's 95 % interval of the mean of `count` values with that standard deviation.

    NaN for a single value, whose spread cannot be known.

    >>> round(student_half_width(1.0, 4), 3)
    1.591
    """
    return float(stdtrit(count - 1, (1 + CONFIDENCE) / 2) * deviation / np.sqrt(count)) if count > 1 else float("nan")


def jackknife(labels: np.ndarray, statistic: Callable[[np.ndarray], np.ndarray | float]
              ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A statistic of all rows, and the ends of its 95 % interval from leaving out the rows of each label in turn.

    Args:
        labels: (rows,), such as the run that each row is of.
        statistic: takes a mask of rows, gives a number or an array.

    >>> value, low, high = jackknife(np.arange(5), lambda mask: np.arange(5)[mask].mean())
    >>> float(value), round(float(high - low) / 2, 3)  # as Student's interval of a mean
    (2.0, 1.963)
    """
    whole = np.asarray(statistic(np.ones(len(labels), bool)), float)
    without = np.array([statistic(labels != label) for label in np.unique(labels)])
    count = len(without)
    error = np.sqrt((count - 1) / count * ((without - without.mean(axis=0)) ** 2).sum(axis=0))
    half = stdtrit(count - 1, (1 + CONFIDENCE) / 2) * error
    return whole, whole - half, whole + half

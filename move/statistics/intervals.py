"""Intervals of rates and of means; every room takes them from here."""

from __future__ import annotations

import numpy as np
from scipy import stats
from statsmodels.stats.proportion import proportion_confint

from move.errors import BadInput

CONFIDENCE = 0.95


def wilson_interval(rate: float, trials: float, *, level: float = CONFIDENCE) -> tuple[float, float]:
    """Wilson's interval of a success rate.

    Args:
        rate: successes over trials, in [0, 1].
        trials: number of independent trials; an effective number may be fractional.

    >>> low, high = wilson_interval(0.4, 20)
    >>> round(low, 3), round(high, 3)
    (0.219, 0.613)
    """
    low, high = proportion_confint(rate * trials, trials, alpha=1 - level, method="wilson")
    return min(float(low), rate), max(float(high), rate)  # against rounding at 0 and 1


def exact_interval(successes: int, trials: int, *, level: float = CONFIDENCE) -> tuple[float, float]:
    """Clopper-Pearson interval of a success rate: never covers less often than `level`.

    Raises:
        BadInput: successes outside 0..trials.

    >>> low, high = exact_interval(1, 30)
    >>> round(low, 4), round(high, 4)
    (0.0008, 0.1722)
    """
    if not 0 <= successes <= trials or trials < 1:
        raise BadInput(f"{successes} successes of {trials} trials: allowed are 0..trials of at least one trial")
    low, high = proportion_confint(successes, trials, alpha=1 - level, method="beta")
    return float(low), float(high)


def student_half_width(deviation: float, count: int, *, level: float = CONFIDENCE) -> float:
    """Half the width of Student's interval of the mean of `count` values with that standard deviation.

    NaN for a single value, whose spread cannot be known.

    >>> round(student_half_width(1.0, 4), 3)
    1.591
    """
    return float(stats.t.ppf((1 + level) / 2, count - 1) * deviation / np.sqrt(count)) if count > 1 else float("nan")

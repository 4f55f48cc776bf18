"""One evaluation minus another at the same configurations: also where few configurations tell them apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from move.statistics.estimates import Estimate, difference
from move.statistics.intervals import exact_interval


def exact_difference(first: np.ndarray, second: np.ndarray) -> Estimate:
    """Rate of `first` minus rate of `second`, with McNemar's exact two-sided p.

    The interval is that of `difference`, widened where the test is less sure: to the difference that Clopper and
    Pearson's interval allows of the configurations at which one succeeds and the other fails. How much trainings differ
    is not counted.

    Args:
        first, second: (configurations,) of bool or 0/1, the same configurations in the same order.

    Raises:
        ValueError: different configurations, or none.

    >>> print(exact_difference(np.array([1] * 5 + [0] * 15), np.zeros(20)))
    0.250 [-0.011, 0.458]
    """
    one, other = (np.atleast_2d(np.asarray(each, float)) for each in (first, second))
    usual, won, lost = difference(one, other), int((one > other).sum()), int((one < other).sum())
    apart, low, high = won + lost, usual.low, usual.high
    if apart:
        least, most = (apart / one.size * (2 * share - 1) for share in exact_interval(won, apart))
        low, high = min(low, least), max(high, most)
    return replace(usual, low=low, high=high, p_value=mcnemar(won, lost))


def mcnemar(won: int, lost: int) -> float:
    """Exact two-sided p of so many configurations at which the first alone succeeds, and the second alone.

    >>> mcnemar(2, 0), mcnemar(0, 0)
    (0.5, 1.0)
    """
    from scipy.stats import binomtest  # slow to import

    return float(binomtest(won, won + lost).pvalue) if won + lost else 1.0

"""One evaluation minus another at the same configurations: also where few configurations tell them apart."""

from __future__ import annotations

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
    from scipy.stats import binomtest  # slow to import

    one, other = (np.atleast_2d(np.asarray(each, float)) for each in (first, second))
    usual, apart = difference(one, other), one != other
    if not apart.any():
        return Estimate(0.0, usual.low, usual.high, 1, one.size + other.size, usual.trainings, 1.0)
    won, count = int((one > other).sum()), int(apart.sum())
    low, high = (count / one.size * (2 * share - 1) for share in exact_interval(won, count))
    return Estimate(usual.value, min(low, usual.low), max(high, usual.high), 1, one.size + other.size, usual.trainings,
                    float(binomtest(won, count).pvalue))

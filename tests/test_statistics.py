"""The difference of two methods is paired: configurations are resampled for both alike."""

import numpy as np

from move.study import statistics


def widths(first: np.ndarray, second: np.ndarray) -> float:
    _, low, high = statistics.difference(first, second, np.random.default_rng(0))
    return high - low


def test_pairing_makes_the_interval_narrow_where_configurations_decide_and_not_where_they_do_not():
    rng = np.random.default_rng(3)
    hard = rng.random((1, 200)) < 0.5
    first = hard ^ (rng.random((1, 200)) < 0.03)  # nearly the same configurations fail
    shuffled = first[:, rng.permutation(200)]  # the same rate, other configurations
    together, apart = widths(first, hard), widths(shuffled, hard)
    unpaired = 2 * 1.96 * np.sqrt(2 * 0.25 / 200)
    assert together < 0.45 * unpaired and 0.8 * unpaired < apart < 1.2 * unpaired

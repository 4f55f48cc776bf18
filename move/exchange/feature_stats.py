"""Statistics of a data set's features, as LeRobot keeps them: of each episode, and of all from those of the episodes.

A quantile is the smallest value that a share q of the frames does not exceed. LeRobot finds it in a histogram of 5,000
bins; here it is exact, so the two differ by a bin at most. Of all frames LeRobot keeps the mean of the episodes'
quantiles, weighted by their frames, and so does this.
"""

from __future__ import annotations

import numpy as np

Stats = dict[str, list]  # min, max, mean, std, count and the quantiles
QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


def feature_stats(values: np.ndarray) -> Stats:
    """min, max, mean, std, count and five quantiles.

    Args:
        values: (T, n) numbers, or (T, height, width, 3) uint8 images, whose statistics are per channel, in [0, 1],
            of shape (3, 1, 1).

    >>> found = feature_stats(np.array([[1.0], [3.0]]))
    >>> found["mean"], found["std"], found["count"], found["q50"], found["q99"]
    ([2.0], [1.0], [2], [1.0], [3.0])
    """
    images = values.ndim == 4
    table = values.reshape(-1, values.shape[-1])
    scale, shape = (255.0, (3, 1, 1)) if images else (1.0, (-1,))
    found = {"min": table.min(axis=0), "max": table.max(axis=0), "mean": table.mean(axis=0, dtype=np.float64),
             "std": table.std(axis=0, dtype=np.float64),
             **dict(zip(QUANTILES, np.quantile(table, list(QUANTILES.values()), axis=0, method="inverted_cdf"),
                        strict=True))}
    return {**{name: (value / scale).reshape(shape).tolist() for name, value in found.items()}, "count": [len(values)]}


def pooled_stats(episodes: list[dict[str, Stats]]) -> dict[str, Stats]:
    """Statistics of all frames from those of the episodes."""
    pooled = {}
    for feature in episodes[0]:
        each = {name: np.array([stats[feature][name] for stats in episodes]) for name in episodes[0][feature]}
        count, mean = each.pop("count").ravel(), each["mean"]
        centre = np.average(mean, axis=0, weights=count)
        found = {"min": each["min"].min(axis=0), "max": each["max"].max(axis=0), "mean": centre,
                 "std": np.sqrt(np.average(each["std"] ** 2 + (mean - centre) ** 2, axis=0, weights=count)),
                 **{name: np.average(each[name], axis=0, weights=count) for name in QUANTILES}}
        pooled[feature] = {**{name: value.tolist() for name, value in found.items()}, "count": [int(count.sum())]}
    return pooled

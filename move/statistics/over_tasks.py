"""Two methods over tasks, the tasks taken as a sample: what another set of tasks might give."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from move.statistics.intervals import CONFIDENCE, LEAST_ERROR, mean_interval

DRAWS = 4000  # resamples of the tasks


@dataclass(frozen=True)
class OverTasks:
    """Two methods compared over tasks, the tasks themselves taken as a sample: what another set of tasks might give.

    Means and interquartile means (IQM) of the rates of each method; the probability that a training of the first beats
    one of the second on a task drawn at random (ties count half); p of the exact test that flips each task's sign.
    """

    tasks: int
    mean_difference: float
    low: float
    high: float
    iqm_first: float
    iqm_second: float
    iqm_low: float  # of the difference of the interquartile means
    iqm_high: float
    improvement: float
    improvement_low: float
    improvement_high: float
    p_value: float


def over_tasks(pairs: Sequence[tuple[np.ndarray, np.ndarray]]) -> OverTasks:
    """Compare two methods with the task as the unit; intervals are of tasks resampled (t for the mean).

    Args:
        pairs: one a task, each as `move.statistics.estimates.difference` takes them; at least three.

    Raises:
        ValueError: fewer than three tasks.
    """
    if len(pairs) < 3:
        raise ValueError(f"over_tasks: {len(pairs)} tasks given; allowed are three or more")
    cells = [[np.atleast_2d(np.asarray(cell, float)) for cell in pair] for pair in pairs]
    rates = np.array([[first.mean(), second.mean()] for first, second in cells])
    better = np.array([_beats(first, second) for first, second in cells])
    differences = rates[:, 0] - rates[:, 1]
    mean, low, high = mean_interval(differences, LEAST_ERROR)
    iqm = _resampled(rates, lambda drawn: _iqm(drawn[..., 0]) - _iqm(drawn[..., 1]))
    improvement = _resampled(better[:, None], lambda drawn: drawn[..., 0].mean(axis=-1))
    return OverTasks(
        tasks=len(pairs), mean_difference=mean, low=low, high=high,
        iqm_first=float(_iqm(rates[:, 0])), iqm_second=float(_iqm(rates[:, 1])), iqm_low=iqm[0], iqm_high=iqm[1],
        improvement=float(better.mean()), improvement_low=improvement[0], improvement_high=improvement[1],
        p_value=_p_of_flipped_signs(differences))


def _beats(first: np.ndarray, second: np.ndarray) -> float:
    apart = first.mean(axis=1)[:, None] - second.mean(axis=1)[None]
    return float((apart > 0).mean() + (apart == 0).mean() / 2)


def _iqm(rates: np.ndarray) -> np.ndarray:
    """Mean of the middle half along the last axis, a quarter cut off at each end, rounded down to whole rates."""
    count, cut = rates.shape[-1], rates.shape[-1] // 4
    return np.partition(rates, (cut, count - cut - 1), axis=-1)[..., cut:count - cut].mean(axis=-1)


def _p_of_flipped_signs(differences: np.ndarray) -> float:
    """Twice the share of all ways to flip signs whose mean is as extreme as that of `differences`, at most 1."""
    signs = 1 - 2 * (np.arange(2 ** len(differences))[:, None] >> np.arange(len(differences)) & 1)
    means = signs @ differences
    extreme = (means >= abs(differences.sum()) - 1e-12).mean()
    return float(min(2 * extreme, 1))


def _resampled(values: np.ndarray, statistic: Callable[[np.ndarray], np.ndarray]) -> tuple[float, float]:
    """Percentile interval of a statistic of rows drawn with replacement, the same draws each time."""
    rows = np.random.default_rng(0).integers(len(values), size=(DRAWS, len(values)))
    ends = np.quantile(statistic(values[rows]), [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    return float(ends[0]), float(ends[1])

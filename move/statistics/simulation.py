"""Outcomes of trainings that nobody ran, with a known truth: what an interval is held to.

In logits, an episode's chance of success is a centre, plus what its training does to all configurations, plus what its
configuration does to all trainings; both effects are normal.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
from scipy.optimize import root
from scipy.special import expit

from move.statistics.estimates import OWN_SEEDS, UNKNOWN, TrainingNoise, pooled_noise, success_rate
from move.statistics.intervals import wilson_interval

DIFFICULTY = 1.5  # logits by which configurations differ, standard deviation
LIKE_CELLS = 10  # cells of three seeds that tell a single seed's noise
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(31)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


def outcomes(
    rng: np.random.Generator, rate: float, deviation: float, seeds: int, difficulty: np.ndarray
) -> np.ndarray:
    """Successes, shape (seeds, configurations), of a method whose true rate is `rate`.

    Args:
        rate: over all trainings and all configurations, in (0, 1).
        deviation: of a training's rate over all configurations, standard deviation.
        difficulty: (configurations,), standard normal; the same array for methods tried at the same configurations.
    """
    centre, slope = _logits(rate, deviation)
    trained = centre + slope * rng.standard_normal((seeds, 1))
    return rng.random((seeds, len(difficulty))) < expit(trained + DIFFICULTY * difficulty)


def like_noise(rng: np.random.Generator, rate: float, deviation: float, configurations: int) -> TrainingNoise:
    """The training noise that ten other cells of three seeds tell, as those of one table do."""
    return pooled_noise(outcomes(rng, rate, deviation, 3, rng.standard_normal(configurations))
                        for _ in range(LIKE_CELLS))


def coverage(seeds: list[int], deviations: list[float], rate: float, draws: int, configurations: int = 100
             ) -> pd.DataFrame:
    """How often a rate's 95 % interval holds the truth, and how wide it is; ours, and Wilson's over all episodes.

    Returns:
        One row a number of seeds, deviation and interval ("ours" or "episodes alone"): covered, half_width.
    """
    rows = []
    for count in seeds:
        for deviation in deviations:
            rng = np.random.default_rng([count, round(1000 * deviation)])
            ends: dict[str, list[tuple[float, float]]] = {"ours": [], "episodes alone": []}
            for _ in range(draws):
                cell = outcomes(rng, rate, deviation, count, rng.standard_normal(configurations))
                noise = like_noise(rng, rate, deviation, configurations) if count < OWN_SEEDS else UNKNOWN
                found = success_rate(cell, noise)
                ends["ours"].append((found.low, found.high))
                ends["episodes alone"].append(wilson_interval(cell.mean(), cell.size))
            for name, pairs in ends.items():
                low, high = np.array(pairs).T
                rows.append({"seeds": count, "deviation": deviation, "interval": name,
                             "covered": ((low <= rate) & (rate <= high)).mean(), "half_width": (high - low).mean() / 2})
    return pd.DataFrame(rows)


@cache
def _logits(rate: float, deviation: float) -> tuple[float, float]:
    """Centre and slope, in logits, that give this mean and this deviation of trainings.

    Raises:
        ValueError: no centre and slope do, as for a deviation that a rate cannot have.
    """
    def missed(given: np.ndarray) -> np.ndarray:
        over = expit(given[0] + given[1] * _NODES[:, None] + DIFFICULTY * _NODES[None]) @ _WEIGHTS
        mean = _WEIGHTS @ over
        return np.array([mean - rate, np.sqrt(_WEIGHTS @ (over - mean) ** 2) - deviation])

    found = root(missed, [1.4 * np.log(rate / (1 - rate)), 1.4 * deviation / (rate * (1 - rate))])
    if not found.success or np.abs(found.fun).max() > 1e-6:
        raise ValueError(f"rate {rate}, deviation {deviation}: no logits give them; allowed is a smaller deviation")
    return float(found.x[0]), abs(float(found.x[1]))

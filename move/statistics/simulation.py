"""Outcomes of trainings that nobody ran, with a known truth: what an interval is held to.

In logits, an episode's chance of success is a centre, plus what its training does to all configurations, plus what its
configuration does to all trainings; both effects are normal.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
from scipy.special import expit

from move.statistics.estimates import rate_interval
from move.statistics.intervals import wilson_interval
from move.statistics.training_noise import TrainingNoise, training_noise_of

DIFFICULTY = 1.5  # logits by which configurations differ, standard deviation
LIKE_CELLS = 30  # cells of three seeds that tell how much trainings differ, as many as table 2 has
STUDIES_A_LAW = 100  # simulated studies that share what those cells tell
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(31)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


def outcomes(
    rng: np.random.Generator, rate: float, deviation: float | np.ndarray, seeds: int, difficulty: np.ndarray
) -> np.ndarray:
    """Successes, shape (seeds, configurations), of a method whose true rate is `rate`.

    Args:
        rate: over all trainings and all configurations, in (0, 1).
        deviation: of a training's rate over all configurations, standard deviation; (n,) for n cells at once, whose
            successes are (n, seeds, configurations).
        difficulty: (configurations,) or (n, configurations), standard normal; the same array for methods tried at the
            same configurations.
    """
    centre, slope = np.array([_logits(rate, float(one)) for one in np.atleast_1d(deviation)]).T[..., None, None]
    trained = centre + slope * rng.standard_normal((len(centre), seeds, 1))
    chance = expit(trained + DIFFICULTY * np.atleast_2d(difficulty)[:, None])
    found = rng.random(chance.shape) < chance
    return found if np.ndim(deviation) else found[0]


def like_noise(
    rng: np.random.Generator, rate: float, deviations: float | np.ndarray, configurations: int
) -> TrainingNoise:
    """The training noise that thirty other cells of three seeds tell, as those of one table do.

    Args:
        deviations: of trainings, one or several; each cell has one of them.
    """
    each = rng.choice(np.atleast_1d(deviations), LIKE_CELLS)
    return training_noise_of(outcomes(rng, rate, each, 3, rng.standard_normal((LIKE_CELLS, configurations))))


def coverage(seeds: list[int], deviations: list[float], rate: float, draws: int, configurations: int = 100
             ) -> pd.DataFrame:
    """How often a rate's 95 % interval holds the truth, and how wide it is; ours, and Wilson's over all episodes.

    Cells are unequal: what a cell borrows comes from cells of all the deviations.

    Returns:
        One row a number of seeds, deviation and interval ("ours" or "episodes alone"): covered, half_width.
    """
    rows = []
    for count in seeds:
        for deviation in deviations:
            rng = np.random.default_rng([count, round(1000 * deviation)])
            ends: dict[str, list[np.ndarray]] = {"ours": [], "episodes alone": []}
            for first in range(0, draws, STUDIES_A_LAW):
                studies = min(STUDIES_A_LAW, draws - first)
                noise = like_noise(rng, rate, np.array(deviations), configurations)
                hard = rng.standard_normal((studies, configurations))
                cells = outcomes(rng, rate, np.full(studies, deviation), count, hard)
                ends["ours"].append(np.array(rate_interval(cells, noise)))
                ends["episodes alone"].append(np.array([wilson_interval(cell.mean(), cell.size) for cell in cells]).T)
            for name, pairs in ends.items():
                low, high = np.concatenate(pairs, axis=1)
                rows.append({"seeds": count, "deviation": deviation, "interval": name,
                             "covered": ((low <= rate) & (rate <= high)).mean(), "half_width": (high - low).mean() / 2})
    return pd.DataFrame(rows)


@cache
def _logits(rate: float, deviation: float) -> tuple[float, float]:
    """Centre and slope, in logits, that give this mean and this deviation of trainings.

    Raises:
        ValueError: no centre and slope do, as for a deviation that a rate cannot have.
    """
    from scipy.optimize import root  # slow to import

    def missed(given: np.ndarray) -> np.ndarray:
        over = expit(given[0] + given[1] * _NODES[:, None] + DIFFICULTY * _NODES[None]) @ _WEIGHTS
        mean = _WEIGHTS @ over
        return np.array([mean - rate, np.sqrt(_WEIGHTS @ (over - mean) ** 2) - deviation])

    found = root(missed, [1.4 * np.log(rate / (1 - rate)), 1.4 * deviation / (rate * (1 - rate))])
    if not found.success or np.abs(found.fun).max() > 1e-6:
        raise ValueError(f"rate {rate}, deviation {deviation}: no logits give them; allowed is a smaller deviation")
    return float(found.x[0]), abs(float(found.x[1]))

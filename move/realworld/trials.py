"""What a handful of real-robot trials can and cannot show: exact intervals, exact tests, power, possible scores."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations
from math import factorial, prod

import numpy as np
import pandas as pd
from scipy import stats
from statsmodels.stats.proportion import confint_proportions_2indep

from move.errors import BadInput
from move.paper import REAL_POINTS, REAL_TRIALS, TABLE3_REAL
from move.statistics.intervals import CONFIDENCE, exact_interval

SIGNIFICANCE, WANTED_POWER = 1 - CONFIDENCE, 0.8
STEPS = 2**13  # from a base rate to 1, to the nearest of which a detectable rise is found


def real_table() -> pd.DataFrame:
    """Table 3 with what its 30 trials leave open.

    Returns:
        One row a cell: timesteps, method, successes, trials, rate, low, high (exact interval), score, normalised,
        score_low and score_high (least and most that the successes alone allow, normalised), and `readings`
        (number of ways the trials can be shared among 0, 1 and 2 points that give this total).
    """
    rows = []
    for cell in TABLE3_REAL.itertuples():
        low, high = exact_interval(cell.successes, REAL_TRIALS)
        least, most = score_bounds(cell.successes)
        points = REAL_POINTS * REAL_TRIALS
        rows.append({
            "timesteps": cell.timesteps, "method": cell.method, "successes": cell.successes, "trials": REAL_TRIALS,
            "rate": cell.successes / REAL_TRIALS, "low": low, "high": high, "score": cell.score,
            "normalised": cell.score / points, "score_low": least / points, "score_high": most / points,
            "readings": len(score_distributions(cell.successes, cell.score)),
        })
    return pd.DataFrame(rows)


def compare(first: tuple[int, int], second: tuple[int, int]) -> dict[str, float]:
    """Compare two success rates from independent trials.

    Args:
        first, second: (successes, trials).

    Returns:
        difference (second - first) with its Newcombe interval low, high (95 %); two-sided p-values `fisher` and
        `barnard`. Fisher's test is the more cautious of the two; both are exact.
    """
    (a, n), (b, m) = first, second
    for successes, trials in (first, second):
        exact_interval(successes, trials)
    table = [[b, a], [m - b, n - a]]
    low, high = confint_proportions_2indep(b, m, a, n, method="newcomb", compare="diff", alpha=SIGNIFICANCE)
    return {
        "difference": b / m - a / n, "low": float(low), "high": float(high),
        "fisher": float(stats.fisher_exact(table).pvalue),
        "barnard": float(stats.barnard_exact(table).pvalue) if a + b not in (0, n + m) else 1.0,
    }


def comparisons() -> pd.DataFrame:
    """Every pair of cells of Table 3, compared; columns `first`, `second` and those of `compare`.

    The p-values are of single comparisons; six are made here.
    """
    rows = []
    for a, b in combinations(TABLE3_REAL.itertuples(), 2):
        names = {"first": f"{a.method} {a.timesteps // 1000}k", "second": f"{b.method} {b.timesteps // 1000}k"}
        rows.append(names | compare((a.successes, REAL_TRIALS), (b.successes, REAL_TRIALS)))
    return pd.DataFrame(rows)


@lru_cache(maxsize=16)
def _rejected(trials: int) -> np.ndarray:
    """(trials + 1, trials + 1) bool: outcomes for which Fisher's two-sided test finds a difference."""
    counts = np.arange(trials + 1)
    rejected = np.zeros((trials + 1, trials + 1), dtype=bool)
    for total in range(2 * trials + 1):
        a = counts[(counts <= total) & (counts >= total - trials)]
        chance = stats.hypergeom.pmf(a, 2 * trials, total, trials)
        p = (chance[None, :] * (chance[None, :] <= chance[:, None] * (1 + 1e-7))).sum(axis=1)
        rejected[a, total - a] = p <= SIGNIFICANCE
    return rejected


def power(rate_a: float, rate_b: float, *, trials: int = REAL_TRIALS) -> float:
    """Chance that Fisher's exact test finds a difference between two true rates; exact, not simulated.

    Args:
        rate_a, rate_b: true success rates in 0..1.
        trials: trials of each method.
    """
    counts = np.arange(trials + 1)
    a, b = stats.binom.pmf(counts, trials, rate_a), stats.binom.pmf(counts, trials, rate_b)
    return float(a @ _rejected(trials) @ b)


def minimum_detectable_effect(base: float, *, trials: int = REAL_TRIALS) -> float:
    """Smallest rise above a base rate that is found four times in five; NaN where even success in every trial
    is not enough.

    >>> round(minimum_detectable_effect(7 / 30), 2)
    0.38
    """
    step = bisect_left(range(STEPS + 1), WANTED_POWER, key=lambda n: power(base, base + (1 - base) * n / STEPS,
                                                                           trials=trials))
    return (1 - base) * step / STEPS if step <= STEPS else float("nan")


def power_table(bases: Sequence[float], *, trials: Sequence[int]) -> pd.DataFrame:
    """Columns base, trials, detectable_rise, rate_needed: what so many trials of each method can show."""
    rows = [{"base": base, "trials": n, "detectable_rise": minimum_detectable_effect(base, trials=n)}
            for base in bases for n in trials]
    return pd.DataFrame(rows).assign(rate_needed=lambda table: table["base"] + table["detectable_rise"])


def score_bounds(successes: int, trials: int = REAL_TRIALS) -> tuple[int, int]:
    """Least and most points in all, given the successes at 3 points each; every other trial has 0, 1 or 2.

    >>> score_bounds(7)
    (21, 67)
    """
    exact_interval(successes, trials)
    return REAL_POINTS * successes, REAL_POINTS * successes + (REAL_POINTS - 1) * (trials - successes)


def score_distributions(successes: int, score: int, trials: int = REAL_TRIALS) -> pd.DataFrame:
    """Every way the trials can be shared among 0, 1, 2 and 3 points that gives the published totals.

    Returns:
        Columns zero, one, two, three (trials with so many points), sd (standard deviation of a trial's points) and
        weight (share of all orderings of the unsuccessful trials that are of this kind).

    Raises:
        BadInput: a total that the successes do not allow.
    """
    least, most = score_bounds(successes, trials)
    if not least <= score <= most:
        raise BadInput(f"score {score} with {successes} successes of {trials} trials: allowed are {least}..{most}")
    rest, points = trials - successes, score - REAL_POINTS * successes
    rows = []
    for two in range(max(0, points - rest), points // 2 + 1):
        kinds = (rest - points + two, points - 2 * two, two)
        squares = sum(count * (value - score / trials)**2 for value, count in enumerate((*kinds, successes)))
        rows.append({**dict(zip(("zero", "one", "two"), kinds, strict=True)), "three": successes,
                     "sd": (squares / (trials - 1))**0.5,
                     "weight": factorial(rest) // prod(factorial(kind) for kind in kinds)})
    table = pd.DataFrame(rows)
    return table.assign(weight=[float(ways / sum(table["weight"])) for ways in table["weight"]])

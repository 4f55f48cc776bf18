"""The rule for when motion is coverage and nothing besides; success against distance is in `distance`.

Committed before it was applied (`verdict`):

    error      predicted from the other cells alone, a cell's rate is off by less than `LARGEST_ERROR` on the mean, and
               by less than `LARGEST_SHARE` of what the mean rate of the other cells is off by
    residual   MOVE minus static at equal distance lies within `SAME` of 0
    one curve  a curve for each method says of runs left out less than `LARGEST_GAIN` more than one curve for both

Each number is a yes where its whole 95 % interval lies in the region, a no where all of it lies outside, and open
otherwise. Intervals include how trainings differ: they leave out one whole run in turn (jackknife), never single
episodes; over tasks they are Student's of the tasks' own numbers. Motion is coverage where all are a yes ("holds"); it
is not where one is a no ("falls"); else "undecided". It is decided for each of: figures 1, 3 and 5 at 7,000 timesteps
from pixels by where the hand starts (anywhere, which is the paper's and decides; within 3 cm; one place), the same from
keypoints with hands anywhere, and table 2 from pixels and from keypoints, of which the third number is not asked. The
first three seeds of the figures count and the first one of table 2, for to collect again what training saw takes
minutes; of the grids all places count but the grasp points themselves.

What was known when it was written: the rates, and a first look at 36 runs of figures 1, 3 and 5 with points for
estimates (two of the three starts of the hand): one curve with a radius of 6.3 cm (3.7 cm where all hands start alike)
predicted a cell from the other five within 4.0 points (6.7). The limit of eight points is that of the question on table
2; that of ten is the margin of the claims that two things are the same. Not known: hands anywhere and keypoints, table
2, MOVE minus static at equal distance, any interval.

Changed after the numbers had been seen, the rule untouched: over the five factors of table 2 the fit had ended 5 to 9
units of log-likelihood below the best curve, elsewhere on another machine (`fit` says why); now it searches often.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from move.statistics import intervals
from move.statistics.distance import Curve, HeldOut, Tries, fit, held_out, log_likelihood
from move.statistics.verdicts import INFINITE, Finding

LARGEST_ERROR = 0.08  # of a rate, mean over cells
LARGEST_SHARE = 0.5  # of the error without distances
SAME = 0.10  # of MOVE minus static at equal distance
LARGEST_GAIN = 0.02  # log-likelihood an episode: what a rate of one half that is off by ten points costs
ERROR, SHARE = "error", "error, share of that without distances"
EQUAL, GAIN = "MOVE minus static at equal distance", "gain of two curves"
HOLDS, FALLS, UNDECIDED = "holds", "falls", "undecided"

ENDLESS = 10.0  # of a share: the other predictions were off by next to nothing
BINS = 0.005  # metres, of equal distance
SHARES = 5  # of a task's configurations, sorted by distance, which count as equally far


def at_equal_distance(success: np.ndarray, move: np.ndarray, stratum: np.ndarray) -> float:
    """MOVE's rate minus static's within strata of equal distance, weighted as Mantel and Haenszel do.

    A stratum that has one of the methods alone tells nothing; NaN where all are such.

    >>> at_equal_distance(np.array([1, 0, 1, 1, 0]), np.array([1, 0, 1, 0, 1]), np.array([0, 0, 1, 1, 2]))
    0.5
    """
    _, place = np.unique(stratum, return_inverse=True)
    sums = [(np.bincount(place, side), np.bincount(place, side * success)) for side in (move == 1, move == 0)]
    (moving, won), (still, won_still) = sums
    weight = moving * still / np.maximum(moving + still, 1)
    if not weight.sum():
        return float("nan")
    apart = won / np.maximum(moving, 1) - won_still / np.maximum(still, 1)
    return float((weight * apart).sum() / weight.sum())


def strata(tries: Tries, curve: Curve) -> np.ndarray:
    """What counts as equal distance: half a centimetre in the plane, or a fifth of a task's configurations by D."""
    if tries.apart.ndim == 1:
        return np.floor(tries.apart / BINS).astype(int)
    found, scaled = np.empty(len(tries.success), int), curve.scaled(tries.apart)
    for number, group in enumerate(np.unique(tries.group)):
        mine = tries.group == group
        edges = np.quantile(scaled[mine], np.arange(1, SHARES) / SHARES)
        found[mine] = number * SHARES + np.searchsorted(edges, scaled[mine])
    return found


def gain_of_two(tries: Tries) -> np.ndarray:
    """For each run, left out of the fits: log-likelihood an episode of its method's curve minus that of one curve."""
    gains = []
    for run in np.unique(tries.run):
        mine = tries.run == run
        others, left = tries.where(~mine), tries.where(mine)
        one, own = fit(others), fit(others.where(others.move == left.move[0]))
        gains.append((log_likelihood(left.success, own.chance(left))
                      - log_likelihood(left.success, one.chance(left))).mean())
    return np.array(gains)


def findings_on_grids(tries: Tries) -> list[Finding]:
    """What the rule asks of figures 1, 3 and 5, each with its interval."""
    (error, share, residual), low, high = intervals.jackknife(tries.run, lambda mask: _on_grids(tries.where(mask)))
    return [_below(ERROR, error, low[0], high[0], LARGEST_ERROR),
            _below(SHARE, share, low[1], high[1], LARGEST_SHARE),
            Finding(EQUAL, residual, low[2], high[2], -SAME, SAME),
            _below(GAIN, *intervals.mean_interval(gain_of_two(tries)), LARGEST_GAIN)]


def _on_grids(tries: Tries) -> np.ndarray:
    found = held_out(tries)
    return np.array([found.error, found.share, at_equal_distance(tries.success, tries.move, strata(tries, fit(tries)))])


def findings_over_tasks(tries: Tries, found: HeldOut, curve: Curve) -> list[Finding]:
    """What the rule asks of table 2, each with an interval over tasks.

    Args:
        found: of these tries.
        curve: fitted to all of them.
    """
    tasks = np.unique(found.group)
    errors, without = (np.array([np.abs(each - found.rate)[found.group == task].mean() for task in tasks])
                       for each in (found.predicted, found.without))
    places = np.arange(len(tasks))
    share, low, high = map(float, intervals.jackknife(
        places, lambda mask: errors[mask].mean() / max(without[mask].mean(), 1e-9)))
    return [_below(ERROR, *intervals.mean_interval(errors), LARGEST_ERROR),
            _below(SHARE, share, low, high, LARGEST_SHARE),
            Finding(EQUAL, *lead_over_tasks(tries, strata(tries, curve)), -SAME, SAME)]


def lead(tries: Tries) -> tuple[float, float, float]:
    """MOVE minus static over all that was tried, and the ends of its 95 % interval: over runs, or over tasks."""
    same = np.zeros(len(tries.success), int)
    if tries.apart.ndim > 1:
        return lead_over_tasks(tries, same)
    value, low, high = intervals.jackknife(tries.run, lambda mask: at_equal_distance(
        tries.success[mask], tries.move[mask], same[mask]))
    return float(value), float(low), float(high)


def lead_over_tasks(tries: Tries, stratum: np.ndarray) -> tuple[float, float, float]:
    """`at_equal_distance` of each group, here a task: their mean and the ends of its 95 % interval."""
    columns = (tries.success, tries.move, stratum)
    leads = np.array([at_equal_distance(*(each[tries.group == task] for each in columns))
                      for task in np.unique(tries.group)])
    return intervals.mean_interval(leads[~np.isnan(leads)])


def _below(what: str, value: float, low: float, high: float, limit: float) -> Finding:
    """A finding whose limit is from above; errors are no less than 0, and a share of next to nothing has no end."""
    if what in (ERROR, SHARE):
        low, high = max(low, 0.0), INFINITE if high > ENDLESS else high
    return Finding(what, float(value), float(low), float(high), -INFINITE, limit)


def verdict(findings: Sequence[Finding]) -> str:
    """Whether motion is coverage, by the rule above.

    >>> small, open_ = Finding("error", 0.04, 0.02, 0.06, -INFINITE, 0.08), Finding("residual", 0.05, 0, 0.2, -0.1, 0.1)
    >>> verdict([small]), verdict([small, open_]), verdict([open_, Finding("error", 0.2, 0.1, 0.3, -INFINITE, 0.08)])
    ('holds', 'undecided', 'falls')
    """
    answers = [finding.answer for finding in findings]
    return FALLS if "no" in answers else HOLDS if answers and set(answers) == {"yes"} else UNDECIDED

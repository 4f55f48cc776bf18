"""Success against the distance to what training saw, and the rule for when motion is coverage and nothing besides.

A configuration that lies D away from the nearest timestep of the training data before a grasp is solved with the chance

    p = top / (1 + D^steepness),   D^2 = min over timesteps of the sum over factors of (distance / radius)^2,

a radius being the distance at which half of `top` is left. In figures 1, 3 and 5 the only factor is the object's place;
in table 2 object, yaw, target, camera and hand have a radius each, and `top` is a share of the expert's success on the
task. Fitted by maximum likelihood. Intervals include how trainings differ: they leave out one whole run in turn
(jackknife), never single episodes; over tasks they are Student's of the tasks' own numbers.

The rule (`verdict`), committed before it was applied:

    error      predicted from the other cells alone, a cell's rate is off by less than `LARGEST_ERROR` on the mean, and
               by less than `LARGEST_SHARE` of what the mean rate of the other cells is off by
    residual   MOVE minus static at equal distance lies within `SAME` of 0
    one curve  a curve for each method says of runs left out less than `LARGEST_GAIN` more than one curve for both

A cell is a method and a figure (1, 3, 5), or a method and a task (table 2, where the cells of a task are left out
together). Each number is a yes where its whole 95 % interval lies in the region, a no where all of it lies outside, and
open otherwise. Motion is coverage where all are a yes ("holds"); it is not where one is a no ("falls"); else
"undecided". It is decided for each of: figures 1, 3 and 5 at 7,000 timesteps from pixels by where the hand starts
(anywhere, which is the paper's and decides; within 3 cm; one place), the same from keypoints with hands anywhere, and
table 2 from pixels and from keypoints, of which the third number is not asked. The first three seeds of the figures
count and the first one of table 2, for to collect again what training saw takes minutes; of the grids all places count
but the grasp points themselves.

What was known when it was written: the rates, and a first look at 36 runs of figures 1, 3 and 5 with points for
estimates (two of the three starts of the hand): one curve with a radius of 6.3 cm (3.7 cm where all hands start alike)
predicted a cell from the other five within 4.0 points (6.7). The limit of eight points is that of the question on table
2; that of ten is the margin of the claims that two things are the same. Not known: hands anywhere and keypoints, table
2, MOVE minus static at equal distance, any interval.

Changed after the numbers had been seen, the rule untouched: over the five factors of table 2 the fit had ended 5 to 9
units of log-likelihood below the best curve, elsewhere on another machine (`fit` says why); now it searches often.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import expit, logit, stdtrit, xlogy

from move.statistics.intervals import CONFIDENCE, mean_interval
from move.statistics.verdicts import INFINITE, Finding

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

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
_NEAR = 1e-6  # of a radius: D of what was seen itself
STARTS, HOPS = 6, 40  # searches for several radii: from anywhere, then from near the best one
WIDE = (0.5, 50.0)  # times the typical distance, where searches start from
_LIMITS = {"top": (0.01, 0.999), "steepness": (0.5, 20.0), "radius": (1e-3, 1e3)}


@dataclass(frozen=True)
class Tries:
    """Tried configurations, one row each.

    Args:
        apart: (rows,) metres to the nearest place seen; or (rows, candidates, factors) to timesteps that may be the
            nearest, each factor in its own unit.
        success: (rows,) bool.
        run, cell, group: (rows,) labels: of the training; of the rate it belongs to; of what is left out together.
        move: (rows,) bool, whether MOVE collected the data; rows of neither static nor MOVE are NaN.
        ceiling: (rows,) the success of an expert, 1 where nobody asks.
    """

    apart: np.ndarray
    success: np.ndarray
    run: np.ndarray
    cell: np.ndarray
    group: np.ndarray
    move: np.ndarray
    ceiling: np.ndarray

    def where(self, mask: np.ndarray) -> Tries:
        """The rows of a mask."""
        return replace(self, **{name: values[mask] for name, values in vars(self).items()})


@dataclass(frozen=True)
class Curve:
    """Success against distance: its height at 0, for each factor the radius at which half is left, how steep it is."""

    top: float
    radii: tuple[float, ...]
    steepness: float

    def scaled(self, apart: np.ndarray) -> np.ndarray:
        """D of each row, (rows,), a distance of 1 being the radius."""
        return np.sqrt(_nearest(apart, np.array(self.radii))[0])

    def chance(self, tries: Tries) -> np.ndarray:
        """Chance of success of each row, (rows,).

        >>> one = np.ones(1)
        >>> Curve(0.8, (0.06,), 3.0).chance(Tries(0.06 * one, one, one, one, one, one, one))
        array([0.4])
        """
        return tries.ceiling * self.top / (1 + self.scaled(tries.apart) ** self.steepness)

    def left(self, apart: np.ndarray) -> np.ndarray:
        """Share of `top` that is left at distances to the nearest place seen, of any shape; of a curve of one factor.

        >>> Curve(0.8, (0.06,), 3.0).left(np.array([0.0, 0.06]))
        array([1. , 0.5])
        """
        (radius,) = self.radii
        return 1 / (1 + (apart / radius) ** self.steepness)


def fit(tries: Tries) -> Curve:
    """The curve of maximum likelihood.

    Of one factor a search finds it. Of several the likelihood has many tops, and which one a single search ends on
    depends on the last bits of a number; so there are many, the same ones everywhere.

    Raises:
        ValueError: no row.
    """
    from scipy.optimize import minimize  # slow to import

    if not len(tries.success):
        raise ValueError("fit: no row given; allowed is at least one")
    apart = tries.apart if tries.apart.ndim == 3 else tries.apart[:, None, None]
    least, most = _LIMITS["radius"]
    typical = np.clip(np.median(apart.min(axis=1), axis=0), least, most)
    high = np.clip(tries.success.mean() / tries.ceiling.mean() + 0.1, 0.1, 0.9)
    bounds = np.array([logit(_LIMITS["top"]), np.log(_LIMITS["steepness"]), *[np.log((least, most))] * len(typical)])

    def search(first: np.ndarray) -> OptimizeResult:
        return minimize(_loss, np.clip(first, *bounds.T), (apart, tries), jac=True, method="L-BFGS-B", bounds=bounds)

    def from_radii(times: float | np.ndarray) -> OptimizeResult:
        return search(np.array([logit(high), np.log(2.0), *np.log(np.clip(times * typical, least, most))]))

    best = from_radii(3)
    if len(typical) > 1:
        rng = np.random.default_rng(0)
        near, far = np.log(WIDE)
        others = [from_radii(np.exp(rng.uniform(near, far, len(typical)))) for _ in range(STARTS - 1)]
        best = min([best, *others], key=attrgetter("fun"))
        for _ in range(HOPS):
            best = min(best, search(best.x + rng.standard_normal(len(best.x))), key=attrgetter("fun"))
    top, steepness, *radii = best.x
    return Curve(float(expit(top)), tuple(map(float, np.exp(radii))), float(np.exp(steepness)))


def _nearest(apart: np.ndarray, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """D squared of each row, (rows,), and the part of it that is each factor's, (rows, factors)."""
    apart = apart if apart.ndim == 3 else apart[:, None, None]
    squares = apart**2 @ (1 / radii**2)
    place = squares.argmin(axis=1)
    parts = np.take_along_axis(apart, place[:, None, None], axis=1)[:, 0] ** 2 / radii**2
    squared = parts.sum(axis=1) + _NEAR**2
    return squared, parts / squared[:, None]


def _loss(x: np.ndarray, apart: np.ndarray, tries: Tries) -> tuple[float, np.ndarray]:
    """Minus the mean log-likelihood and its gradient; the nearest timestep stays the nearest for a small step."""
    top, steepness = expit(x[0]), np.exp(x[1])
    squared, shares = _nearest(apart, np.exp(x[2:]))
    slope = steepness * np.log(squared) / 2
    left = expit(-slope)
    chance = np.clip(tries.ceiling * top * left, 1e-9, 1 - 1e-9)
    towards = (tries.success - chance) / (1 - chance)  # of the logarithm of the chance
    gradient = [towards * (1 - top), -towards * (1 - left) * slope,
                *(towards * (1 - left) * steepness * share for share in shares.T)]
    return -float(_log_likelihood(tries.success, chance).mean()), -np.array([part.mean() for part in gradient])


def _log_likelihood(success: np.ndarray, chance: np.ndarray) -> np.ndarray:
    chance = np.clip(chance, 1e-9, 1 - 1e-9)
    return xlogy(success, chance) + xlogy(1 - success, 1 - chance)


def jackknife(labels: np.ndarray, statistic: Callable[[np.ndarray], np.ndarray | float]
              ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A statistic of all rows, and the ends of its 95 % interval from leaving out the rows of each label in turn.

    Args:
        labels: (rows,), such as the run that each row is of.
        statistic: takes a mask of rows, gives a number or an array.

    >>> value, low, high = jackknife(np.arange(5), lambda mask: np.arange(5)[mask].mean())
    >>> float(value), round(float(high - low) / 2, 3)  # as Student's interval of a mean
    (2.0, 1.963)
    """
    whole = np.asarray(statistic(np.ones(len(labels), bool)), float)
    without = np.array([statistic(labels != label) for label in np.unique(labels)])
    count = len(without)
    error = np.sqrt((count - 1) / count * ((without - without.mean(axis=0)) ** 2).sum(axis=0))
    half = stdtrit(count - 1, (1 + CONFIDENCE) / 2) * error
    return whole, whole - half, whole + half


@dataclass(frozen=True)
class HeldOut:
    """Rates of cells, each predicted from the cells of the other groups: arrays (cells,), in order of their names.

    `without` is what the mean rate of those other cells says, for which no distance is known.
    """

    cell: np.ndarray
    group: np.ndarray
    rate: np.ndarray
    predicted: np.ndarray
    without: np.ndarray

    @property
    def error(self) -> float:
        """Mean distance of the predicted rates from the measured ones."""
        return float(np.abs(self.predicted - self.rate).mean())

    @property
    def share(self) -> float:
        """The same over that of the predictions that know no distance."""
        return self.error / max(float(np.abs(self.without - self.rate).mean()), 1e-9)


def held_out(tries: Tries) -> HeldOut:
    """Each group of cells predicted by the curve of the others, or by the others' mean rate."""
    cells, first = np.unique(tries.cell, return_index=True)
    groups = tries.group[first]
    rate = np.array([tries.success[tries.cell == cell].mean() for cell in cells])
    predicted, without = np.empty(len(cells)), np.empty(len(cells))
    for group in np.unique(groups):
        curve = fit(tries.where(tries.group != group))
        for place in np.flatnonzero(groups == group):
            predicted[place] = curve.chance(tries.where(tries.cell == cells[place])).mean()
            without[place] = rate[groups != group].mean()
    return HeldOut(cells, groups, rate, predicted, without)


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
        gains.append((_log_likelihood(left.success, own.chance(left))
                      - _log_likelihood(left.success, one.chance(left))).mean())
    return np.array(gains)


def findings_on_grids(tries: Tries) -> list[Finding]:
    """What the rule asks of figures 1, 3 and 5, each with its interval."""
    (error, share, residual), low, high = jackknife(tries.run, lambda mask: _on_grids(tries.where(mask)))
    return [_below(ERROR, error, low[0], high[0], LARGEST_ERROR),
            _below(SHARE, share, low[1], high[1], LARGEST_SHARE),
            Finding(EQUAL, residual, low[2], high[2], -SAME, SAME),
            _below(GAIN, *mean_interval(gain_of_two(tries)), LARGEST_GAIN)]


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
    share, low, high = map(float, jackknife(
        places, lambda mask: errors[mask].mean() / max(without[mask].mean(), 1e-9)))
    return [_below(ERROR, *mean_interval(errors), LARGEST_ERROR),
            _below(SHARE, share, low, high, LARGEST_SHARE),
            Finding(EQUAL, *lead_over_tasks(tries, strata(tries, curve)), -SAME, SAME)]


def lead(tries: Tries) -> tuple[float, float, float]:
    """MOVE minus static over all that was tried, and the ends of its 95 % interval: over runs, or over tasks."""
    same = np.zeros(len(tries.success), int)
    if tries.apart.ndim > 1:
        return lead_over_tasks(tries, same)
    value, low, high = jackknife(tries.run, lambda mask: at_equal_distance(
        tries.success[mask], tries.move[mask], same[mask]))
    return float(value), float(low), float(high)


def lead_over_tasks(tries: Tries, stratum: np.ndarray) -> tuple[float, float, float]:
    """`at_equal_distance` of each group, here a task: their mean and the ends of its 95 % interval."""
    columns = (tries.success, tries.move, stratum)
    leads = np.array([at_equal_distance(*(each[tries.group == task] for each in columns))
                      for task in np.unique(tries.group)])
    return mean_interval(leads[~np.isnan(leads)])


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

"""Success against the distance to what training saw: a curve, and rates that it predicts of other cells.

A configuration that lies D away from the nearest timestep of the training data before a grasp is solved with the chance

    p = top / (1 + D^steepness),   D^2 = min over timesteps of the sum over factors of (distance / radius)^2,

a radius being the distance at which half of `top` is left. In figures 1, 3 and 5 the only factor is the object's place;
in table 2 object, yaw, target, camera and hand have a radius each, and `top` is a share of the expert's success on the
task. Fitted by maximum likelihood. A cell is a method and a figure (1, 3, 5), or a method and a task (table 2, where
the cells of a task are left out together).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import expit, logit, xlogy

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

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
    return -float(log_likelihood(tries.success, chance).mean()), -np.array([part.mean() for part in gradient])


def log_likelihood(success: np.ndarray, chance: np.ndarray) -> np.ndarray:
    """Of each row, (rows,), of which the chance is known."""
    chance = np.clip(chance, 1e-9, 1 - 1e-9)
    return xlogy(success, chance) + xlogy(1 - success, 1 - chance)


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

"""What an estimate may be off by, in parts: each a Student's t, their sum again one, with 95 % inside.

Each part of a variance that is known by so many degrees of freedom is a scaled Student's t; a sum of them is taken as
the Student's t of the same variance and the same fourth cumulant.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from move.statistics.intervals import CONFIDENCE

FEWEST_DEGREES = 5.0  # a Student's t of four or fewer has no fourth cumulant


class Spread(NamedTuple):
    """What an estimate may be off by: variance and fourth cumulant, arrays of one shape; sums of both are of sums."""

    variance: np.ndarray
    fourth: np.ndarray

    @staticmethod
    def of(scale: np.ndarray, degrees: float) -> Spread:
        """A Student's t with that squared scale; of fewer than five degrees, five with the same 95 % interval."""
        if not degrees:
            return Spread(np.zeros_like(scale), np.zeros_like(scale))
        if degrees < FEWEST_DEGREES:
            scale = scale * (stdtrit(degrees, 0.975) / stdtrit(FEWEST_DEGREES, 0.975)) ** 2
            degrees = FEWEST_DEGREES
        variance = scale * degrees / (degrees - 2)
        return Spread(variance, 6 / (degrees - 4) * variance**2)

    @staticmethod
    def total(parts: Iterable[Spread]) -> Spread:
        """Of a sum of independent parts."""
        return Spread(*(np.sum(each, axis=0) for each in zip(*parts, strict=True)))

    def times(self, factor: float | np.ndarray) -> Spread:
        """Of so many times the estimate."""
        return Spread(self.variance * factor**2, self.fourth * factor**4)

    def at_least(self, variance: float | np.ndarray) -> Spread:
        """The same with no less than that variance."""
        return Spread(np.maximum(self.variance, variance), self.fourth)

    @property
    def student(self) -> tuple[np.ndarray, np.ndarray]:
        """Scale and degrees of freedom of the Student's t with this variance and fourth cumulant."""
        degrees = 4 + 6 * self.variance**2 / np.maximum(self.fourth, 1e-300)
        return np.sqrt(self.variance * (degrees - 2) / degrees), np.minimum(degrees, 1e6)

    @property
    def half_width(self) -> np.ndarray:
        """Half the width of the 95 % interval."""
        scale, degrees = self.student
        return stdtrit(degrees, (1 + CONFIDENCE) / 2) * scale

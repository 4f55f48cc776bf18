"""Verdicts on claims: what a claim hangs on, as numbers with intervals, and one rule that turns them into a verdict.

Nobody types one:

    contradicted        the paper's own printed numbers say otherwise
    cannot be tested    nothing that runs here could decide it
    not computed yet    a number is missing; what it would cost is said
    supported           every finding is clear, and what came out may be as large as the paper says
    partly              every finding is clear but some effect is smaller than said; or at least half of them are clear
    not here            fewer are clear

A finding is clear where its whole 95 % interval lies on the claimed side, after Holm's adjustment within the claim.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from move.statistics.estimates import holm

LEVEL = 0.05
VERDICTS = ("supported", "partly", "not here", "contradicted by the paper's own table", "cannot be tested here",
            "not computed yet")


@dataclass(frozen=True)
class Finding:
    """One number that a claim hangs on, with its 95 % interval; the claim says that it lies above `above`.

    `below` makes an interval of it, for a claim that two things are the same. `paper` is the paper's value of the same
    number, NaN where it prints none; `p_value` is two-sided against `above`, NaN where there is no test. `told` says
    the value with its interval where digits would not, as for "more than".
    """

    what: str
    value: float
    low: float
    high: float
    above: float = 0.0
    below: float = float("inf")
    paper: float = float("nan")
    p_value: float = float("nan")
    runs: tuple[str, ...] = ()
    told: str = ""

    @property
    def inside(self) -> bool:
        """Whether the whole interval lies where the claim says; an endless one may, where nothing bounds it above."""
        return bool(self.above < self.low and (self.high < self.below or np.isinf(self.below)))

    @property
    def as_large(self) -> bool:
        """Whether what came out may be as large as the paper's value; true where the paper prints none."""
        return bool(np.isnan(self.paper) or self.high >= self.paper)

    def __str__(self) -> str:
        printed = "" if np.isnan(self.paper) else f" (paper {self.paper:.3g})"
        return f"{self.what}: {self.told or f'{self.value:.3g} [{self.low:.3g}, {self.high:.3g}]'}{printed}"


@dataclass(frozen=True)
class Missing:
    """A number that no stored run gives, and what it would cost."""

    what: str
    runs: int
    minutes: float

    def __str__(self) -> str:
        return f"{self.what}: {self.runs} runs, about {self.minutes:.0f} core-minutes"


@dataclass(frozen=True)
class Contradiction:
    """What the paper says and what follows from its own printed numbers."""

    said: float
    printed: tuple[float, ...]
    what: str
    tolerance: float = 0.05  # of the value that is said

    @property
    def stands(self) -> bool:
        """Whether none of the printed numbers gives what is said."""
        return all(abs(value - self.said) > self.tolerance * abs(self.said) for value in self.printed)

    def __str__(self) -> str:
        return f"{self.what}: said {self.said:g}, printed {', '.join(f'{value:.3g}' for value in self.printed)}"


@dataclass(frozen=True)
class Untestable:
    """Why nothing that runs here could decide it."""

    why: str

    def __str__(self) -> str:
        return self.why


Item = Finding | Missing | Contradiction | Untestable


def verdict(items: Sequence[Item]) -> str:
    """The verdict on a claim from what it hangs on.

    >>> verdict([Finding("MOVE minus static", 0.2, 0.1, 0.3, paper=0.25)])
    'supported'
    >>> verdict([Finding("MOVE minus static", 0.2, 0.1, 0.3, paper=0.5)])
    'partly'
    >>> verdict([Finding("MOVE minus static", 0.2, -0.1, 0.5)])
    'not here'
    """
    if any(isinstance(item, Contradiction) and item.stands for item in items):
        return "contradicted by the paper's own table"
    if any(isinstance(item, Untestable) for item in items):
        return "cannot be tested here"
    if any(isinstance(item, Missing) for item in items) or not items:
        return "not computed yet"
    findings = [item for item in items if isinstance(item, Finding)]
    clear = clear_ones(findings)
    if all(clear):
        return "supported" if all(finding.as_large for finding in findings) else "partly"
    return "partly" if 2 * sum(clear) >= len(findings) else "not here"


def clear_ones(findings: Sequence[Finding]) -> list[bool]:
    """Which findings are clear, those with a p value after Holm's adjustment among themselves."""
    tested = [place for place, finding in enumerate(findings) if not np.isnan(finding.p_value)]
    adjusted = dict(zip(tested, holm([findings[place].p_value for place in tested]), strict=True)) if tested else {}
    return [finding.inside and adjusted.get(place, 0.0) < LEVEL for place, finding in enumerate(findings)]

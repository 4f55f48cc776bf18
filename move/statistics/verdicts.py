"""Verdicts on claims: what decides a claim, as numbers with intervals, and one rule that makes a verdict of them.

Nobody types one. README, captions, notebooks and the ledger have the same words:

    reproduced                  every finding is a clear yes, and the paper's size is not excluded
    reproduced, smaller         the same, and the paper's size is excluded: ours is smaller (or larger)
    direction only              not every finding is clear, none is surely a no, and the mean (or trend) is a clear yes
    undecided                   the intervals hold both answers; what would decide it is printed
    at the ceiling              undecided where the baseline leaves less room than the paper's effect takes
    refuted here                a finding is a clear no, or their mean (or trend) is
    contradicted by the paper   the paper's own printed numbers say otherwise
    not testable                nothing that runs on a computer could decide it
    not built here              it could be tested, and nothing here does
    not computed yet            a run is missing; what it costs is printed

A finding is a number with its 95 % interval. It is a yes where the whole interval lies in the claimed region, a no
where the whole interval lies outside of it, and open otherwise: the interval is the only test. Where a claim says that
two things are alike up to a margin, it is also a no where the interval excludes that they are equal and the number
itself is beyond the margin. How the findings of a claim are joined is part of the claim:

    every   all have to be a yes, each at .05; refuted by one that is a no after Holm's adjustment, or by the mean of
            those that are claimed to be on one side of the same number; none other has a mean
    some    one has to be a yes after Holm's adjustment; refuted if all are a no
    mean    one number over all, so a single finding
    trend   as every, but the direction is that of a contrast over all, and so is what refutes in place of the mean

The paper's value has a noise of its own where its number of episodes is known (`Finding.paper_half_width`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy.special import ndtr, ndtri

from move.statistics.estimates import holm
from move.statistics.needed import Design, Seeds, Trials

LEVEL = 0.05
TWO_SIDED = float(ndtri(1 - LEVEL / 2))
NAN, INFINITE = float("nan"), float("inf")

REPRODUCED, SMALLER, LARGER = "reproduced", "reproduced, smaller", "reproduced, larger"
DIRECTION, UNDECIDED, CEILING, REFUTED = "direction only", "undecided", "at the ceiling", "refuted here"
CONTRADICTED, NOT_TESTABLE, NOT_BUILT = "contradicted by the paper", "not testable", "not built here"
NOT_COMPUTED = "not computed yet"
VERDICTS = (REPRODUCED, SMALLER, LARGER, DIRECTION, UNDECIDED, CEILING, REFUTED, CONTRADICTED, NOT_TESTABLE, NOT_BUILT,
            NOT_COMPUTED)
Answer = Literal["yes", "no", "open"]
Join = Literal["every", "some", "mean", "trend"]


@dataclass(frozen=True)
class Finding:
    """One number with its 95 % interval; the claim says that it lies between `above` and `below`.

    Args:
        equal: where a claim says that two things are the same, the value that they have then, else NaN.
        paper: the paper's value of the same number, NaN where it prints none.
        paper_half_width: half of that value's own 95 % interval, 0 where nothing is known of it.
        room: the largest value that was possible, as 1 minus the baseline's rate.
        p_value: two-sided against `above`, where the interval alone does not give one (of a factor).
        text: value and interval where digits would not do, as for "more than".
        trend: whether it is the contrast over the other findings of its claim.
        design: what it was measured with, for what would decide it.
    """

    what: str
    value: float
    low: float
    high: float
    above: float = 0.0
    below: float = INFINITE
    equal: float = NAN
    paper: float = NAN
    paper_half_width: float = 0.0
    room: float = INFINITE
    p_value: float = NAN
    runs: tuple[str, ...] = ()
    text: str = ""
    trend: bool = False
    design: Design | Seeds | Trials | None = field(default=None, compare=False)

    @property
    def answer(self) -> Answer:
        """Whether the number lies where the claim says, as far as its interval tells.

        >>> Finding("MOVE minus static", 0.2, 0.1, 0.3).answer, Finding("the same", 0.1, -0.1, 0.3).answer
        ('yes', 'open')
        >>> Finding("comparable", -0.18, -0.28, -0.09, above=-0.1, equal=0.0).answer
        'no'
        """
        if self.above < self.low and (self.high < self.below or np.isinf(self.below)):
            return "yes"
        outside = self.high <= self.above or self.low >= self.below
        unequal = not np.isnan(self.equal) and not self.low <= self.equal <= self.high
        return "no" if outside or (unequal and not self.above < self.value < self.below) else "open"

    @property
    def size(self) -> Literal["", "smaller", "larger"]:
        """Whether the paper's value is excluded, its own noise and ours taken together; "" where it is not.

        >>> Finding("MOVE minus static", 0.117, 0.089, 0.146, paper=0.169).size
        'smaller'
        >>> Finding("MOVE minus static", 0.117, 0.089, 0.146, paper=0.169, paper_half_width=0.05).size
        ''
        """
        if np.isnan(self.paper):
            return ""
        if np.isinf(self.value):  # a factor that is "more than"
            return "larger" if np.isfinite(self.low) and self.low > self.paper else ""
        ours = self.high - self.value if self.paper > self.value else self.value - self.low
        apart = np.sign(self.paper) * (self.paper - self.value)
        if abs(apart) <= np.hypot(ours, self.paper_half_width):
            return ""
        return "smaller" if apart > 0 else "larger"

    @property
    def no_room(self) -> bool:
        """Whether an effect of the paper's size was impossible.

        >>> Finding("MOVE minus static", 0.03, -0.04, 0.11, paper=0.228, room=0.094).no_room
        True
        """
        return bool(self.room < self.paper)

    @property
    def p_outside(self) -> float:
        """Two-sided p of the value against the claimed region, from its interval; 1 for a value inside."""
        edge = self.equal if not np.isnan(self.equal) else self.above if self.value <= self.above else self.below
        return 1.0 if self.above < self.value < self.below else _p_value(self.value, self.low, self.high, edge)

    @property
    def p_inside(self) -> float:
        """Two-sided p of the value against `above`; 1 for a value that is not above it."""
        if not np.isnan(self.p_value):
            return self.p_value
        return _p_value(self.value, self.low, self.high, self.above) if self.value > self.above else 1.0

    @property
    def needed(self) -> str:
        """What would decide an open finding; "" for one that is decided or of which nothing is known."""
        if self.answer != "open" or self.design is None:
            return ""
        edges = [abs(self.value - edge) for edge in (self.above, self.below) if np.isfinite(edge)]
        return f"{self.what}: {self.design.needed(min(edges))}"

    def __str__(self) -> str:
        noise = f" +- {self.paper_half_width:.2g}" if self.paper_half_width else ""
        room = ", more than there was room for" if self.no_room else ""
        printed = "" if np.isnan(self.paper) else f" (paper {self.paper:.3g}{noise}{room})"
        value, low, high = (f"{round(number, 12) + 0.0:.3g}" for number in (self.value, self.low, self.high))
        return f"{self.what}: {self.text or f'{value} [{low}, {high}]'}{printed}"


@dataclass(frozen=True)
class Missing:
    """A number that no stored run gives, and what it would cost."""

    what: str
    runs: int
    minutes: float

    def __str__(self) -> str:
        return f"{self.what}: {self.runs} run{'s' * (self.runs != 1)}, about {self.minutes:.0f} core-minutes"


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
class Untested:
    """Why nothing here decides it, and whether anything could."""

    why: str
    testable: bool = False

    def __str__(self) -> str:
        return self.why


Item = Finding | Missing | Contradiction | Untested


def verdict(items: Sequence[Item], join: Join = "every") -> str:
    """The verdict on a claim from what it is decided by.

    >>> clear, unclear = Finding("a", 0.2, 0.1, 0.3, paper=0.25), Finding("b", 0.1, -0.1, 0.3, paper=0.25)
    >>> verdict([clear]), verdict([clear, unclear]), verdict([unclear])
    ('reproduced', 'direction only', 'undecided')
    >>> verdict([Finding("smaller", 0.2, 0.1, 0.3, paper=0.5)]), verdict([Finding("larger", 0.2, 0.1, 0.3, paper=0.05)])
    ('reproduced, smaller', 'reproduced, larger')
    >>> verdict([Finding("no room", 0.0, -0.1, 0.1, paper=0.2, room=0.05)])
    'at the ceiling'
    >>> verdict([clear, Finding("the other way", -0.2, -0.3, -0.1)])
    'refuted here'
    >>> verdict([clear, Finding("the other way", -0.2, -0.3, -0.1)], "some")
    'reproduced'
    >>> verdict([Contradiction(4.0, (5.65, 1.34), "ratio")])
    'contradicted by the paper'
    >>> verdict([Untested("no robot")]), verdict([Untested("a table of another height", testable=True)])
    ('not testable', 'not built here')
    >>> verdict([clear, Missing("a run", 1, 10.0)])
    'not computed yet'
    """
    if any(isinstance(item, Contradiction) and item.stands for item in items):
        return CONTRADICTED
    if untested := [item for item in items if isinstance(item, Untested)]:
        return NOT_BUILT if any(item.testable for item in untested) else NOT_TESTABLE
    if any(isinstance(item, Missing) for item in items) or not items:
        return NOT_COMPUTED
    findings = [item for item in items if isinstance(item, Finding) and not item.trend]
    contrasts = [item for item in items if isinstance(item, Finding) and item.trend]
    if join == "some":
        return _some(findings)
    if all(finding.answer == "yes" for finding in findings):
        return _sized(findings)
    directions = contrasts if join == "trend" else [mean_finding(findings)] if _have_a_mean(findings) else []
    if _surely_no(findings) or _surely_no(directions):
        return REFUTED
    if all(finding.no_room for finding in findings if finding.answer != "yes"):
        return CEILING
    return DIRECTION if directions and all(one.answer == "yes" for one in directions) else UNDECIDED


def _have_a_mean(findings: Sequence[Finding]) -> bool:
    """Whether several are claimed to be on one side of the same number: a mean hides nothing, and none cancels another.

    >>> above, more, alike = Finding("", 0.1, -0.1, 0.3), Finding("", 0.7, 0.4, 0.9, above=0.5), (-0.1, 0.1, 0.0)
    >>> same = Finding("", 0.1, -0.1, 0.3, *alike)
    >>> _have_a_mean([above, above]), _have_a_mean([above]), _have_a_mean([above, more]), _have_a_mean([same, same])
    (True, False, False, False)
    """
    return len(findings) > 1 and len({one.above for one in findings}) == 1 and all(
        np.isinf(one.below) for one in findings)


def mean_finding(findings: Sequence[Finding]) -> Finding:
    """The mean of how far findings are above what is claimed, of independent ones about fixed things such as ten tasks.

    >>> print(mean_finding([Finding("a", 0.2, 0.1, 0.3), Finding("b", 0.7, 0.5, 0.8, above=0.5)]))
    mean: 0.2 [0.0882, 0.271]
    """
    value, low, high = (np.array([getattr(finding, name) - finding.above for finding in findings])
                        for name in ("value", "low", "high"))
    less, more = (float(np.sqrt(np.square(part).sum())) / len(findings) for part in (value - low, high - value))
    mean = float(value.mean())
    return Finding("mean", mean, mean - less, mean + more)


def counted(answers: Sequence[Answer]) -> str:
    """How many findings are a yes, open and a no, in words.

    >>> counted(["yes", "open"])
    'yes 1, open 1, no 0 of 2'
    """
    return ", ".join(f"{name} {answers.count(name)}" for name in ("yes", "open", "no")) + f" of {len(answers)}"


def _some(findings: Sequence[Finding]) -> str:
    adjusted = holm([finding.p_inside for finding in findings])
    clear = [finding for finding, p in zip(findings, adjusted, strict=True) if finding.answer == "yes" and p < LEVEL]
    if clear:
        return _sized(clear)
    if all(finding.answer == "no" for finding in findings):
        return REFUTED
    return CEILING if all(finding.no_room for finding in findings if finding.answer != "no") else UNDECIDED


def _surely_no(findings: Sequence[Finding]) -> bool:
    adjusted = holm([finding.p_outside for finding in findings])
    return any(finding.answer == "no" and (len(findings) == 1 or p < LEVEL)
               for finding, p in zip(findings, adjusted, strict=True))


def _sized(findings: Sequence[Finding]) -> str:
    sizes = {finding.size for finding in findings}
    if "smaller" in sizes and "larger" not in sizes:
        return SMALLER
    return LARGER if "larger" in sizes and "smaller" not in sizes else REPRODUCED


def _p_value(value: float, low: float, high: float, against: float) -> float:
    half = value - low if value > against else high - value
    if not np.isfinite(half) or half <= 0:
        return 0.0 if half == 0 else 1.0
    return float(2 * ndtr(-TWO_SIDED * abs(value - against) / half))

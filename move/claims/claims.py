"""The claims as data: `claims.yaml`, checked, and its fingerprint."""

from __future__ import annotations

import hashlib
import re
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from move import yaml_text
from move.errors import BadInput
from move.sim.tasks import TASKS
from move.statistics.verdicts import INFINITE, TWO_SIDED, Join
from move.validation import first_problem

FILE = Path(__file__).with_name("claims.yaml")
Where = dict[str, Any]
"""Columns of the episodes and what they have to be: a value, one of a list, or {above: number}, {at_most: number}."""


class Strict(BaseModel):
    """A part of a claim; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Paper(Strict):
    """The paper's printed value of a quantity: its two rates, or its value; one for each repetition, or one for all."""

    one: list[float] = Field(default=[], description="printed rates of `one`, a share of 1")
    other: list[float] = Field(default=[], description="printed rates of `other`, a share of 1")
    value: list[float] = Field(default=[], description="printed values of what is no difference")
    episodes: int = Field(default=0, ge=0, description="episodes of each rate, all seeds together; 0: not known")

    def of_one(self, place: int) -> dict[str, Any]:
        """`paper` and `paper_half_width` of a finding, one of several: the latter of its 95 % interval, of episodes."""
        if self.value:
            return {"paper": self.value[min(place, len(self.value) - 1)]}
        if not self.one:
            return {}
        one, other = (rates[min(place, len(rates) - 1)] if rates else 0.0 for rates in (self.one, self.other))
        return {"paper": one - other, "paper_half_width": self.half_width([one], [other])}

    def of_mean(self, gain: bool) -> dict[str, Any]:
        """The same of a mean over things, a difference or one side over the other, minus 1."""
        if not self.one:
            return {}
        first, second = float(np.mean(self.one)), float(np.mean(self.other))
        if not gain:
            return {"paper": first - second, "paper_half_width": self.half_width(self.one, self.other)}
        relative = self._variance(self.one) / first**2 + self._variance(self.other) / second**2
        return {"paper": first / second - 1, "paper_half_width": TWO_SIDED * first / second * float(np.sqrt(relative))}

    def half_width(self, one: list[float], other: list[float]) -> float:
        """Half the 95 % interval of a difference of means of printed rates; 0 where their episodes are not known."""
        return TWO_SIDED * float(np.sqrt(self._variance(one) + self._variance(other)))

    def _variance(self, rates: list[float]) -> float:
        """Of the mean of printed rates."""
        if not self.episodes:
            return 0.0
        return sum(rate * (1 - rate) / self.episodes for rate in rates) / max(len(rates), 1) ** 2


class Quantity(Strict):
    """A number, or one for each of several things, and where the claim says that it lies."""

    quantity: str = Field(description="one of `QUANTITIES` in move/claims/quantities.py")
    what: str = Field(default="", description="its name in the ledger; {column} is filled in")
    experiment: str = Field(default="", description="whose runs; the claim's figure where left out")
    where: Where = Field(default={}, description="of both sides")
    selection: str = Field(default="", description="a name under `selections`, whose columns are added to `where`")
    one: Where = Field(default={}, description="of the first side, or of the only one")
    other: Where = Field(default={}, description="of the second side")
    each: dict[str, list[Any]] = Field(default={}, description="columns whose values make a number each, in step")
    direction: Literal["above", "same", "no worse"] = Field(
        default="above", description="above `margin`; within `margin` of 0; no more than `margin` below 0")
    margin: float = 0.0
    paper: Paper = Paper()
    options: dict[str, Any] = Field(default={}, description="what else the function takes")

    @property
    def repetitions(self) -> list[Where]:
        """What is added to `where` for each number, such as its task; a single empty one where there is one number."""
        columns = list(self.each)
        return [dict(zip(columns, values, strict=True)) for values in zip(*self.each.values(), strict=True)] or [{}]

    @property
    def region(self) -> dict[str, Any]:
        """Where the claim says that it lies: `above`, `below` and `equal` of a finding."""
        if self.direction == "above":
            return {"above": self.margin}
        return {"above": -self.margin, "equal": 0.0, "below": self.margin if self.direction == "same" else INFINITE}

    def named(self, where: Where) -> str:
        """The name of one number: `what`, with a task's title and other columns filled in."""
        words = {name: TASKS[value].title if name == "task" else f"{value:,}" if isinstance(value, int) else value
                 for name, value in where.items()}
        return self.what.format(**words)


class Claim(Strict):
    """A sentence of the paper that can be checked, where it is, which figure shows it, and what decides it."""

    number: int
    quote: Annotated[str, Field(max_length=100)]
    short: Annotated[str, Field(max_length=48)] = Field(
        default="", description="as plots name it; the quote where that is no longer than this may be")
    place: str
    figure: str = Field(description="the notebook that shows it")
    join: Join = Field(default="every", description="how the findings decide together, see move/statistics/verdicts.py")
    findings: list[Quantity] = Field(min_length=1)
    changed: str = Field(default="", description="what was changed of the claim's rule after its numbers had been seen")


class File(Strict):
    """The whole file."""

    selections: dict[str, Where]
    lists: dict[str, list[Any]] = {}
    claims: list[Claim]


@cache
def claims() -> tuple[Claim, ...]:
    """All claims, in the order of their numbers.

    Raises:
        BadInput: what the file holds is no list of claims.
    """
    return read(FILE.read_text(encoding="utf-8"))


def read(text: str) -> tuple[Claim, ...]:
    """The claims of a YAML text as `claims.yaml` is.

    Raises:
        BadInput: it is no list of claims numbered from 1, or names a list or a selection that is not there.
    """
    content = yaml_text.read(text, FILE.name)
    lists = content.get("lists") if isinstance(content, dict) else None
    try:
        found = File.model_validate(_filled(content, lists if isinstance(lists, dict) else {}))
    except ValidationError as error:
        problem = re.sub(r"^claims\.(\d+)\.?", lambda place: f"claim {int(place[1]) + 1}, ", first_problem(error))
        raise BadInput(f"{FILE.name}: {problem}") from error
    if [claim.number for claim in found.claims] != list(range(1, len(found.claims) + 1)):
        raise BadInput(f"{FILE.name}: other numbers than 1, 2, 3 ... given; allowed are those, in order")
    return tuple(claim.model_copy(update={"findings": [_selected(each, found.selections) for each in claim.findings]})
                 for claim in found.claims)


def _filled(content: Any, lists: dict[str, Any]) -> Any:
    """`content` with each text "$name" replaced by the list of that name."""
    if isinstance(content, dict):
        return {key: _filled(value, lists) for key, value in content.items()}
    if isinstance(content, list):
        return [_filled(value, lists) for value in content]
    if not isinstance(content, str) or not content.startswith("$"):
        return content
    if content[1:] not in lists:
        raise BadInput(f"{FILE.name}: {content!r} given; allowed are {', '.join(f'${name}' for name in lists)}")
    return lists[content[1:]]


def _selected(quantity: Quantity, selections: dict[str, Where]) -> Quantity:
    if quantity.selection and quantity.selection not in selections:
        raise BadInput(f"{FILE.name}: selection {quantity.selection!r} given; allowed are {', '.join(selections)}")
    return quantity.model_copy(update={"where": {**selections.get(quantity.selection, {}), **quantity.where}})


def fingerprint() -> str:
    """The sha256 of the file, which the ledger holds."""
    return hashlib.sha256(FILE.read_bytes()).hexdigest()

"""The claims by number: a claim is a function of the evidence that returns what it hangs on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from move.claims.evidence import Evidence
from move.claims.rule import Item


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper that can be checked, where it stands, which figure shows it, and what decides it."""

    number: int
    quote: str
    place: str
    figure: str
    decided_by: Callable[[Evidence], Sequence[Item]] = field(repr=False)


CLAIMS: dict[int, Claim] = {}


def claim(quote: str, place: str, figure: str) -> Callable:
    """Register what decides a claim; claims are numbered in the order in which they are written."""

    def register(decided_by: Callable[[Evidence], Sequence[Item]]) -> Callable[[Evidence], Sequence[Item]]:
        number = len(CLAIMS) + 1
        CLAIMS[number] = Claim(number, quote, place, figure, decided_by)
        return decided_by

    return register

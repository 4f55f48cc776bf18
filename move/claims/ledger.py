"""The ledger: every claim with its verdict, its numbers, its figure and its runs, as a table and for other programs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pandas as pd
from pydantic import BeforeValidator, Field

from move.claims.claims import Claim, Strict, claims, fingerprint
from move.claims.evidence import Evidence
from move.claims.quantities import findings
from move.files import written_aside
from move.statistics.verdicts import NAN, UNDECIDED, VERDICTS, Finding, Item, Join, counted, mean_finding, verdict

COLUMNS = ["number", "claim", "place", "verdict", "evidence", "needed", "figure", "runs", "hashes"]
MANY = 3  # from so many findings on their answers are counted, and their mean is drawn


Finite = Annotated[float | None, BeforeValidator(
    lambda value: None if value is None or not np.isfinite(value) else round(float(value), 6) + 0.0)]


class Number(Strict):
    """One number that a claim is decided by; null where there is none or no end."""

    what: str
    value: Finite = Field(description="what came out here")
    low: Finite = Field(description="lower end of its 95 % interval")
    high: Finite = Field(description="upper end of its 95 % interval")
    above: Finite = Field(description="the claim says that the number lies above this")
    below: Finite = Field(description="and below this")
    equal: Finite = Field(description="the value that two things have if they are the same")
    paper: Finite = Field(description="the paper's value of the same number")
    paper_half_width: float = Field(description="half of its own 95 % interval, 0 where nothing is known of it")
    room: Finite = Field(description="the largest value that was possible")
    answer: Literal["yes", "no", "open"] = Field(description="whether it lies where the claim says")
    size: Literal["", "smaller", "larger"] = Field(description="whether the paper's value is excluded, and how ours is")
    trend: bool = Field(description="whether it is a contrast over the other numbers")


class Entry(Strict):
    """One claim of the paper."""

    number: int
    claim: str = Field(description="the paper's words, shortened")
    short: str = Field(description="the claim as plots name it")
    place: str = Field(description="where they are in the paper")
    figure: str = Field(description="the notebook that shows the numbers")
    join: Join = Field(description="how the numbers decide together, see move/statistics/verdicts.py")
    verdict: str = Field(description="made by the rule of move/statistics/verdicts.py",
                         json_schema_extra={"enum": list(VERDICTS)})
    numbers: list[Number]
    notes: list[str] = Field(description="what there is in place of a number: missing runs, or why nothing decides it")
    needed: list[str] = Field(description="what would decide an undecided claim")
    changed: str = Field(description="what was changed of the claim's rule after its numbers had been seen")
    runs: list[str] = Field(description="hashes of the stored runs, files of results/laptop/")


class Ledger(Strict):
    """All claims, what decided them, and the fingerprint of the file that says how."""

    claims_sha256: str = Field(description="of move/claims/claims.yaml")
    claims: list[Entry]


def entries(evidence: Evidence) -> list[Entry]:
    """Every claim, decided."""
    return [_entry(claim, findings(claim, evidence)) for claim in claims()]


def as_table(decided: Sequence[Entry]) -> pd.DataFrame:
    """One row a claim with its verdict, its numbers, its figure, how many runs and which."""
    return pd.DataFrame([{
        "number": one.number, "claim": one.claim, "place": one.place, "verdict": one.verdict,
        "evidence": "; ".join([*_count(one), *(number.what for number in one.numbers), *one.notes]),
        "needed": "; ".join(one.needed), "figure": one.figure, "runs": len(one.runs), "hashes": " ".join(one.runs)}
        for one in decided], columns=COLUMNS)


def numbers(decided: Sequence[Entry]) -> pd.DataFrame:
    """The claims that are numbers, for a plot: one row a number, the rows of a claim together.

    Columns number, claim, figure, verdict, value (NaN for "more than"), low, high (NaN where it has no end), paper,
    above and below (what is claimed); factor (static's timesteps over MOVE's) and whole (of several: their mean, or the
    contrast over them).
    """
    rows = []
    for one in decided:
        found = [each for each in one.numbers if each.low is not None]
        several = [each for each in found if not each.trend]
        factor = one.figure == "fig4_scaling" and all(each.above == 1 for each in found)
        named = {"number": one.number, "claim": one.short, "figure": one.figure, "verdict": one.verdict,
                 "factor": factor}
        rows += [{**named, **_point(each), "whole": each.high is not None and (len(found) < MANY or each.trend)}
                 for each in found]
        if one.join == "every" and len(several) >= MANY and not factor:
            rows.append({**named, **_mean(several), "whole": True})
    return pd.DataFrame(rows, columns=["number", "claim", "figure", "verdict", "factor", "value", "low", "high",
                                       "paper", "above", "below", "whole"])


def _point(number: Number) -> dict[str, float]:
    return {name: NAN if (value := getattr(number, name)) is None else value
            for name in ("value", "low", "high", "paper", "above", "below")}


def _mean(several: Sequence[Number]) -> dict[str, float]:
    parts = [_point(each) for each in several]
    mean = mean_finding([Finding("", part["value"], part["low"], part["high"]) for part in parts])
    return {**parts[0], "value": mean.value, "low": mean.low, "high": mean.high,
            "paper": float(np.mean([part["paper"] for part in parts]))}


def save_json(decided: Sequence[Entry], folder: Path) -> None:
    """Write claims.json, and claims.schema.json that describes it, for other programs."""
    ledger = Ledger(claims_sha256=fingerprint(), claims=list(decided))
    for name, text in (("claims", ledger.model_dump_json(indent=1)),
                       ("claims.schema", json.dumps(Ledger.model_json_schema(), indent=1))):
        with written_aside(folder / f"{name}.json") as new:
            new.write_text(text + "\n", encoding="utf-8")


def _entry(claim: Claim, items: Sequence[Item]) -> Entry:
    numbers = [item for item in items if isinstance(item, Finding)]
    found = verdict(items, claim.join)
    return Entry(
        number=claim.number, claim=claim.quote, short=claim.short or claim.quote, place=claim.place,
        figure=claim.figure, join=claim.join, verdict=found,
        numbers=[Number.model_validate(replace(item, what=str(item)), from_attributes=True) for item in numbers],
        notes=[str(item) for item in items if not isinstance(item, Finding)],
        needed=[item.needed for item in numbers if item.needed] if found == UNDECIDED else [],
        changed=" ".join(claim.changed.split()),
        runs=sorted({run for item in numbers for run in item.runs}))


def _count(entry: Entry) -> list[str]:
    answers = [number for number in entry.numbers if not number.trend]
    return [counted([number.answer for number in answers])] if len(answers) >= MANY else []

"""A laboratory's own scoring sheet: read, checked line by line, and turned into the paper's two numbers.

The sheet is a CSV file with one line a trial:

    trial,method,position_x_m,position_y_m,score
    1,static,0.31,-0.12,2

`score` counts the steps done: 1 approach, 2 and picked up, 3 and put on the tray. The same trial number means
the same position for every method.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pandas as pd
from pydantic import BaseModel, BeforeValidator, Field
from scipy import stats

from move.errors import BadInput
from move.paper import PAPER_METHODS, REAL_POINTS
from move.statistics.intervals import exact_interval
from move.statistics.paired import mcnemar
from move.untrusted import read_text, reading
from move.validation import validated

FARTHEST_M = 1.5  # beyond the arm's reach in any case; catches centimetres
SAME_PLACE_M = 0.02

Place = Annotated[float, Field(ge=-FARTHEST_M, le=FARTHEST_M, allow_inf_nan=False)]


class Trial(BaseModel):
    """One line of a sheet; its fields are the columns, in their order."""

    trial: Annotated[int, Field(ge=1, le=100_000)]
    method: Annotated[Literal["static", "adc", "move"], BeforeValidator(lambda name: name.strip().lower())]
    position_x_m: Place
    position_y_m: Place
    score: Annotated[int, Field(ge=0, le=REAL_POINTS)]


COLUMNS = list(Trial.model_fields)


def read_sheet(path: Path | str) -> pd.DataFrame:
    """Read and check a scoring sheet.

    Returns:
        Columns trial (int), method, position_x_m, position_y_m (float, m), score (int 0..3), in the order of the file.

    Raises:
        BadInput: one line that names the file, the line and what is allowed there.
    """
    with reading(path, "a CSV scoring sheet"):
        text = read_text(Path(path)).removeprefix("\ufeff")
        lines = list(csv.reader(text.splitlines(), skipinitialspace=True, strict=True))
    header, trials = lines[0] if lines else [], [(n, line) for n, line in enumerate(lines[1:], 2) if line]
    if header != COLUMNS:
        raise BadInput(f"{path}: columns {header[:12]}; expected {COLUMNS}")
    if not trials:
        raise BadInput(f"{path}: no trials below the header")
    rows, seen = [], dict[int, list[Trial]]()
    for number, line in trials:
        where = f"{path}, line {number}"
        if len(line) != len(COLUMNS):
            raise BadInput(f"{where}: {len(line)} values; allowed: {len(COLUMNS)}, as the header has")
        if odd := next((value for value in line if "_" in value), ""):  # Python reads 1_0 as 10
            raise BadInput(f"{where}: {odd[:40]!r} given; allowed: numbers in digits alone, and a method")
        row = validated(Trial, dict(zip(COLUMNS, line, strict=True)), where)
        _refuse_repeat(row, seen.setdefault(row.trial, []), where)
        seen[row.trial].append(row)
        rows.append(row.model_dump())
    return pd.DataFrame(rows)


def _refuse_repeat(row: Trial, earlier: Sequence[Trial], where: str) -> None:
    """Refuse a trial scored twice, and one at another position than its `earlier` lines say."""
    for other in earlier:
        if other.method == row.method:
            raise BadInput(f"{where}: trial {row.trial} of {row.method} is scored twice; allowed: once a method")
        away = np.hypot(row.position_x_m - other.position_x_m, row.position_y_m - other.position_y_m)
        if away > SAME_PLACE_M:
            raise BadInput(f"{where}: trial {row.trial} stands {100 * away:.0f} cm from where it stood before; "
                           f"allowed: one position a trial, to {100 * SAME_PLACE_M:.0f} cm")


def score_table(sheet: pd.DataFrame) -> pd.DataFrame:
    """The paper's numbers from a sheet: one row a method.

    Returns:
        method, trials, successes (3 points), rate with exact interval low, high; score, normalised; and the share
        of trials that got at least 1 and 2 points (`approached`, `picked_up`).
    """
    rows = []
    for method in [method for method in PAPER_METHODS if method in set(sheet["method"])]:
        score = sheet.loc[sheet["method"] == method, "score"].to_numpy()
        successes = int((score == REAL_POINTS).sum())
        low, high = exact_interval(successes, len(score))
        rows.append({
            "method": method, "trials": len(score), "successes": successes, "rate": successes / len(score), "low": low,
            "high": high, "score": int(score.sum()), "normalised": score.mean() / REAL_POINTS,
            "approached": (score >= 1).mean(), "picked_up": (score >= 2).mean(),
        })
    return pd.DataFrame(rows)


def paired_test(sheet: pd.DataFrame, first: str, second: str, *, rng: np.random.Generator) -> dict[str, float]:
    """Compare two methods at the positions both were tried at; sharper than comparing their totals.

    Args:
        rng: draws sign patterns where there are too many to try each.

    Returns:
        pairs; only_first and only_second (positions where just one succeeded); mcnemar (exact two-sided p of the
        successes); score_gain (mean points, second - first); and permutation (p of that gain over every sign pattern,
        or over 9999 of them).

    Raises:
        BadInput: fewer than one common position.
    """
    wide = sheet.pivot(index="trial", columns="method", values="score")
    missing = [method for method in (first, second) if method not in wide]
    if missing or (pairs := wide[[first, second]].dropna()).empty:
        raise BadInput(f"methods {first!r} and {second!r} share no trial; the sheet has {sorted(wide.columns)}")
    a, b = pairs[first].to_numpy(), pairs[second].to_numpy()
    only_a = int(((a == REAL_POINTS) & (b < REAL_POINTS)).sum())
    only_b = int(((b == REAL_POINTS) & (a < REAL_POINTS)).sum())
    gain = stats.permutation_test((b - a,), np.mean, permutation_type="samples", n_resamples=9999, rng=rng)
    return {
        "pairs": len(pairs), "only_first": only_a, "only_second": only_b,
        "mcnemar": mcnemar(only_a, only_b),
        "score_gain": float((b - a).mean()), "permutation": float(gain.pvalue),
    }

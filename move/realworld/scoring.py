"""A laboratory's own scoring sheet: read, checked line by line, and turned into the paper's two numbers.

The sheet is a CSV file with one line a trial:

    trial,method,position_x_m,position_y_m,score
    1,static,0.31,-0.12,2

`score` counts the steps done: 1 approach, 2 and picked up, 3 and put on the tray. The same trial number means
the same position for every method.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from move.errors import BadInput
from move.paper import PAPER_METHODS, REAL_POINTS
from move.statistics.intervals import exact_interval
from move.untrusted import read_text, reading

COLUMNS = ("trial", "method", "position_x_m", "position_y_m", "score")
FARTHEST_M = 1.5  # beyond the arm's reach in any case; catches centimetres


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
    header, trials = tuple(lines[0]) if lines else (), [(n, line) for n, line in enumerate(lines[1:], 2) if line]
    if header != COLUMNS:
        raise BadInput(f"{path}: columns {list(header)[:12]}; expected {list(COLUMNS)}")
    if not trials:
        raise BadInput(f"{path}: no trials below the header")
    rows = {line: _row(path, line, values) for line, values in trials}
    _refuse_repeats(path, rows)
    return pd.DataFrame(list(rows.values()), columns=COLUMNS)


def _row(path: Path | str, line: int, values: Sequence[str]) -> tuple[int, str, float, float, int]:
    if len(values) != len(COLUMNS):
        raise BadInput(f"{path}, line {line}: {len(values)} values; allowed: {len(COLUMNS)}, as the header has")
    trial, method, x, y, score = (value.strip() for value in values)
    if (method := method.lower()) not in PAPER_METHODS:
        raise BadInput(f"{path}, line {line}: method {method!r}; allowed: {', '.join(PAPER_METHODS)}")
    return (_whole(path, line, "trial", trial, 1, 100_000), method, _metres(path, line, "position_x_m", x),
            _metres(path, line, "position_y_m", y), _whole(path, line, "score", score, 0, REAL_POINTS))


def _whole(path: Path | str, line: int, column: str, text: str, low: int, high: int) -> int:
    if not text.isascii() or not text.isdigit() or not low <= int(text) <= high:
        raise BadInput(f"{path}, line {line}: {column} {text!r}; allowed: a whole number {low}..{high}")
    return int(text)


def _metres(path: Path | str, line: int, column: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) <= FARTHEST_M:
        raise BadInput(f"{path}, line {line}: {column} {text!r}; allowed: metres within -{FARTHEST_M}..{FARTHEST_M}")
    return value


def _refuse_repeats(path: Path | str, rows: Mapping[int, tuple]) -> None:
    """Refuse a trial scored twice, and a trial number that stands for two positions."""
    seen: set[tuple[str, int]] = set()
    place: dict[int, tuple[float, float]] = {}
    for line, (trial, method, x, y, _) in rows.items():
        if (method, trial) in seen:
            raise BadInput(f"{path}, line {line}: trial {trial} of {method} is scored twice; allowed: once a method")
        if np.hypot(*np.subtract(place.setdefault(trial, (x, y)), (x, y))) > 0.02:
            raise BadInput(f"{path}, line {line}: trial {trial} stands at ({x}, {y}) m, earlier at {place[trial]}; "
                           "allowed: one position a trial, to 2 cm")
        seen.add((method, trial))


def score_table(sheet: pd.DataFrame, *, level: float = 0.95) -> pd.DataFrame:
    """The paper's numbers from a sheet: one row a method.

    Returns:
        method, trials, successes (3 points), rate with exact interval low, high; score, normalised; and the share
        of trials that got at least 1 and 2 points (`approached`, `picked_up`).
    """
    rows = []
    for method in [method for method in PAPER_METHODS if method in set(sheet["method"])]:
        score = sheet.loc[sheet["method"] == method, "score"].to_numpy()
        successes = int((score == REAL_POINTS).sum())
        low, high = exact_interval(successes, len(score), level=level)
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
        "mcnemar": float(stats.binomtest(only_a, only_a + only_b).pvalue) if only_a + only_b else 1.0,
        "score_gain": float((b - a).mean()), "permutation": float(gain.pvalue),
    }

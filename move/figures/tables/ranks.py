"""How well scores of a data set put cells in the order of their success rates."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from move.statistics.intervals import jackknife

RANKS = ["score", "correlation", "low", "high", "cells"]


def ranks(cells: pd.DataFrame, scores: Mapping[str, str], left_out: np.ndarray) -> list[dict[str, Any]]:
    """One row a score: Spearman's correlation with the cells' rates, and its 95 % interval.

    No interval where it is the same whatever is left out, as in a perfect order: that says nothing of chance.

    Args:
        cells: with the rates in `value`.
        scores: what a score is called -> its column in `cells`.
        left_out: (cells,) labels, of which each is left out in turn for the interval.
    """
    rows = []
    for name, column in scores.items():
        value, low, high = map(float, jackknife(left_out, partial(_correlation, cells, column)))
        low, high = (max(low, -1.0), min(high, 1.0)) if low < high else (np.nan, np.nan)
        rows.append({"score": name, "correlation": value, "low": low, "high": high, "cells": len(cells)})
    return rows


def _correlation(cells: pd.DataFrame, column: str, mask: np.ndarray) -> float:
    return float(cells.loc[mask, column].corr(cells.loc[mask, "value"], method="spearman"))

"""Numbers of claims, made by hand."""

import numpy as np
import pandas as pd


def numbers() -> pd.DataFrame:
    """Four claims' numbers by hand: a share, one of two things with their mean, a factor, one that is undecided."""
    columns = ["number", "claim", "figure", "verdict", "factor", "value", "low", "high", "paper", "whole"]
    return pd.DataFrame([
        (1, "a mean", "table2_main", "reproduced, smaller", False, 0.1, 0.05, 0.15, 0.3, True),
        (2, "every task", "table2_main", "direction only", False, 0.4, 0.3, 0.5, np.nan, False),
        (2, "every task", "table2_main", "direction only", False, 0.0, -0.1, 0.1, np.nan, False),
        (2, "every task", "table2_main", "direction only", False, 0.2, 0.1, 0.3, np.nan, True),
        (6, "a factor", "fig4_scaling", "reproduced", True, 2.0, 1.5, 3.0, 2.5, True),
        (9, "a number of which nobody knows whether it is there", "fig4_scaling", "undecided", False, -0.2, -0.5, 0.1,
         np.nan, True)], columns=columns)

"""The paper's own numbers, as data (arXiv 2512.04813); nothing here was computed by this package.

`PAPER` holds every printed value of every figure and table, one a row. Figures 6 and 7 print none: their curves are
drawn only. Of figure 4 only the pairs of sizes are printed that are said to do equally well.
"""

from __future__ import annotations

from typing import Literal

import pandas as pd

from move.errors import BadInput

COLUMNS = ("experiment", "task", "method", "condition", "metric", "value")
PAPER_METHODS: tuple[Literal["static", "adc", "move"], ...] = ("static", "adc", "move")
PAPER_TASKS = (
    "pick-place", "push", "assembly", "box-close", "hammer", "pick-place-wall", "window-open", "faucet-open",
    "disassemble", "basketball",
)
"""What the paper has, in the order of table 2; the package may know more methods and tasks."""

_ONE_TASK = [
    ("fig1_sparse", "static", "", "success", 0.295),
    ("fig1_sparse", "move", "", "success", 0.808),
    ("fig1_sparse", "static", "", "demonstrations", 90),
    ("fig1_sparse", "move", "", "demonstrations", 85),
    ("fig3_dense", "static", "", "success", 0.66),
    ("fig3_dense", "move", "", "success", 0.74),
    ("fig3_dense", "static", "", "demonstrations", 90),
    ("fig3_dense", "move", "", "demonstrations", 85),
    ("fig5_circle", "static", "inside", "success", 0.213),
    ("fig5_circle", "move", "inside", "success", 0.437),
    ("fig5_circle", "static", "outside", "success", 0.446),
    ("fig5_circle", "move", "outside", "success", 0.674),
    ("fig5_circle", "static", "", "demonstrations", 90),
    ("fig5_circle", "move", "", "demonstrations", 59),
    ("table1_spatial_factors", "static", "object", "success", 0.675),
    ("table1_spatial_factors", "static", "object+target", "success", 0.447),
    ("table1_spatial_factors", "static", "all", "success", 0.317),
    ("table1_spatial_factors", "static", "", "timesteps", 20_000),
]
_TABLE2 = {
    "static": (0.317, 0.163, 0.072, 0.351, 0.156, 0.066, 0.512, 0.289, 0.279, 0.011),
    "adc": (0.472, 0.335, 0.053, 0.383, 0.252, 0.237, 0.455, 0.345, 0.207, 0.025),
    "move": (0.673, 0.410, 0.131, 0.417, 0.309, 0.298, 0.705, 0.418, 0.447, 0.099),
}
_TABLE5 = (20_000, 20_000, 20_000, 100_000, 20_000, 20_000, 5_000, 5_000, 20_000, 20_000)
_OTHERS = [
    ("table2_main", "", "static", "", "mean_success", 0.222),
    ("table2_main", "", "adc", "", "mean_success", 0.276),
    ("table2_main", "", "move", "", "mean_success", 0.391),
    ("table2_main", "", "move", "over static", "relative_gain", 0.761),
    ("fig2_overview", "real-robot", "move", "over static", "largest_score_ratio", 4.0),
    ("fig4_scaling", "pick-place", "move", "equally good", "timesteps", 20_000),
    ("fig4_scaling", "pick-place", "static", "equally good", "timesteps", 50_000),
    ("fig4_scaling", "assembly", "move", "equally good", "timesteps", 50_000),
    ("fig4_scaling", "assembly", "static", "equally good", "timesteps", 100_000),
    ("fig4_scaling", "pick-place-wall", "move", "equally good", "timesteps", 20_000),
    ("fig4_scaling", "pick-place-wall", "static", "equally good", "timesteps", 100_000),
    ("fig4_scaling", "", "move", "least", "data_efficiency", 2),
    ("fig4_scaling", "", "move", "most", "data_efficiency", 5),
    ("table3_real", "real-robot", "static", "35000", "success", 0.033),
    ("table3_real", "real-robot", "move", "35000", "success", 0.233),
    ("table3_real", "real-robot", "static", "75000", "success", 0.233),
    ("table3_real", "real-robot", "move", "75000", "success", 0.367),
    ("table3_real", "real-robot", "static", "35000", "score", 0.055),
    ("table3_real", "real-robot", "move", "35000", "score", 0.311),
    ("table3_real", "real-robot", "static", "75000", "score", 0.389),
    ("table3_real", "real-robot", "move", "75000", "score", 0.522),
    ("table6_collection", "", "static", "simulation", "mean_steps", 83.8),
    ("table6_collection", "", "move", "simulation", "mean_steps", 107.4),
    ("table6_collection", "", "static", "simulation", "generation_rate", 0.933),
    ("table6_collection", "", "move", "simulation", "generation_rate", 0.897),
    ("table6_collection", "real-robot", "static", "real robot", "mean_steps", 459.2),
    ("table6_collection", "real-robot", "move", "real robot", "mean_steps", 549.3),
    ("table6_collection", "real-robot", "static", "real robot", "people", 2),
    ("table6_collection", "real-robot", "move", "real robot", "people", 2),
]

PAPER = pd.DataFrame(
    [(name, "pick-place", *rest) for name, *rest in _ONE_TASK]
    + [("table2_main", task, method, "", "success", value)
       for method, values in _TABLE2.items() for task, value in zip(PAPER_TASKS, values, strict=True)]
    + [("table5_data_sizes", task, "", "", "timesteps", value)
       for task, value in zip(PAPER_TASKS, _TABLE5, strict=True)]
    + _OTHERS,
    columns=list(COLUMNS),
).astype({"value": float})
"""One printed value a row; "" where a column says nothing. Rates, scores and gains are shares of 1; real-robot
conditions of table 3 are timesteps. A mean over tasks has a metric of its own, never a row among the tasks."""

EPISODES_A_RATE = 60
"""Behind a rate of tables 1 and 2: three seeds, and the 20 configurations of all ten published task configurations (the
text gives no number). Of figures 1, 3 and 5 nothing is known."""

TABLE4_HYPERPARAMETERS = {
    "prediction horizon": (4, 8),
    "action horizon": (3, 8),
    "observation horizon": (2, 2),
    "gradient steps": ("220,000 in all", "200 an epoch"),
    "batch size": (128, 128),
    "denoising steps in training": (100, 50),
    "denoising steps in inference": (10, 10),
}
"""Simulation and real robot."""


def published(experiment: str, metric: str = "success", **where: str) -> pd.DataFrame:
    """The rows of `PAPER` of one experiment and metric, of those with the given values of other columns.

    With metric "difference" the values are MOVE's success minus another method's, which a column `baseline` names.

    Raises:
        BadInput: the paper gives no such value.
    """
    if metric == "difference":
        rates = published(experiment, "success", **where)
        move = rates[rates.method == "move"].drop(columns="method")
        pairs = rates[rates.method != "move"].rename(columns={"method": "baseline"}).merge(
            move, on=["experiment", "task", "condition", "metric"], suffixes=("_other", ""))
        return pairs.assign(metric="difference", value=pairs.value - pairs.value_other).drop(columns="value_other")
    wanted = {"experiment": experiment, "metric": metric, **where}
    rows = PAPER[(PAPER[list(wanted)] == pd.Series(wanted)).all(axis=1)]
    if rows.empty:
        raise BadInput(f"paper: no value for {', '.join(f'{k} {v!r}' for k, v in wanted.items())}; allowed are the "
                       f"experiments {', '.join(PAPER.experiment.unique())} with their metrics")
    return rows


# The real robot: section 4 and the appendix. The counts are the only whole numbers that give the printed shares.
REAL_TRIALS = 30  # unseen positions, each tried once
REAL_POINTS = 3  # approach, pick up, put down: one point each
REAL_SIZES_TIMESTEPS = (35_000, 75_000)
REAL_RADIUS_M = 0.60  # the semicircular workspace, 0.5 * pi * 60 cm * 60 cm


def _real_counts() -> pd.DataFrame:
    """Table 3 in whole trials and points: 0.055 is 5/90 = 0.0556, cut and not rounded in the paper."""
    cells = published("table3_real").merge(
        published("table3_real", "score"), on=["condition", "method"], suffixes=("", "_score"))
    return pd.DataFrame({
        "timesteps": cells.condition.astype(int), "method": cells.method,
        "successes": (REAL_TRIALS * cells.value).round().astype(int),
        "score": (REAL_TRIALS * REAL_POINTS * cells.value_score).round().astype(int),
        "printed_success_percent": 100 * cells.value, "printed_score": cells.value_score,
    })


TABLE3_REAL = _real_counts()
TABLE6_REAL_MEAN_TIMESTEPS = dict(published("table6_collection", "mean_steps", condition="real robot")
                                  [["method", "value"]].itertuples(index=False, name=None))

"""What each setting explains of the distance between the paper's rates and those here, in points with intervals."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move import paper
from move.experiments.gap import GRASPS, LISTED, PACKAGE, SETTINGS, TOGETHER
from move.report.differences import difference_table
from move.statistics.cells import successes, training_noise
from move.statistics.estimates import UNKNOWN, Estimate, TrainingNoise, difference, success_rate, unpaired_difference

INTERACTION, UNEXPLAINED, PAPER = "more together than alone", "not explained", "the paper"
COLUMNS = ["case", "method", "setting", "value", "low", "high", "seeds", "episodes", "trainings", "effect",
           "effect_low", "effect_high"]


def gap_table(episodes: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """One row a case, method and setting: success under it, and what switching it alone does to success.

    `effect` is the rate under the setting minus that under the package's protocol, paired at the configurations that
    both were tried on; a setting that changes the configurations themselves is compared unpaired.

    Args:
        episodes: as `move.study.results.table` gives them, with the labels `case` and `setting`; no training points.
    """
    noise, rows = training_noise(episodes, ["case", "setting", "method"], known), []
    for (case, method), group in episodes.groupby(["case", "method"], sort=False):
        cells = {name: successes(part) for name, part in group.groupby("setting", sort=False)}
        for name in sorted(cells, key=_order):
            rate = success_rate(cells[name], noise)
            rows.append({"case": case, "method": method, "setting": name, "value": rate.value, "low": rate.low,
                         "high": rate.high, "seeds": cells[name].mean(axis=1).round(4).tolist(),
                         "episodes": rate.episodes, "trainings": rate.trainings, **_effect(cells, name, noise)})
    return pd.DataFrame(rows, columns=COLUMNS)


def _order(setting: str) -> tuple[bool, int]:
    """Where a setting is shown: as `SETTINGS` lists them, other lengths of training after them, all together last."""
    return setting == TOGETHER, SETTINGS.index(setting) if setting in SETTINGS else len(SETTINGS)


def _effect(cells: dict[str, np.ndarray], name: str, noise: TrainingNoise) -> dict[str, float]:
    if name == PACKAGE or PACKAGE not in cells:
        return {}
    found = _compared(cells[name], cells[PACKAGE], name in (LISTED, TOGETHER), noise)
    return {"effect": found.value, "effect_low": found.low, "effect_high": found.high}


def _compared(one: np.ndarray, other: np.ndarray, elsewhere: bool, noise: TrainingNoise) -> Estimate:
    """`one` minus `other`, at the first configurations where one was tried on fewer; 0 where they are the same."""
    if np.array_equal(one, other):
        return Estimate(0.0, 0.0, 0.0, len(one), one.size, "none")
    if elsewhere:
        return unpaired_difference(one, other, noise)
    return difference(one, other[:, : one.shape[1]], noise)


def published_rates(episodes: pd.DataFrame) -> pd.DataFrame:
    """The paper's rates of the cases and methods in `episodes`: case, method, paper."""
    grasps, tasks = paper.published("fig1_sparse").assign(case=GRASPS), paper.published("table2_main")
    rows = pd.concat([grasps, tasks.assign(case=tasks.task)])
    return rows[rows.case.isin(episodes.case)][["case", "method", "value"]].rename(columns={"value": "paper"})


def waterfall(table: pd.DataFrame) -> pd.DataFrame:
    """Steps from the rate here to the paper's, one row a case, method and step: where it starts, how far it goes.

    The effects of the settings alone, then what all of them together do more than their sum, then what is not
    explained: the paper's rate minus that under all of them. Columns case, method, step, start, change, low, high (of
    the change; NaN where no interval is known). A case without the package's protocol or without all of them together
    has what there is of it.

    Args:
        table: as `gap_table` gives it, with the paper's rate in `paper`.
    """
    rows: list[dict] = []
    for (case, method), group in table.groupby(["case", "method"], sort=False):
        by_setting, theirs = group.set_index("setting"), group.paper.iloc[0]
        if PACKAGE not in by_setting.index:
            continue
        level = by_setting.value[PACKAGE]
        for name, row in by_setting.drop(index=[PACKAGE, TOGETHER], errors="ignore").iterrows():
            rows.append({"case": case, "method": method, "step": name, "start": level, "change": row.effect,
                         "low": row.effect_low, "high": row.effect_high})
            level += row.effect
        if TOGETHER in by_setting.index:
            together = by_setting.loc[TOGETHER]
            rows.append({"case": case, "method": method, "step": INTERACTION, "start": level,
                         "change": together.value - level})
            rest = theirs - together.value
            rows.append({"case": case, "method": method, "step": UNEXPLAINED, "start": together.value, "change": rest,
                         "low": theirs - together.high, "high": theirs - together.low})
    return pd.DataFrame(rows, columns=["case", "method", "step", "start", "change", "low", "high"])


def lead_table(episodes: pd.DataFrame, theirs: pd.DataFrame, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """MOVE minus static under each setting, paired: the columns of `difference_table`, with case, and paper's in paper.

    Args:
        theirs: as `published_rates` gives them.
    """
    published = theirs.pivot(index="case", columns="method", values="paper")
    parts = [difference_table(group, "setting", ("static",), known).assign(
        case=case, paper=published.move[case] - published.static[case])
        for case, group in episodes.groupby("case", sort=False)]
    return pd.concat(parts, ignore_index=True)


def sentence(rates: pd.DataFrame, steps: pd.DataFrame) -> str:
    """What the settings explain of static's distance to the paper, case by case, in points."""
    said = []
    for case, group in rates[rates.method == "static"].groupby("case", sort=False):
        level, theirs = group.set_index("setting").value, group.paper.iloc[0]
        known = [row for row in steps[(steps.case == case) & (steps.method == "static")].itertuples()
                 if row.step not in (INTERACTION, UNEXPLAINED) and not np.isnan(row.change)]
        if PACKAGE not in level:
            said.append(f"{case}: not computed yet")
            continue
        largest = min(known, key=lambda row: row.change, default=None)
        moved = (f"the largest single step is {largest.step} ({_points(largest.change)} points "
                 f"[{_points(largest.low)}, {_points(largest.high)}])" if largest else "no setting is computed yet")
        left = f"; with all of them {level[TOGETHER]:.0%}" if TOGETHER in level else ""
        said.append(f"{case}: static {level[PACKAGE]:.0%} here, {theirs:.0%} in the paper; {moved}{left}")
    return f"**Here:** {'. '.join(said)}."


def _points(change: float) -> str:
    return f"{round(100 * change):+d}"

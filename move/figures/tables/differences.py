"""Differences of methods: MOVE minus another, item by item, on the mean and over tasks, as tables and in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import pandas as pd

from move.figures.page.printed import ABSENT, readable
from move.figures.plots.style import NAMES
from move.figures.tables import points
from move.statistics.cells import successes, training_noise
from move.statistics.estimates import Estimate, difference, holm, mean_difference
from move.statistics.over_tasks import over_tasks
from move.statistics.training_noise import UNKNOWN, TrainingNoise
from move.statistics.verdicts import Finding, verdict

Pair = tuple[np.ndarray, np.ndarray]
OTHERS = ("static", "adc")  # what MOVE is compared with, where it is there
COLUMNS = ("difference", "low", "high", "p", "holm", "trainings")
OVER_TASKS = ["baseline", "tasks", "mean_difference", "low", "high", "iqm_first", "iqm_second", "iqm_low", "iqm_high",
              "improvement", "improvement_low", "improvement_high", "p_value"]
LEVEL = 0.05  # of a word such as "above": of all the words of one table together


def difference_table(episodes: pd.DataFrame, by: str, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """MOVE minus each other method, paired, one row a value of `by` and method: interval, p, and p after Holm.

    Holm's adjustment is over all values of `by`, for each other method apart. The noise of trainings is as in
    `rate_table`.

    Args:
        episodes: rows as `move.study.results.table` gives them, with the column `by`, policies only.
    """
    noise = training_noise(episodes, [by, "method"], known)
    rows: list[dict] = []
    for other in OTHERS:
        rows += with_holm([{by: value, "baseline": other, **as_columns(difference(*pair, noise))}
                            for value, pair in _pairs(episodes, by, other)])
    table = pd.DataFrame(rows, columns=[by, "baseline", *COLUMNS])
    order = {value: place for place, value in enumerate(episodes[by].unique())}
    return table.sort_values(by, key=lambda values: values.map(order), kind="stable", ignore_index=True)


def differences_at(episodes: pd.DataFrame, at: str, by: str, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """A `difference_table` for each value of column `at` by itself, one below the other."""
    return pd.concat([difference_table(rows, by, known).assign(**{at: value})
                      for value, rows in episodes.groupby(at)], ignore_index=True)


def joined(tables: Iterable[pd.DataFrame]) -> pd.DataFrame:
    """Tables of differences, one below the other, with Holm's adjustment over all of their rows."""
    rows = pd.concat(tables, ignore_index=True)
    return rows.assign(holm=holm(rows.p)) if len(rows) else rows


def difference_means(episodes: pd.DataFrame, by: str, known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """The mean over the values of `by` of MOVE minus each other method: other trainings and configurations of these.

    A method that meets MOVE on fewer than two items has no row. Arguments as for `difference_table`.
    """
    noise = training_noise(episodes, [by, "method"], known)
    rows: list[dict] = []
    for other in OTHERS:
        pairs = [pair for _, pair in _pairs(episodes, by, other)]
        rows += [{"baseline": other, **mean_columns(pairs, noise)}] if len(pairs) > 1 else []
    return pd.DataFrame(rows, columns=["baseline", "items", *COLUMNS])


def tasks_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """MOVE against each other method with the task as the unit, one row a method: what other tasks might give.

    Columns baseline, and those of `move.statistics.over_tasks.OverTasks`; a method that meets MOVE on fewer than
    three tasks has no row.
    """
    rows = []
    for other in OTHERS:
        pairs = [pair for _, pair in _pairs(episodes, "task", other)]
        rows += [{"baseline": other, **vars(over_tasks(pairs))}] if len(pairs) > 2 else []
    return pd.DataFrame(rows)


def _pairs(episodes: pd.DataFrame, by: str, other: str) -> list[tuple[object, Pair]]:
    """For each value of `by` that has both: the successes of MOVE and of the other method."""
    pairs = []
    for value, group in episodes.groupby(by, sort=False):
        per_method = {method: successes(part) for method, part in group.groupby("method")}
        if "move" in per_method and other in per_method:
            pairs.append((value, (per_method["move"], per_method[other])))
    return pairs


def variant_table(
    episodes: pd.DataFrame, by: list[str], column: str, pairs: Callable[[pd.DataFrame], Iterable[tuple]],
    known: TrainingNoise = UNKNOWN, compare: Callable[..., Estimate] = difference,
) -> pd.DataFrame:
    """Variants of one method against each other: a row a pair of values of `column` that are there, for each of `by`.

    Each is the first minus the second, which stands in the column `baseline`. Holm's adjustment is over the rows of
    one group. Columns `by`, `column`, baseline and `COLUMNS`.

    Args:
        pairs: takes the episodes of a group of `by`.
        compare: `difference`, paired by configuration, or `unpaired_difference` where the variants have other ones.
    """
    rows: list[dict] = []
    for key, group in episodes.groupby(by, sort=False) if by else [((), episodes)]:
        cells: dict[object, np.ndarray] = {value: successes(part) for value, part in group.groupby(column)}
        noise = training_noise(group, [column, "method"], known)
        rows += with_holm([
            {**dict(zip(by, key, strict=True)), column: one, "baseline": other,
             **as_columns(compare(cells[one], cells[other], noise))}
            for one, other in pairs(group) if {one, other} <= set(cells)])
    return pd.DataFrame(rows, columns=[*by, column, "baseline", *COLUMNS])


def difference_text(row: pd.Series) -> str:
    """A row of `difference_table` in words: "+12 points [+3, +21], above 0"; the word holds after Holm's adjustment."""
    clear = row.holm < LEVEL
    word = "not distinguishable from 0" if not clear else "above 0" if row.difference > 0 else "below 0"
    return f"{interval_text(row, ' points')}, {word}"


def difference_brief(row: pd.Series) -> str:
    """A row in a few words: "+13 [+10, +16], above 0"; no word where it is not distinguishable from 0 after Holm's."""
    word = ("", ", below 0", ", above 0")[int(row.holm < LEVEL) * (1 + int(row.difference > 0))]
    return f"{interval_text(row)}{word}"


def with_verdicts(table: pd.DataFrame, rates: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """A `difference_table` with the paper's in column `paper`, and the verdict of each row in column `verdict`.

    Args:
        rates: the compared rates, whose baselines leave MOVE so much room: method, value, and the columns `by`.
        by: the columns that name a row for one other method.
    """
    baseline = rates.set_index([*by, "method"]).value
    return table.assign(verdict=[
        difference_verdict(row, baseline[(*(row[key] for key in by), row.baseline)])
        if pd.notna(row.paper) else "no value of the paper" for _, row in table.iterrows()])


def verdicts_text(table: pd.DataFrame, by: str) -> str:
    """A table `with_verdicts` in words: of each row its name in column `by`, the difference in points, the verdict."""
    return "; ".join(f"{row[by]} {interval_text(row)}: {row.verdict}"
                     for _, row in table.iterrows()) or "nothing to compare yet"


def difference_verdict(row: pd.Series, baseline: float, paper_half_width: float = 0.0) -> str:
    """The verdict on the paper's difference `row.paper`, by the rule of `move.statistics.verdicts`.

    Args:
        row: difference, low, high, paper.
        baseline: the other method's rate.
        paper_half_width: half of the 95 % interval of the paper's difference, 0 where nothing is known of it.
    """
    return verdict([Finding("", row.difference, row.low, row.high, paper=row.paper, room=1 - baseline,
                            paper_half_width=paper_half_width)])


def interval_text(row, unit: str = "") -> str:
    """A row with a difference in whole points, and its interval: "+13 [+10, +16]"."""
    return f"{points(row.difference)}{unit} [{points(row.low)}, {points(row.high)}]"


def clear_counts(table: pd.DataFrame) -> dict[str, int]:
    """Of comparisons with a column holm, how many are above 0, below, and neither."""
    clear = table[table.holm < LEVEL].difference
    above, below = int((clear > 0).sum()), int((clear < 0).sum())
    return {"above": above, "below": below, "neither": len(table) - above - below}


def counts_text(table: pd.DataFrame) -> str:
    """`clear_counts` in words."""
    counts = clear_counts(table)
    return (f"{counts['above']} of {len(table)} are above 0, {counts['below']} below, {counts['neither']} not "
            "distinguishable from it")


def means_text(means: pd.DataFrame) -> str:
    """A table of `difference_means` in words: "MOVE minus static +13 points [+10, +16], minus ADC +8 [+4, +11]"."""
    each = [f"minus {NAMES[row.baseline]} {interval_text(row, ' points' * (place == 0))}"
            for place, row in enumerate(means.itertuples())]
    return f"MOVE {', '.join(each)}" if each else "nothing to compare yet"


def above_text(table: pd.DataFrame) -> str:
    """On how many rows of a `difference_table` MOVE is above each other method after Holm's adjustment, in words."""
    return ", ".join(f"above {NAMES[other]} on {clear_counts(rows)['above']} of {len(rows)}"
                     for other, rows in table.groupby("baseline", sort=False)) or "compared with nothing yet"


def largest(table: pd.DataFrame) -> pd.Series | None:
    """The row of the difference that is farthest from 0; None of an empty table."""
    return None if table.empty else table.loc[table.difference.abs().idxmax()]


def summary(table: pd.DataFrame, means: pd.DataFrame, tasks: pd.DataFrame | None = None) -> pd.DataFrame:
    """MOVE against each other method, one row a method, as text for people.

    On how many rows it is above, below and not distinguishable after Holm's adjustment, and the mean difference; with
    the tasks as a sample also what other tasks might give.

    Args:
        table: a `difference_table`.
        means: its `difference_means`.
        tasks: its `tasks_table`.
    """
    counts = [{"baseline": other, **clear_counts(rows)} for other, rows in table.groupby("baseline", sort=False)]
    text = readable(pd.DataFrame(counts))
    heads = {"Difference (points)": "Mean difference (points)", "Mean (points)": "Over other tasks (points)",
             "p": "p, over tasks"}
    for more, columns in ((means, ["baseline", "difference", "low", "high"]), (tasks, OVER_TASKS)):
        if more is not None and len(more) and counts:
            text = text.merge(readable(more[columns]).rename(columns=heads), on="Against", how="left")
    return text.fillna(ABSENT)


def as_columns(found: Estimate) -> dict[str, float | str]:
    """A difference as columns: all of `COLUMNS` but holm."""
    return {"difference": found.value, "low": found.low, "high": found.high, "p": found.p_value,
            "trainings": found.trainings}


def mean_columns(pairs: list[Pair], noise: TrainingNoise) -> dict:
    """A row of `difference_means`: the mean over pairs; it is one comparison, and Holm leaves it as it is."""
    mean = mean_difference(pairs, noise)
    return {"items": len(pairs), **as_columns(mean), "holm": mean.p_value}


def with_holm(rows: list[dict]) -> list[dict]:
    """Rows with a p, as many comparisons of one table, and what p is after Holm's adjustment."""
    if not rows:
        return []
    return [{**row, "holm": value} for row, value in zip(rows, holm([row["p"] for row in rows]), strict=True)]

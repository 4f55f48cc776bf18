"""What is shipped agrees with itself: results, tables, captions. Each number is reached by a second way.

Rates are counted again from the stored files with nothing but JSON; differences are taken again from the rates; and
what a caption says in words is looked up in the tables. After adding results draw the figures again: `make figures`.
"""

import json
import re
from functools import cache

import numpy as np
import pandas as pd
import pytest

from move import paper, paths
from move.figures import load
from move.figures.page import captions, parameters
from move.figures.page.kernels import of_profile
from move.study.profiles import load_profile

LAPTOP = load_profile("laptop")
SHIPPED = LAPTOP.figures
STORED = LAPTOP.results
ROUNDED = 1e-4  # of a number in a CSV file
TRIPLE = re.compile(r"([+-]\d+)(?: points)? \[([+-]\d+), ([+-]\d+)\]"
                    r"(, above 0|, below 0|, not distinguishable from 0)?")
DIFFERENCES = [("difference", "low", "high"), ("gain", "gain_low", "gain_high"), ("mean_difference", "low", "high"),
               ("iqm_difference", "iqm_low", "iqm_high"), ("effect", "effect_low", "effect_high")]


@cache
def shipped(name: str) -> pd.DataFrame:
    table = pd.read_csv(SHIPPED / f"{name}.csv")
    if {"iqm_first", "iqm_second"} <= set(table):
        table["iqm_difference"] = table.iqm_first - table.iqm_second
    return table


@cache
def content(path) -> dict:
    return json.loads(path.read_text())


BY = {name: load(name).BY for name in of_profile(LAPTOP, stored_only=True) if hasattr(load(name), "BY") and
      all(spec.evaluation.starts == "random" for spec in parameters.specs(name, LAPTOP))}
"""Figures whose table has a row for each of these labels of their runs, counted over all their configurations."""


def counted(figure: str, named: tuple[str, ...], **only: object) -> pd.DataFrame:
    """Of an experiment's runs that are stored, by their labels: successes and episodes, one row a run."""
    rows = []
    for run in parameters.runs(figure, LAPTOP):
        path = STORED / f"{run.spec.hash}.json"
        collection = run.spec.collection
        labels = {"timesteps": collection and collection.timesteps, **run.labels, "observation": run.spec.observation,
                  "method": collection.method if run.spec.agent == "policy" else run.spec.agent}
        if path.exists() and all(labels[name] == value for name, value in only.items()):
            success = np.array(content(path)["rows"]["success_steps"]) > 0
            rows.append({**{name: labels[name] for name in named}, "successes": success.sum(), "all": len(success)})
    return pd.DataFrame(rows).groupby(list(named), as_index=False).sum()


@pytest.mark.parametrize(("table", "figure", "named", "only"), [
    ("table2_main", "table2_main", ("task", "method"), {"observation": "rgb"}),
    ("table2_main_keypoints", "table2_main", ("task", "method"), {"observation": "keypoints"}),
    ("table1_spatial_factors", "table1_spatial_factors", ("factors", "method"), {}),
    *[(name, name, tuple(by), {}) for name, by in BY.items()],
])
def test_every_shipped_rate_is_what_the_stored_episodes_count(table, figure, named, only):
    drawn = shipped(table)
    again = counted(figure, named, **only)
    if "length" in named:
        again["length"] = again.length.round(4)
    both = drawn.merge(again, on=list(named), how="outer", indicator=True)
    assert (both._merge == "both").all(), "no cell is drawn that is not stored, and none left out: make figures"
    assert both.value.to_numpy() == pytest.approx((both.successes / both["all"]).to_numpy(), abs=ROUNDED)
    assert (both.episodes == both["all"]).all()


RATES = sorted(path.stem for path in SHIPPED.glob("*.csv") if {"value", "seeds", "low", "high"} <= set(
    pd.read_csv(path, nrows=0)))


@pytest.mark.parametrize("name", RATES)
def test_a_rate_is_the_mean_of_its_seeds_and_lies_within_its_interval(name):
    table = shipped(name)
    if table.empty:
        pytest.skip("none of its runs is stored yet")
    seeds = [np.array(str(row).split(), float) for row in table.seeds]
    assert [each.mean() for each in seeds] == pytest.approx(table.value.tolist(), abs=ROUNDED)
    assert (table.low <= table.value).all() and (table.value <= table.high).all()
    assert (table.low >= 0).all() and (table.high <= 1).all() and (table.low < table.high).all()
    several = np.array([len(each) > 1 for each in seeds])
    assert table.trainings[several].isin(["moderated", "none"]).all()
    assert table.trainings[~several].isin(["like cells", "none"]).all()


GAPS = {
    "table2_main_differences": ("table2_main", "method", "move", ("task",)),
    "table2_main_differences_keypoints": ("table2_main_keypoints", "method", "move", ("task",)),
    "table1_spatial_factors_differences": ("table1_spatial_factors", "method", "move", ("factors",)),
    "table1_spatial_factors_lost": ("table1_spatial_factors", "factors", None, ("method",)),
    "few_demonstrations_differences": ("few_demonstrations", "method", "move", ("timesteps",)),
    "fig1_sparse_difference": ("fig1_sparse_hand", "method", "move", ("hand",)),
    "fig3_dense_difference": ("fig3_dense_hand", "method", "move", ("hand",)),
    "fig3_dense_near_budgets_difference": ("fig3_dense_near_budgets", "method", "move", ("timesteps",)),
    "gap_leads": ("gap", "method", "move", ("case", "setting")),
    "fig3_dense_budgets_difference": ("fig3_dense_budgets", "method", "move", ("timesteps",)),
    "fig5_circle_differences": ("fig5_circle_hand", "method", "move", ("where", "hand")),
    "keypoint_control_differences": ("keypoint_control", "method", "move", ("timesteps",)),
    "table_keypoint_control_differences": ("table_keypoint_control", "method", "move", ("task",)),
}
OTHERWISE = {"fig_training_length_depends", "fig_training_length_beyond", "fig_perception_differences_rgb",
             "fig_perception_differences_keypoints", "generalization_differences", "table_adc_differences",
             "fig4_scaling_equal"}  # tested elsewhere


def tables_of_differences() -> set[str]:
    return {path.stem for path in SHIPPED.glob("*.csv") if {"difference", "holm"} <= set(pd.read_csv(path, nrows=0))}


def gap(name: str, table: str, by: list[str]) -> tuple[str, str, str | None, tuple[str, ...]]:
    """Of a table of differences beside rates by these labels: as in `GAPS`; the baseline says which label differs."""
    differences, rates = shipped(table), shipped(name)
    column, = [label for label in by if set(differences.baseline) <= set(rates[label])]
    return (name, column, "move" if column == "method" else None,
            tuple(label for label in by if label in differences and label != column))


GAPS |= {table: gap(name, table, by) for name, by in BY.items() for table in tables_of_differences() - OTHERWISE
         if table.startswith(f"{name}_") and not table.endswith("_mean")}


@pytest.mark.parametrize("name", GAPS)
def test_a_shipped_difference_is_the_first_rate_minus_the_second(name):
    rates_name, column, first, by = GAPS[name]
    rates = shipped(rates_name).set_index([*by, column]).value
    for row in shipped(name).to_dict("records"):
        place = tuple(row[key] for key in by)
        one, other = (rates.loc[place + (value,)] for value in (first or row[column], row["baseline"]))
        assert row["difference"] == pytest.approx(one - other, abs=3 * ROUNDED), row
        assert row["low"] <= row["difference"] <= row["high"] and row["p"] <= row["holm"] <= 1


def test_every_table_of_differences_is_in_the_list_or_has_no_rates_beside_it():
    found = tables_of_differences()
    assert found - {name for name in found if name.endswith("_mean")} - OTHERWISE == {*GAPS}


@pytest.mark.parametrize("name", ["table2_main_differences", "table2_main_differences_keypoints",
                                  "table_keypoint_control_differences", "keypoint_control_differences"])
def test_the_mean_difference_is_the_mean_over_its_rows(name):
    for row in shipped(f"{name}_mean").itertuples():
        each = shipped(name)[shipped(name).baseline == row.baseline]
        assert row.difference == pytest.approx(each.difference.mean(), abs=ROUNDED) and row.items == len(each)


@pytest.mark.parametrize("seen", ["rgb", "keypoints"])
def test_in_perception_the_difference_is_of_the_means_of_the_same_experiment(seen):
    rates = shipped("fig_perception")
    rates = rates[rates.observation == seen].set_index(["experiment", "method"]).value
    for row in shipped(f"fig_perception_differences_{seen}").itertuples():
        both = rates[row.experiment]
        assert row.difference == pytest.approx(both["move"] - both["static"], abs=3 * ROUNDED)


def test_in_motion_the_difference_is_of_the_rates_in_motion():
    rates = shipped("generalization_rates").query("group == 'moving'").set_index(["task", "method"]).value
    for row in shipped("generalization_differences").itertuples():
        assert row.difference == pytest.approx(rates[row.task, "move"] - rates[row.task, row.baseline], abs=3 * ROUNDED)


def test_where_the_paper_says_equal_the_difference_is_of_the_rates_at_those_budgets():
    rates = shipped("fig4_scaling").set_index(["task", "method", "timesteps"]).value
    for row in shipped("fig4_scaling_equal").itertuples():
        one = rates.get((row.task, "move", row.move_timesteps), np.nan)
        other = rates.get((row.task, "static", row.static_timesteps), np.nan)
        assert row.difference == pytest.approx(one - other, abs=3 * ROUNDED, nan_ok=True)


CAPTIONS = sorted(path.name.removesuffix(".caption.md") for path in SHIPPED.glob("*.caption.md"))
BESIDE = {"fig4_efficiency": "fig4_scaling"}


def came_out(name: str) -> str:
    return captions.read(SHIPPED / f"{name}.caption.md").found


@pytest.mark.parametrize("name", [name for name in CAPTIONS if TRIPLE.search(came_out(name))])
def test_every_difference_that_a_caption_tells_stands_in_a_table_with_the_same_word(name):
    """ "+12 points [+2, +22], above 0": some row has that difference and interval, and its p after Holm agrees."""
    rows = []
    for path in SHIPPED.glob(f"{BESIDE.get(name, name)}*.csv"):
        table = shipped(path.stem)
        for columns in DIFFERENCES:
            if set(columns) <= set(table):
                holm = table.holm if "holm" in table else [np.nan] * len(table)
                rows += list(zip(*(100 * table[column] for column in columns), holm, strict=True))
    for told in TRIPLE.finditer(came_out(name)):
        numbers = [int(number) for number in told.groups()[:3]]
        same = [row for row in rows if np.allclose(row[:3], numbers, rtol=0, atol=0.5 + 100 * ROUNDED)]
        assert same, f"{told[0]}: in no table"
        word = (told[4] or "").removeprefix(", ")
        expected = {"not distinguishable from 0" if not row[3] < 0.05 else "above 0" if row[0] > 0 else "below 0"
                    for row in same}
        assert not word or word in expected, told[0]


@pytest.mark.parametrize("name", CAPTIONS)
def test_a_shipped_answer_has_at_most_sixty_words(name):
    assert len(came_out(name).split()) <= 60


MISSING = re.compile(r"(\d+) of (\d+) runs are missing|no run is missing")


@pytest.mark.parametrize("name", [name for name in CAPTIONS if MISSING.search(came_out(name))])
def test_a_caption_counts_the_runs_that_are_missing(name):
    if (notebook := BESIDE.get(name, name)) == "table2_main":
        pytest.skip("counts its own: pixels and keypoints apart")
    specs = set(parameters.specs(notebook, LAPTOP))
    there = {path.stem for path in STORED.glob("*.json")}
    missing = sum(spec.hash not in there for spec in specs)
    told = MISSING.search(came_out(name))
    assert (int(told[1] or 0), int(told[2] or len(specs))) == (missing, len(specs)), "make figures"


RATE = re.compile(r"\b(static|ADC|MOVE) (\d+(?:\.\d+)?) ?%")
METHOD = {"static": "static", "ADC": "adc", "MOVE": "move"}


def said_rates(text: str) -> list[tuple[str, float, float]]:
    """Every "MOVE 52.4%": the method, the number in per cent, and half of its last digit."""
    return [(METHOD[name], float(number), 0.05 if "." in number else 0.5) for name, number in RATE.findall(text)]


@pytest.mark.parametrize("name", [name for name in CAPTIONS if RATE.search(came_out(name))])
def test_every_rate_that_a_caption_tells_is_that_methods_in_a_table_or_in_the_paper(name):
    """A rate stands in a table of the figure, or is the mean over the rows of one; the paper's are the paper's."""
    theirs, _, ours = came_out(name).partition("Here")
    known: dict[str, list[float]] = {method: [] for method in METHOD.values()}
    for path in SHIPPED.glob(f"{BESIDE.get(name, name)}*.csv"):
        table = shipped(path.stem)
        for column in {"value", "own", "elsewhere", "in_motion", "rate"} & set(table if "method" in table else ()):
            for method, values in table.groupby("method")[column]:
                known.setdefault(method, []).extend([*(100 * values), 100 * values.mean()])
    if name == "rollouts":  # shows the policies of the first seed
        for row in shipped("table2_main").query("task == 'pick-place'").itertuples():
            known[row.method] = [100 * float(row.seeds.split()[0])]
    for method, number, digit in said_rates(ours):
        assert np.isclose(known[method], number, rtol=0, atol=digit + 100 * ROUNDED).any(), (method, number)
    printed = 100 * paper.PAPER.query("metric in ('success', 'mean_success')").set_index("method").value
    for method, number, digit in said_rates(theirs):
        assert np.isclose(printed[method], number, rtol=0, atol=digit).any(), (method, number)


def test_the_deviations_say_the_means_that_the_tables_have():
    text = (paths.ROOT / "KNOWN_DEVIATIONS.md").read_text(encoding="utf-8")
    rates = shipped("table2_main").groupby("method").value.mean()
    readings = shipped("table_adc_means").set_index(["observation", "jumping"])["mean"]
    static, adc, move, *ways = (f"{mean:.3f}"[1:] for mean in (
        *(rates[method] for method in ("static", "adc", "move")),
        *(readings[seen, way] for seen in ("rgb", "keypoints") for way in ("mended", "as printed"))))
    assert f"with its present one they are {static}, {adc} and {move}" in text
    assert "ADC has {} so and {} as printed from pixels (one seed), {} and {} from keypoints".format(*ways) in text

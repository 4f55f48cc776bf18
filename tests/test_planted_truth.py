"""What the notebooks write, draw and say is what was planted in the results: tables, marks, sentences, verdicts; and
each picture can be printed.

Each number is counted again from the planted successes; the formulas of an interval and of p, which have tests of their
own, are given the cells that it should have been computed from. A wire that is wrong anywhere between a stored row and
a sentence turns a test red: rates exchanged, a difference turned round, another panel, another method's colour.

Left out are the notebooks that no stored result enters: fig2_overview and demonstrations (they simulate and film; see
test_coverage, test_film), table3_real (the paper's counts and robot data; test_real_notebook) and
table4_hyperparameters (the profiles; test_outputs). Rollouts shows no film here, for no policy is planted.
"""

import functools
import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import FillBetweenPolyCollection, LineCollection, PathCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.container import ErrorbarContainer
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from planted import World, features, planted_steps, planted_successes, visited
from scipy import stats
from test_figures import BY_HAND, PICTURES, words_of

from move.claims.claims import claims
from move.figures import table2_main
from move.figures.page import captions
from move.figures.plots import VERDICT_COLOURS, style
from move.figures.plots.style import GREY
from move.paper import PAPER, PAPER_TASKS
from move.sim import coverage
from move.sim.grasp_points import CIRCLE
from move.sim.tasks import TASKS, get_task
from move.statistics import distance, estimates, motion_is_coverage, training_noise, verdicts
from move.statistics.data_efficiency import data_efficiency
from move.statistics.over_tasks import over_tasks
from move.study.seen import FACTORS

ROUNDED = 1e-4  # of a number in a CSV file
NAMES = {"static": "static", "adc": "ADC", "move": "MOVE", "mixture": "mixture"}
COLOURS = {"static": "#0072b2", "adc": "#e69f00", "move": "#d55e00", "mixture": "#009e73"}
TITLES = {name: task.title for name, task in TASKS.items()}
ANYWHERE = {"hand": "anywhere", "group": "grid"}  # where the hand starts in figures 1, 3 and 5
NEAR = {"hand": "within 3 cm", "group": "grid"}
REPEATED = ("fig1_sparse", "few_demonstrations", "fifty_demonstrations", "fig3_dense", "fig5_circle", "fig_perception",
            "table1_spatial_factors", "table2_main", "fig6_dimensions", "keypoint_control", "table_keypoint_control")
"""Whose repeated trainings tell how much trainings differ, wherever a rate is shown."""
Row = dict[str, Any]


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    yield World(tmp_path_factory.mktemp("world"))
    plt.close("all")


@pytest.fixture(scope="module")
def turned(tmp_path_factory):
    yield World(tmp_path_factory.mktemp("turned"), turned=True)
    plt.close("all")


# tables of rates -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rates:
    """A table of rates: its figure, and which planted cell a row is about.

    `columns` of the table name features of the runs, which also are `fixed`, and `more` makes others of a row.
    """

    figure: str
    columns: tuple[str, ...]
    fixed: Row = field(default_factory=dict)
    place: str = ""  # or the column that names it
    noise: str = "rgb"  # how trainings differ: "rgb", "keypoints", or the same with " grid"
    more: Callable[[Row], Row] = lambda row: {}

    def wanted(self, row: Row) -> Row:
        return {**self.fixed, **{name: row[name] for name in self.columns}, **self.more(row)}

    def law(self, row: Row) -> str:
        part = row.get("experiment", row.get("where", row.get("case")))
        return row.get("observation", self.noise) + " grid" * str(part).startswith("figure")

    def cell(self, world: World, row: Row) -> np.ndarray:
        return world.cell(self.figure, row[self.place] if self.place in row else self.place, **self.wanted(row))


def moving(row: Row) -> Row:
    """What moves in the demonstrations, by its name in the tables."""
    if row["moves"] in ("nothing", "jumps"):
        return {"method": {"nothing": "static", "jumps": "adc"}[row["moves"]]}
    parts = frozenset(row["moves"].removesuffix(" alone").split(" + "))
    if row["moves"] == "all":
        has = get_task(row["task"])
        parts = frozenset(["object", "camera"] + ["target"] * has.has_target + ["rotation"] * has.has_yaw)
    return {"method": "move", "moving": parts}


def speed(row: Row) -> Row:
    """One speed is another than usual: metres a step, degrees a step of the camera."""
    if row["part"] == "nothing":
        return {"method": "static"}
    usual = {"object": 0.03, "target": 0.03, "camera": 1.0, row["part"]: row["speed"]}
    radians = {**usual, "camera": np.radians(usual["camera"])}
    return {"method": "move", **{f"{part}_speed": round(float(each), 6) for part, each in radians.items()}}


AUTHORS: dict[str, Row] = {
    "the package's protocol": {},
    "hand anywhere": {"hand": "anywhere"},
    "camera and target": {"fixed": "authors"},
    "35 steps traced back": {"object_steps": 35},
    "their 20 configurations": {"group": "listed"},
    "Meta-World's expert": {"expert": "metaworld"},
    "crop as theirs, 5/8": {"cropped": True},
    "its failures kept too": {"expert": "metaworld", "keep_failures": True},
    "shadows, sky, reflections": {"drawing": "full"},
    "0.33 times the steps": {"length": 0.33},
    "3 times the steps": {"length": 3.0},
    "10 times the steps": {"length": 10.0},
}
ELSEWHERE = ("their 20 configurations", "all of them together")  # tried at other configurations than the protocol
TOGETHER = {"expert": "metaworld", "keep_failures": True, "cropped": True, "drawing": "full"}


def setting(row: Row) -> Row:
    """The package's protocol with one setting of the authors', or with all of them; static's object never moves."""
    usual = {"object_steps": None, "expert": "phase", "keep_failures": False, "cropped": False, "drawing": "plain",
             "length": 1.0, "fixed": "package"}
    if row["case"] == "figure 1":
        usual |= {"protocol": "sparse", "task": "pick-place", "hand": "within 3 cm", "group": "grid"}
        together = {**TOGETHER, "hand": "anywhere", "fixed": "authors", "object_steps": 35}
    else:
        usual |= {"protocol": "random", "task": row["case"], "group": "random"}
        together = {**TOGETHER, "group": "listed"}
    found = {**usual, **(together if row["setting"] == "all of them together" else AUTHORS[row["setting"]])}
    return {**found, "object_steps": None} if row["method"] == "static" else found


def experiment(row: Row) -> Row:
    named = {"figure 1": "sparse", "figure 3": "dense", "figure 5": "circle"}
    if row["experiment"] in named:
        return {"protocol": named[row["experiment"]]}
    return {"protocol": "random", "factors": row["experiment"].removeprefix("table 1, ")}


def reached(row: Row) -> Row:
    if row["setting"] == "ten tasks":
        return {"task": row["where"], "protocol": "random"}
    hand = row["setting"].removeprefix("hand ").removeprefix("in ")
    return {**experiment({"experiment": row["where"]}), "hand": hand}


def budget(row: Row) -> Row:
    return {"timesteps": 18_000 if row["method"] == "static" and row["equal"] == "demonstrations" else 20_000}


ARMS: dict[str, tuple[str, str, int]] = {  # method, rule, places; 0: as many as demonstrations
    "5 places": ("static", "jittered", 5), "10 places": ("static", "jittered", 10),
    "each its own, random": ("static", "random", 0), "each its own, jittered grid": ("static", "jittered", 0),
    "each its own, Halton": ("static", "halton", 0), "MOVE, 5 places": ("move", "jittered", 5),
    "MOVE, random": ("move", "random", 0)}


def arm(row: Row) -> Row:
    """How the demonstrations of an arm are placed, and how many there are or how long they may be."""
    method, rule, places = ARMS[row["arm"]]
    timed = row["equal"] == "timesteps" and method == "move"
    return {"method": method, "placement": (rule, places or row["demonstrations"]),
            "demonstrations": None if timed else row["demonstrations"],
            "timesteps": (72 if timed else 200) * row["demonstrations"]}


def asked_again(row: Row) -> Row:
    """A side of a claim that is asked again."""
    usual = frozenset(("object", "target", "camera", "rotation")[: 4 if row["claim"] == 26 else 3])
    found = {"task": "assembly" if row["claim"] == 26 else "pick-place", "method": "move", "timesteps": 20_000,
             "law": "beta", "moving": usual}
    return found | {
        "static, 50,000": {"method": "static", "timesteps": 50_000, "law": "static", "moving": frozenset()},
        "uniform": {"law": "uniform"}, "constant": {"law": "constant"}, "without": {"moving": usual - {"rotation"}},
    }.get(row["variant"], {})


def length(row: Row) -> Row:
    return {"length": round(row["length"], 2)}


RATES = {
    "fig1_sparse": Rates("fig1_sparse", ("method",), ANYWHERE, "grid", "rgb grid"),
    "fig1_sparse_points": Rates("fig1_sparse", ("method",), ANYWHERE, "point", "rgb grid"),
    "fig1_sparse_hand": Rates("fig1_sparse", ("hand", "method"), {"group": "grid"}, "grid", "rgb grid"),
    "fig1_sparse_length": Rates("fig1_sparse", ("method",), {**ANYWHERE, "group": "own"}, "", "rgb grid", length),
    "few_demonstrations": Rates("few_demonstrations", ("method", "timesteps"), ANYWHERE, "grid", "rgb grid"),
    "few_demonstrations_points": Rates("few_demonstrations", ("method", "timesteps"), ANYWHERE, "point", "rgb grid"),
    "fig3_dense": Rates("fig3_dense", ("method",), {**ANYWHERE, "timesteps": 7000}, "", "rgb grid"),
    "fig3_dense_hand": Rates("fig3_dense", ("hand", "method"), {"timesteps": 7000}, "", "rgb grid"),
    "fig3_dense_budgets": Rates("fig3_dense", ("method", "timesteps"), ANYWHERE, "", "rgb grid"),
    "fig3_dense_near_budgets": Rates("fig3_dense", ("method", "timesteps"), NEAR, "", "rgb grid"),
    "fig5_circle": Rates("fig5_circle", ("method",), ANYWHERE, "where", "rgb grid"),
    "fig5_circle_points": Rates("fig5_circle", ("method",), ANYWHERE, "point", "rgb grid"),
    "fig5_circle_hand": Rates("fig5_circle", ("hand", "method"), {}, "where", "rgb grid"),
    "table1_spatial_factors": Rates("table1_spatial_factors", ("method", "factors")),
    "table2_main": Rates("table2_main", ("method", "task"), {"observation": "rgb"}),
    "table2_main_keypoints": Rates("table2_main", ("method", "task"), {"observation": "keypoints"}, noise="keypoints"),
    "generalization_rates": Rates("generalization", ("method", "task", "group")),
    "fig4_scaling": Rates("fig4_scaling", ("method", "task", "timesteps")),
    "fig6_dimensions": Rates("fig6_dimensions", ("task",), more=moving),
    "fig7_speed": Rates("fig7_speed", ("task",), more=speed),
    "fig_speed_law": Rates("fig_speed_law", ("law",)),
    "fig_mixture": Rates("fig_mixture", ("share",)),
    "fig_training_length": Rates("fig_training_length", ("method", "task"), more=length),
    "equal_demonstrations": Rates("equal_demonstrations", ("method",), more=budget),
    "fifty_demonstrations": Rates("fifty_demonstrations", ("task",), {"group": "grid"}, "grid", "rgb grid", arm),
    "decided": Rates("decided", (), more=asked_again),
    "decided_places": Rates("decided_places", ("method",), place="group", noise="rgb grid"),
    "fig_perception": Rates("fig_perception", ("method", "observation"), more=experiment),
    "fig_coverage": Rates("fig_coverage", ("task",), more=moving),
    "radius_cells": Rates("radius", ("method", "observation"), more=reached),
    "table_adc": Rates("table_adc", ("observation", "task", "jumping")),
    "keypoint_control": Rates("keypoint_control", ("method", "timesteps"), noise="keypoints"),
    "table_keypoint_control": Rates("table_keypoint_control", ("method", "task"), {"timesteps": 2500},
                                    noise="keypoints"),
    "table_keypoint_control_larger": Rates("table_keypoint_control", ("method", "task"), {"timesteps": 10_000},
                                           noise="keypoints"),
    "gap": Rates("gap", ("method",), {}, "", "rgb", setting),
}
NOT_AT_POINTS = ("fig_perception", "gap", "radius_cells")  # which tries grids alone where there are points, too


def rows_of(world: World, name: str) -> list[Row]:
    """The rows of a table that a notebook wrote, the notebook executed if it was not yet."""
    known = {**DIFFERENCES, **RATES}
    world.show(known[name].figure if name in known else name)
    return world.table(name).to_dict("records")


def cell(world: World, name: str, row: Row) -> np.ndarray:
    """The planted cell of a row of a table of rates."""
    rates = RATES[name]
    where = str(row.get("experiment", row.get("case", row.get("where"))))
    if name in NOT_AT_POINTS and "figure" in where:
        return world.cell(rates.figure, "grid", **rates.wanted(row))
    return rates.cell(world, row)[: 3 if row.get("claim") == 7 else None]  # whose side claim 25 has more seeds of


@functools.cache
def noise(world: World, kind: str) -> training_noise.TrainingNoise:
    """How much trainings differ: the law of all repeated ones like these."""
    seen, _, grid = kind.partition(" ")
    repeated: dict[str, dict[int, list[bool]]] = {}
    for spec in {spec for name in REPEATED for spec in world.specs[name] if spec.kind == "policy"}:
        if spec.observation == seen and (spec.evaluation.starts == "grid") == bool(grid):
            rows = world.results[spec.hash].rows
            like = repeated.setdefault(spec.model_copy(update={"seed": 0}).hash, {})
            like[spec.seed] = [row["success"] for row in rows]
    return training_noise.training_noise_of(
        np.array([*seeds.values()], float) for _, seeds in sorted(repeated.items()) if len(seeds) > 1)


@pytest.mark.parametrize("name", RATES)
def test_every_rate_of_a_table_is_what_was_planted_there(world, name):
    rows = rows_of(world, name)
    cells = [cell(world, name, row) for row in rows]
    assert rows, "no row"
    for row, planted in zip(rows, cells, strict=True):
        assert row["value"] == pytest.approx(planted.mean(), abs=ROUNDED), row
        expected = estimates.success_rate(planted, noise(world, RATES[name].law(row)))
        assert (row["low"], row["high"]) == pytest.approx((expected.low, expected.high), abs=ROUNDED), row
        if "seeds" in row:
            seeds = [float(each) for each in str(row["seeds"]).split()]
            assert seeds == pytest.approx(planted.mean(axis=1), abs=ROUNDED) and row["episodes"] == planted.size, row


@pytest.mark.parametrize("figure", sorted({rates.figure for rates in RATES.values()}))
def test_no_policy_of_a_figure_is_left_out_of_its_tables(world, figure):
    asked = {spec.hash for spec in world.specs[figure] if spec.kind == "policy"}
    used = {result.spec.hash for name, rates in RATES.items() if rates.figure == figure
            for row in rows_of(world, name) for result in world.found(figure, **rates.wanted(row))}
    assert used == asked


@pytest.mark.parametrize("name", RATES)
def test_no_two_columns_of_cells_are_alike(world, name):
    """Else they could be exchanged and no test would turn red: plant other rates."""
    assert not alike(world, name, rows_of(world, name))


def alike(world: World, name: str, rows: list[Row]) -> list[tuple[str, Any, Any]]:
    """Two values of a column, such as two methods, that have the same rates whatever the rest is."""
    keys = [key for key in (*RATES[name].columns, RATES[name].place, "moves", "part", "speed", "length", "equal", "arm",
                            "experiment", "case", "setting", "variant", "demonstrations") if key in rows[0]]
    keys += ["where"] * ("where" in rows[0] and "where" not in keys)
    cells = [({key: row[key] for key in keys}, cell(world, name, row).mean()) for row in rows]
    same: dict[tuple[str, Any, Any], list[bool]] = {}
    for place, (one, value) in enumerate(cells):
        for other, like in cells[:place]:
            if len(apart := [key for key in keys if one[key] != other[key]]) == 1:
                pair = tuple(sorted((one[apart[0]], other[apart[0]])))
                same.setdefault((apart[0], *pair), []).append(value == like)
    return [pair for pair, each in same.items() if all(each)]


# tables of differences -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Differences:
    """A table of differences: whose rates they are of, what is exchanged for the baseline, what Holm is over."""

    rates: str
    column: str = "method"  # that the baseline names; MOVE against it where it is the method
    holm: tuple[str, ...] = ("baseline",)
    paired: bool = True

    @property
    def figure(self) -> str:
        return RATES[self.rates].figure

    def cells(self, world: World, row: Row) -> tuple[np.ndarray, np.ndarray]:
        first = {**row, "method": "move"} if self.column == "method" else row
        other = {**row, self.column: row["baseline"]}
        if self.column == "law":
            other["method"] = first["method"] = "move"
        return cell(world, self.rates, first), cell(world, self.rates, other)


DIFFERENCES = {
    "fig1_sparse_difference": Differences("fig1_sparse_hand"),
    "few_demonstrations_differences": Differences("few_demonstrations"),
    "fig3_dense_difference": Differences("fig3_dense_hand"),
    "fig3_dense_budgets_difference": Differences("fig3_dense_budgets"),
    "fig3_dense_near_budgets_difference": Differences("fig3_dense_near_budgets"),
    "fig5_circle_differences": Differences("fig5_circle_hand", holm=("hand",)),
    "table1_spatial_factors_differences": Differences("table1_spatial_factors"),
    "table1_spatial_factors_lost": Differences("table1_spatial_factors", "factors", paired=False),
    "table2_main_differences": Differences("table2_main"),
    "table2_main_differences_keypoints": Differences("table2_main_keypoints"),
    "generalization_differences": Differences("generalization_rates"),
    "fig6_dimensions_steps": Differences("fig6_dimensions", "moves", ("task",)),
    "fig7_speed_ends": Differences("fig7_speed", "speed", ("task", "part")),
    "fig_mixture_gains": Differences("fig_mixture", "share", ()),
    "fig_speed_law_others": Differences("fig_speed_law", "law", ()),
    "equal_demonstrations_differences": Differences("equal_demonstrations"),
    "fig_training_length_differences": Differences("fig_training_length", holm=("length",)),
    "fifty_demonstrations_differences": Differences("fifty_demonstrations", "arm", ("task", "equal", "demonstrations")),
    "decided_differences": Differences("decided", "variant", ("claim",)),
    "fig_perception_differences_rgb": Differences("fig_perception"),
    "fig_perception_differences_keypoints": Differences("fig_perception"),
    "keypoint_control_differences": Differences("keypoint_control"),
    "table_keypoint_control_differences": Differences("table_keypoint_control"),
    "gap_leads": Differences("gap", holm=("case",)),
}


def compared_rows(world: World, name: str) -> list[Row]:
    """The rows of a table of differences, with what its name or its figure says of all of them."""
    more = {"generalization_differences": {"group": "moving"},
            "fig_perception_differences_rgb": {"observation": "rgb"},
            "fig_perception_differences_keypoints": {"observation": "keypoints"}}.get(name, {})
    return [{**row, **more} for row in rows_of(world, name)]


@pytest.mark.parametrize("name", DIFFERENCES)
def test_every_difference_is_the_first_cell_minus_the_second(world, name):
    table, rows = DIFFERENCES[name], compared_rows(world, name)
    assert rows, "no row"
    found: dict[tuple, list[tuple[Row, float]]] = {}
    for row in rows:
        one, other = table.cells(world, row)
        compare = estimates.difference if table.paired else estimates.unpaired_difference
        expected = compare(one, other, noise(world, RATES[table.rates].law(row)))
        assert row["difference"] == pytest.approx(one.mean() - other.mean(), abs=ROUNDED), row
        ends = (expected.low, expected.high, expected.p_value)
        assert (row["low"], row["high"], row["p"]) == pytest.approx(ends, abs=ROUNDED), row
        found.setdefault(tuple(row[key] for key in table.holm), []).append((row, expected.p_value))
    for group in found.values():
        assert [row["holm"] for row, _ in group] == pytest.approx(holm([p for _, p in group]), abs=ROUNDED)


def holm(p_values: list[float]) -> list[float]:
    """Each p times how many are not smaller, but no less than what the smaller ones come to, and at most 1."""
    order, least, adjusted = np.argsort(p_values), 0.0, [0.0] * len(p_values)
    for place, number in enumerate(order):
        least = max(least, min(1.0, (len(p_values) - place) * p_values[number]))
        adjusted[number] = least
    return adjusted


MEANS = {f"{name}_mean": name for name in ("table2_main_differences", "table2_main_differences_keypoints",
                                           "keypoint_control_differences", "table_keypoint_control_differences")}


@pytest.mark.parametrize("name", MEANS)
def test_a_mean_is_over_the_differences_of_its_own_table(world, name):
    table, rows = DIFFERENCES[MEANS[name]], compared_rows(world, MEANS[name])
    means = world.table(name).set_index("baseline")
    assert set(means.index) == {"static", "adc"}
    for baseline, mean in means.iterrows():
        pairs = [table.cells(world, row) for row in rows if row["baseline"] == baseline]
        expected = estimates.mean_difference(pairs, noise(world, RATES[table.rates].noise))
        assert mean["items"] == len(pairs)
        assert mean.difference == pytest.approx(np.mean([one.mean() - other.mean() for one, other in pairs]),
                                                abs=ROUNDED)
        assert (mean.low, mean.high) == pytest.approx((expected.low, expected.high), abs=ROUNDED)


@pytest.mark.parametrize(("name", "differences"), [
    ("table2_main_over_tasks", "table2_main_differences"),
    ("table2_main_over_tasks_keypoints", "table2_main_differences_keypoints"),
    ("table_keypoint_control_over_tasks", "table_keypoint_control_differences"),
])
def test_over_tasks_move_is_first_and_each_other_method_second(world, name, differences):
    rows, pairs_of = compared_rows(world, differences), DIFFERENCES[differences]
    for baseline, found in world.table(name).set_index("baseline").iterrows():
        pairs = [pairs_of.cells(world, row) for row in rows if row["baseline"] == baseline]
        assert found.to_dict() == pytest.approx(vars(over_tasks(pairs)), abs=ROUNDED)
        assert found.mean_difference == pytest.approx(
            np.mean([one.mean() - other.mean() for one, other in pairs]), abs=ROUNDED)


# tables of other kinds -----------------------------------------------------------------------------------------------


def curves(world: World, task: str, method: str) -> dict[int, np.ndarray]:
    sizes = {result.spec.collection.timesteps for result in world.found("fig4_scaling", task=task, method=method)}
    return {size: world.cell("fig4_scaling", task=task, method=method, timesteps=size) for size in sorted(sizes)}


def test_an_efficiency_is_statics_timesteps_over_moves_on_its_own_task(world):
    world.show("fig4_scaling")
    table = world.table("fig4_scaling_efficiency").set_index("task")
    assert set(table.index) == set(PAPER_TASKS)
    for task, row in table.iterrows():
        asked, static = min(20_000, get_task(task).timesteps), curves(world, task, "static")
        expected = data_efficiency(static, curves(world, task, "move"), asked, draws=1)
        assert row.timesteps == asked and row.ratio == pytest.approx(expected.ratio, rel=1e-3), task
        assert (row.least, row.most) == pytest.approx((min(static) / asked, max(static) / asked))
        assert row.low <= row.ratio <= row.high


def test_what_the_paper_calls_equal_is_move_at_its_budget_minus_static_at_the_other(world):
    world.show("fig4_scaling")
    for row in world.table("fig4_scaling_equal").itertuples():
        said = PAPER.query("experiment == 'fig4_scaling' and condition == 'equally good' and task == @row.task")
        sizes = said.set_index("method").value.astype(int)
        assert (row.move_timesteps, row.static_timesteps) == (sizes.move, sizes.static)
        one, other = (world.cell("fig4_scaling", task=row.task, method=name, timesteps=sizes[name])
                      for name in ("move", "static"))
        expected = estimates.difference(one, other, noise(world, "rgb"))
        assert row.difference == pytest.approx(one.mean() - other.mean(), abs=ROUNDED)
        assert (row.low, row.high) == pytest.approx((expected.low, expected.high), abs=ROUNDED)


def test_what_a_longer_training_changes_is_the_late_difference_minus_the_early_one(world):
    world.show("fig_training_length")
    table = world.table("fig_training_length_depends").set_index("task").difference
    changes = {}
    for task in ("pick-place", "push", "window-open"):
        late, early = (world.cell("fig_training_length", task=task, method="move", length=length).mean()
                       - world.cell("fig_training_length", task=task, method="static", length=length).mean()
                       for length in (3.0, 0.33))
        changes[task] = late - early
    assert table[list(changes)].to_dict() == pytest.approx(changes, abs=ROUNDED)
    assert table.drop(list(changes)).tolist() == pytest.approx([np.mean(list(changes.values()))], abs=ROUNDED)
    beyond = world.table("fig_training_length_beyond").set_index("task").difference
    for task in changes:
        late, usual = (world.cell("fig_training_length", task=task, method="move", length=length).mean()
                       - world.cell("fig_training_length", task=task, method="static", length=length).mean()
                       for length in (3.0, 1.0))
        assert beyond[task] == pytest.approx(late - usual, abs=ROUNDED)


def test_table_2_lays_ours_beside_the_papers_and_fewer_tasks_beside_their_own_mean(world):
    rates = pd.DataFrame(rows_of(world, "table2_main"))
    few = rates[rates.task.isin(PAPER_TASKS[:3])]
    means = table2_main._means({"": few}).set_index("method")
    assert means.paper.to_dict() == pytest.approx(few.groupby("method").paper.mean().to_dict())
    text = world.text("table2_main.tex")
    for task, own in rates.groupby("task"):
        line = next(line for line in text.splitlines() if line.startswith(f"{TITLES[task]} &"))
        cells, by_method = [each.strip() for each in line.split("&")][1:7], own.set_index("method")
        for number, method in enumerate(("static", "adc", "move")):
            ours, theirs = cells[2 * number:2 * number + 2]
            assert float(ours.split()[0]) == pytest.approx(100 * by_method.value[method], abs=0.051)
            assert float(theirs) == pytest.approx(100 * by_method.paper[method], abs=0.051)


def test_readings_of_adc_are_compared_and_averaged_over_the_tasks_that_have_them(world):
    rates = {(row["observation"], row["jumping"], row["task"]): row["value"] for row in rows_of(world, "table_adc")}
    for row in world.table("table_adc_means").itertuples():
        own = [value for (*which, _), value in rates.items() if which == [row.observation, row.jumping]]
        assert row.mean == pytest.approx(np.mean(own), abs=ROUNDED)
    for row in world.table("table_adc_differences").to_dict("records"):
        assert row["baseline"] == "as printed"
        pairs = [value - rates[seen, "as printed", task] for (seen, reading, task), value in rates.items()
                 if (seen, reading) == (row["observation"], row["jumping"])]
        assert row["items"] == len(pairs) and row["difference"] == pytest.approx(np.mean(pairs), abs=2 * ROUNDED)


def test_own_grasps_elsewhere_and_in_motion_stand_in_their_own_columns(world):
    rates = {(row["task"], row["method"], row["group"]): row["value"] for row in rows_of(world, "generalization_rates")}
    for row in world.table("generalization").itertuples():
        own, elsewhere, in_motion = (rates[row.task, row.method, group] for group in ("grasp", "random", "moving"))
        assert (row.own, row.elsewhere, row.in_motion) == pytest.approx((own, elsewhere, in_motion), abs=ROUNDED)
        assert row.lost == pytest.approx(own - elsewhere, abs=2 * ROUNDED)


def test_a_change_of_the_recipe_stands_beside_its_own_gain_loss_and_minutes(world):
    rows = rows_of(world, "table_recipe")
    changed = {"one noise level a window": "noise_draws", "spatial softmax starts flat": "softmax_gain",
               "encoder learns from all frames": "learning_frames", "32 channels": "cnn_width",
               "learning rate 1e-3": "learning_rate", "learning rate 3e-3": "learning_rate"}
    used = set()
    for row in rows:
        runs = world.found("table_recipe", timesteps=row["timesteps"])
        (chosen,) = (run for run in runs if not features(run.spec)["changed"])
        if row["change"].endswith("as long"):
            (run,) = (run for run in runs if features(run.spec)["length"] == pytest.approx(
                float(row["change"].split()[0]), abs=0.01))
        else:
            names = (changed[row["change"]],) if row["change"] in changed else ()
            like = [run for run in runs if tuple(name for name, _ in features(run.spec)["changed"]) == names]
            (run,) = [run for run in like if names != ("learning_rate",)
                      or f"{run.spec.training.learning_rate:.0e}".replace("e-0", "e-") in row["change"]]
        used.add(run.spec.hash)
        won, lost = (planted_successes(each.spec, False).mean() for each in (run, chosen))
        assert row["value"] == pytest.approx(won, abs=ROUNDED), row
        assert row["gain"] == pytest.approx(won - lost, abs=ROUNDED), row
        assert row["train_minutes"] == pytest.approx(run.seconds["train"] / 60, abs=ROUNDED)
        assert row["loss"] == pytest.approx(run.training["curve"][-1][1], abs=ROUNDED)
    assert used == {spec.hash for spec in world.specs["table_recipe"]}


@pytest.mark.parametrize("figure", ["equal_demonstrations", "few_demonstrations"])
def test_demonstrations_made_are_the_mean_of_the_seeds_of_their_own_cell(world, figure):
    world.show(figure)
    rows = world.table(f"{figure}_made").to_dict("records")
    assert len(rows) == len(rows_of(world, figure))
    for row in rows:
        made = [run.collection["demonstrations"] for run in world.found(figure, **RATES[figure].wanted(row))]
        assert row["demonstrations"] == pytest.approx(np.mean(made), abs=ROUNDED), row


@pytest.mark.parametrize(("name", "figure", "fixed"), [
    ("fig1_sparse_costs", "fig1_sparse", {}), ("fig3_dense_costs", "fig3_dense", {}),
    ("fig5_circle_costs", "fig5_circle", {}), ("table1_spatial_factors_costs", "table1_spatial_factors", {}),
    ("table2_main_costs", "table2_main", {"observation": "rgb"}),
])
def test_costs_are_the_median_minutes_of_a_methods_own_runs(world, name, figure, fixed):
    world.show(figure)
    for row in world.table(name).to_dict("records"):
        runs = world.found(figure, method=row["method"], timesteps=row["timesteps"], kind="policy", **fixed)
        assert row["runs"] == len(runs)
        for part in ("collect", "train", "evaluate"):
            median = np.median([run.seconds[part] for run in runs]) / 60
            assert row[part] == pytest.approx(median, abs=0.051), (row, part)


def collected(world: World, method: str, expert: str, task: str) -> tuple[float, ...]:
    """Share of attempts that succeeded, mean steps and jumps of those, and the standard error of the steps."""
    (run,) = world.found("table6_collection", method=method, expert=expert, task=task)
    success, steps = planted_successes(run.spec, world.turned), planted_steps(run.spec, world.turned)
    jumps = [row["jumps"] for row in run.rows if row["success"] and "jumps" in row]
    return success.mean(), steps[success].mean(), np.mean(jumps) if jumps else np.nan, stats.sem(steps[success])


def test_what_a_demonstration_costs_is_counted_for_each_task_method_and_expert(world):
    world.show("table6_collection")
    by_task = world.table("table6_collection_by_task")
    assert len(by_task) == 60
    for row in by_task.itertuples():
        assert (row.generation_rate, row.mean_steps, row.jumps, row.mean_steps_error) == pytest.approx(
            collected(world, row.method, row.expert, row.task), abs=ROUNDED, nan_ok=True), row
        kinder = (100 * row.generation_rate + 2) / 104
        assert row.generation_rate_error == pytest.approx((kinder * (1 - kinder) / 100) ** 0.5, abs=ROUNDED)
        assert row.low < row.generation_rate < row.high
    for row in world.table("table6_collection").itertuples():
        means = np.mean([collected(world, row.method, row.expert, task) for task in PAPER_TASKS], axis=0)
        assert (row.generation_rate, row.mean_steps, row.jumps) == pytest.approx(means[:3], abs=ROUNDED, nan_ok=True)


def test_table_5_counts_demonstrations_by_our_experts_own_lengths(world):
    world.show("table5_data_sizes")
    table = world.table("table5_data_sizes").set_index("task")
    for task in PAPER_TASKS:
        for method in ("static", "adc", "move"):
            _, steps, *_ = collected(world, method, "phase", task)
            assert table.loc[TITLES[task], f"{method} demonstrations"] == round(get_task(task).timesteps / steps)
    made = table["move demonstrations"].sum() / table["static demonstrations"].sum()
    assert f"MOVE makes {made:.2f} demonstrations for one of static" in here(world, "table5_data_sizes")
    theirs = PAPER.query("experiment == 'table5_data_sizes' and metric == 'timesteps'").value
    told = world.show("table5_data_sizes").replace("**", "")
    assert f"The paper gives {theirs.sum():,.0f} timesteps to 10 tasks" in told
    assert "the registry has the same number for 10 of 10" in told


def test_what_data_cover_stands_beside_the_success_of_the_same_data(world):
    for row in rows_of(world, "fig_coverage"):
        wanted = RATES["fig_coverage"].wanted(row)
        run = min(world.found("fig_coverage", **wanted), key=lambda each: each.spec.seed)
        seen, task = visited(run.spec.collection, False), get_task(row["task"])
        for part in ("object", "camera", *["target"] * task.has_target):
            assert row[part] == pytest.approx(coverage.visited_share(seen, task, part), abs=ROUNDED), row
        assert row["joint"] == pytest.approx(coverage.visited_joint_share(seen, task), abs=ROUNDED)


def tried(world: World, hand: str, observation: str = "rgb") -> distance.Tries:
    """Every place of figures 1, 3 and 5 for one start of the hand, and how far it is from what was seen."""
    parts = []
    for result in world.found("radius", hand=hand, group="grid", observation=observation):
        rows = pd.DataFrame(result.rows).query("group == 'grid'")
        seen = visited(result.spec.collection, False)[["object_x", "object_y"]].drop_duplicates().to_numpy(np.float32)
        apart = np.linalg.norm(rows[["object_x", "object_y"]].to_numpy()[:, None] - seen[None].astype(float), axis=2)
        figure = {"sparse": 1, "dense": 3, "circle": 5}[result.spec.collection.protocol]
        name = f"figure {figure}, {result.spec.method}"
        labels = (result.spec.hash, name, name, float(result.spec.method == "move"), 1.0)
        parts.append((apart.min(axis=1), rows.success.to_numpy(), *(np.full(len(rows), each) for each in labels)))
    return distance.Tries(*map(np.concatenate, zip(*parts, strict=True)))


@pytest.mark.parametrize(("setting", "hand"), [("hand anywhere", "anywhere"), ("hand within 3 cm", "within 3 cm"),
                                               ("hand in one place", "one place")])
def test_success_by_distance_is_fitted_to_what_was_planted_and_each_cell_predicted_by_the_others(world, setting, hand):
    """Distances are taken again place by place; the fit and the rule have tests of their own."""
    rows, tries = rows_of(world, "radius_cells"), tried(world, hand)
    held, curve = distance.held_out(tries), distance.fit(tries)
    mine = [row for row in rows if (row["setting"], row["observation"]) == (setting, "rgb")]
    assert len(mine) == len(held.cell) == 6
    for row in mine:
        place = list(held.cell).index(f"{row['where']}, {row['method']}")
        expected = held.predicted[place], held.without[place]
        assert (row["predicted"], row["without"]) == pytest.approx(expected, abs=3e-3)
        beyond = (curve.scaled(tries.apart[tries.cell == held.cell[place]]) > 1).mean()
        assert row["beyond"] == pytest.approx(beyond, abs=0.01)
    radii, leads = (table[(table.setting == setting) & (table.observation == "rgb")]
                    for table in (world.table("radius_radii"), world.table("radius_leads")))
    assert radii.radius.item() == pytest.approx(curve.radii[0], rel=0.02)
    leads = leads.set_index("compared").difference
    whole = tries.success[tries.move == 1].mean() - tries.success[tries.move == 0].mean()
    assert leads["all places"] == pytest.approx(whole, abs=ROUNDED)
    equal = motion_is_coverage.at_equal_distance(tries.success, tries.move, motion_is_coverage.strata(tries, curve))
    assert leads["equal distance"] == pytest.approx(equal, abs=0.02)


def test_success_by_distance_is_counted_in_centimetres_for_each_method(world):
    rows_of(world, "radius_cells")
    tries, binned = tried(world, "anywhere"), world.table("radius_distance")
    assert set(binned.method) == {"static", "move"}
    for row in binned.itertuples():
        there = (tries.move == (row.method == "move")) & (np.floor(100 * tries.apart) == np.floor(row.distance))
        assert row.episodes == there.sum() and row.value == pytest.approx(tries.success[there].mean(), abs=ROUNDED)


def test_what_distance_predicts_of_window_open_is_told_before_what_came(world):
    cells = pd.DataFrame(rows_of(world, "radius_cells")).query("where == 'window-open' and observation == 'rgb'")
    own = cells.set_index("method")
    gain, expected = (100 * (own[name].move - own[name].static) for name in ("value", "predicted"))
    found = re.search(r"Window-Open distance predicts a gain of ([+-]\d+); MOVE gains ([+-]\d+)", here(world, "radius"))
    assert [float(number) for number in found.groups()] == pytest.approx([expected, gain], abs=0.51)


def test_each_radius_stands_beside_its_factor_and_a_tasks_ceiling_is_its_experts(world):
    rows_of(world, "radius_cells")
    metres = ("object", "target", "hand")
    for (setting, _), own in world.table("radius_radii").groupby(["setting", "observation"], sort=False):
        assert own.factor.tolist() == (list(FACTORS) if setting == "ten tasks" else ["object"])
        assert own.unit.tolist() == ["m" if name in metres else "rad" for name in own.factor]
    for (setting, _), found in world.made["radius"].data.seen.items():
        for task in set(found.tries.group if setting == "ten tasks" else ()):
            (expert,) = world.found("radius", task=task, method="expert")
            rate = np.mean([row["success"] for row in expert.rows])
            assert set(found.tries.ceiling[found.tries.group == task]) == {rate} != {1.0}


def test_over_tasks_a_prediction_knows_nothing_of_its_own_task(world):
    cells = pd.DataFrame(rows_of(world, "radius_cells"))
    assert set(cells[cells.setting == "ten tasks"].observation) == {"rgb", "keypoints"}
    for _, rows in cells[cells.setting == "ten tasks"].groupby("observation"):
        assert len(rows) == 30
        for task, own in rows.groupby("where"):
            others = rows[rows["where"] != task].value.mean()
            assert own.without.to_numpy() == pytest.approx(others, abs=ROUNDED) and own.predicted.between(0, 1).all()


def test_a_claim_that_is_asked_again_is_named_as_its_difference_is_taken(world):
    world.show("decided")
    named = [text.get_text() for text in world.figures["decided"].axes[0].get_yticklabels()]
    table = world.table("decided_differences")
    assert len(table) == len(named) and set(named) == {
        f"{row.claim}: {row.variant} \N{MINUS SIGN} {row.baseline}" for row in table.itertuples()}
    ax, rows = world.figures["decided"].axes[0], {
        f"{row.claim}: {row.variant} \N{MINUS SIGN} {row.baseline}": row for row in table.itertuples()}
    for place, *numbers, _ in drawn(ax, across=True):
        row = rows.pop(tick(ax, place, across=True))
        assert numbers == pytest.approx([row.difference, row.low, row.high], abs=ROUNDED), row
    assert not rows
    assert min(spec.seed for spec in world.specs["decided"]) >= 10, "seeds of its own, not those that left it open"


def test_an_arms_factor_is_its_episodes_over_the_others_for_the_others_success(world):
    text, found = here(world, "fifty_demonstrations"), world.table("fifty_demonstrations_factors")
    assert set(zip(found.arm, found.other, strict=True)) == {
        ("5 places", "each its own, random"), ("MOVE, 5 places", "5 places"), ("MOVE, random", "5 places"),
        ("MOVE, 5 places", "each its own, random"), ("MOVE, random", "each its own, random")}
    for row in found.itertuples():
        named = {"task": row.task, "equal": row.equal}
        own, other = ({count: cell(world, "fifty_demonstrations", {**named, "demonstrations": count, "arm": name})
                       for count in (25, 50, 100)} for name in (row.arm, row.other))
        expected = data_efficiency(own, other, 50, draws=1)
        assert row.task == "pick-place" and row.episodes == 50, row
        assert row.ratio == pytest.approx(expected.ratio, rel=1e-3) and row.low <= row.ratio <= row.high, row
        asked = row.equal == "demonstrations" and row.other == "each its own, random"
        _, _, told = text.partition("times as many episodes as 50 random places for the same success:")
        assert not asked or f"{row.arm} {row.text}" in told, row


def test_the_arms_of_another_task_stand_in_their_order_each_in_its_methods_colour(world):
    rates = pd.DataFrame(rows_of(world, "fifty_demonstrations")).query("task == 'push' and equal == 'demonstrations'")
    (ax,) = panels(world, "fifty_demonstrations", "Push")
    own = rates.set_index("arm").loc[list(ARMS)]
    assert [mark[1:] for mark in drawn(ax)] == [
        (*(pytest.approx(each, abs=2 * ROUNDED) for each in (row.value, row.low, row.high)), COLOURS[row.method])
        for row in own.itertuples()]
    before = world.table("fifty_demonstrations_predicted").query("equal == 'demonstrations'").set_index("arm")
    dashes = {int(x): y for line in ax.get_lines() if line.get_marker() == "_" and to_hex(line.get_color()) == "#000000"
              for x, y in line.get_xydata()}
    assert dashes == pytest.approx({place: before.predicted[name] for place, name in enumerate(ARMS)}, abs=ROUNDED)


def test_what_was_predicted_of_placements_stands_beside_what_was_planted_there(world):
    text, rates = here(world, "fifty_demonstrations"), world.table("fifty_demonstrations")
    told = world.table("fifty_demonstrations_predicted")
    assert set(told.task) == {"push"} and len(told) == 14
    for row in told.itertuples():
        (own,) = rates[(rates.task == row.task) & (rates.equal == row.equal) & (rates.arm == row.arm)
                       & (rates.demonstrations == row.demonstrations)].itertuples()
        assert (row.value, row.low, row.high) == pytest.approx((own.value, own.low, own.high), abs=ROUNDED)
        runs = world.found("fifty_demonstrations", task="push", **arm(row._asdict()))
        spreads = [np.hypot(*np.std(run.collection["grasp_points"], axis=0)) for run in runs]
        assert row.spread == pytest.approx(np.mean(spreads), abs=ROUNDED) and len(runs) == 3
    correlations = {(row.equal, row.score): row.correlation
                    for row in world.table("fifty_demonstrations_ranks").itertuples()}
    for equal, arms in told.groupby("equal"):
        for score, column in (("distance to what was seen", "predicted"), ("spread of grasps", "spread")):
            found = np.corrcoef(arms[[column, "value"]].rank().T)[0, 1]
            assert correlations.pop((equal, score)) == pytest.approx(found, abs=ROUNDED)
    assert not correlations
    found = np.corrcoef(told[told.equal == "demonstrations"][["predicted", "value"]].rank().T)[0, 1]
    assert f"Push: order {'' if found >= 0.8 else 'not '}as predicted (Spearman {found:.2f})" in text


def test_scores_are_ranked_against_the_rates_of_their_own_cells(world):
    cells, ranks = pd.DataFrame(rows_of(world, "radius_cells")), world.table("radius_ranks")
    assert len(ranks) == 2 * len(cells.groupby(["setting", "observation"]))
    columns = {"distance to what was seen": "predicted", "spread of places": "spread"}
    for row in ranks.itertuples():
        own = cells[(cells.setting == row.setting) & (cells.observation == row.observation)]
        ranked = own[["value", columns[row.score]]].rank()
        assert row.correlation == pytest.approx(np.corrcoef(ranked.T)[0, 1], abs=0.02) and row.cells == len(own)
        assert row.low <= row.correlation <= row.high or np.isnan(row.low) and np.isnan(row.high)
    run = world.found("radius", hand="one place", method="static", observation="rgb")[0]
    seen = visited(run.spec.collection, False).drop(columns="phase").drop_duplicates()[["object_x", "object_y"]]
    figure = {"sparse": "figure 1", "dense": "figure 3", "circle": "figure 5"}[run.spec.collection.protocol]
    (own,) = cells[(cells.setting == "hand in one place") & (cells.method == "static")
                   & (cells["where"] == figure)].to_dict("records")
    assert own["spread"] == pytest.approx(np.sqrt(seen.var(ddof=0).sum()), abs=ROUNDED)


def test_the_rules_verdict_is_what_its_numbers_say_and_is_told(world):
    text = here(world, "radius")
    for (setting, observation), rows in world.table("radius").groupby(["setting", "observation"]):
        least = np.where(rows.finding.str.startswith("MOVE minus"), -rows.limit, -np.inf)
        answers = ["yes" if low > floor and high < limit else "no" if low >= limit or high <= floor else "open"
                   for low, high, floor, limit in zip(rows.low, rows.high, least, rows.limit, strict=True)]
        assert answers == rows.answer.tolist()
        verdict = "falls" if "no" in answers else "holds" if set(answers) == {"yes"} else "undecided"
        assert set(rows.verdict) == {verdict}
        if observation == "rgb" and setting in ("hand anywhere", "ten tasks"):
            assert f"{setting} {verdict}" in text


@pytest.mark.parametrize("name", ["table2_main", "table2_main_keypoints", "fig4_scaling"])
def test_a_level_is_where_a_rate_lies_from_a_goal_blind_expert_to_the_expert(world, name):
    known = 0
    for row in rows_of(world, name):
        controls = [world.found(RATES[name].figure, task=row["task"], method=agent)
                    for agent in ("goal-blind", "expert")]
        if not all(controls):
            assert np.isnan(row["level"]), row
            continue
        blind, expert = (np.mean([each["success"] for each in run.rows]) for (run,) in controls)
        assert row["level"] == pytest.approx((row["value"] - blind) / (expert - blind), abs=3 * ROUNDED), row
        known += 1
    assert known


def test_a_settings_effect_is_its_rate_minus_the_protocols_at_the_same_configurations(world):
    rows = rows_of(world, "gap")
    cells = [cell(world, "gap", row) for row in rows]
    for row, one in zip(rows, cells, strict=True):
        if row["setting"] == "the package's protocol":
            assert np.isnan(row["effect"])
            continue
        other = cell(world, "gap", {**row, "setting": "the package's protocol"})
        compare = estimates.unpaired_difference if row["setting"] in ELSEWHERE else estimates.difference
        other = other if row["setting"] in ELSEWHERE else other[:, :one.shape[1]]
        expected = compare(one, other, noise(world, RATES["gap"].law(row)))
        assert row["effect"] == pytest.approx(one.mean() - other.mean(), abs=ROUNDED), row
        ends = (0, 0) if np.array_equal(one, other) else (expected.low, expected.high)
        assert (row["effect_low"], row["effect_high"]) == pytest.approx(ends, abs=ROUNDED), row


def test_the_steps_of_the_gap_lead_from_the_rate_here_to_the_papers(world):
    rates = {(row["case"], row["method"], row["setting"]): row for row in rows_of(world, "gap")}
    theirs = {**{("figure 1", row.method): row.value for row in
                 PAPER.query("experiment == 'fig1_sparse' and metric == 'success'").itertuples()},
              **{(row.task, row.method): row.value for row in
                 PAPER.query("experiment == 'table2_main' and metric == 'success'").itertuples()}}
    steps = world.table("gap_steps")
    for (case, method), group in steps.groupby(["case", "method"], sort=False):
        level = rates[case, method, "the package's protocol"]["value"]
        together = rates[case, method, "all of them together"]["value"]
        lengths = group.step.str.endswith(" times the steps")
        for step in group[lengths].itertuples():  # beside the way to the paper
            effect = rates[case, method, step.step]
            assert (step.start, step.change, step.low, step.high) == pytest.approx(
                (level, effect["effect"], effect["effect_low"], effect["effect_high"]), abs=ROUNDED)
        for step in group[~lengths].itertuples():
            assert step.start == pytest.approx(level, abs=9 * ROUNDED), step
            if step.step == "more together than alone":
                assert step.change == pytest.approx(together - level, abs=9 * ROUNDED)
            elif step.step == "not explained":
                assert step.change == pytest.approx(theirs[case, method] - together, abs=2 * ROUNDED)
            else:
                effect = rates[case, method, step.step]
                assert (step.change, step.low, step.high) == pytest.approx(
                    (effect["effect"], effect["effect_low"], effect["effect_high"]), abs=ROUNDED)
            level += step.change
        assert level == pytest.approx(theirs[case, method], abs=9 * ROUNDED), (case, method)
    assert {row["setting"] for row in rates.values()} == {*AUTHORS, "all of them together"}
    for lead in world.table("gap_leads").itertuples():
        assert lead.paper == pytest.approx(theirs[lead.case, "move"] - theirs[lead.case, "static"])


@pytest.mark.parametrize(("table", "task_in", "method_in", "experiment", "condition"), [
    ("fig1_sparse", None, "method", "fig1_sparse", None), ("fig3_dense", None, "method", "fig3_dense", None),
    ("fig5_circle", None, "method", "fig5_circle", "where"),
    ("table1_spatial_factors", None, "method", "table1_spatial_factors", "factors"),
    ("table2_main", "task", "method", "table2_main", None),
])
def test_the_papers_number_beside_a_rate_is_the_papers_for_that_cell(world, table, task_in, method_in, experiment,
                                                                     condition):
    theirs = PAPER[(PAPER.experiment == experiment) & (PAPER.metric == "success")]
    seen = 0
    for row in rows_of(world, table):
        found = theirs[theirs.method == row[method_in]]
        found = found[found.task == row[task_in]] if task_in else found
        found = found[found.condition == row[condition]] if condition else found
        assert row["paper"] == pytest.approx(found.value.iloc[0] if len(found) else np.nan, nan_ok=True), row
        seen += len(found)
    assert seen == len(theirs)


@pytest.mark.parametrize(("name", "rates"), [("table2_main", "table2_main"),
                                             ("table_keypoint_control", "table_keypoint_control")])
def test_the_printed_table_has_each_tasks_methods_in_order_and_its_ceiling_and_floor(world, name, rates):
    rows = {(row["task"], row["method"]): row["value"] for row in rows_of(world, rates)}
    lines = {line.split("&")[0].strip(): line.split("&")[1:] for line in world.text(f"{name}.tex").splitlines()
             if "&" in line}
    for task in PAPER_TASKS:
        cells = lines[TITLES[task]]
        places = [next(place for place, text in enumerate(cells) if f"{100 * rows[task, method]:.1f} [" in text)
                  for method in ("static", "adc", "move")]
        assert places == sorted(places) and len(set(places)) == 3
        controls = [f"{100 * world.cell(name, task=task, method=agent).mean():.1f}"
                    for agent in ("expert", "goal-blind") if world.found(name, task=task, method=agent)]
        assert [text.strip(" \\") for text in cells[places[-1] + 1:] if text.strip(" \\") in controls] == controls


# marks ---------------------------------------------------------------------------------------------------------------

Mark = tuple[float, float, float, float, str]  # place, value, low, high, colour


def drawn(ax: Axes, across: bool = False) -> list[Mark]:
    """Every mark with an interval, by its place: bars and points that go up, or with `across` those to the right."""
    bars = {round(bar.get_x() + bar.get_width() / 2, 6): to_hex(bar.get_facecolor()) for bar in ax.patches
            if isinstance(bar, Rectangle)}
    found: list[Mark] = []
    for container in ax.containers:
        if not isinstance(container, ErrorbarContainer) or container[0] is None:
            continue
        data, _, (lines,) = container
        places, values = (data.get_ydata(), data.get_xdata()) if across else (data.get_xdata(), data.get_ydata())
        for place, value, segment in zip(np.atleast_1d(places), np.atleast_1d(values), lines.get_segments(),
                                         strict=False):
            if np.isfinite(value):
                low, high = segment[:, 0 if across else 1]
                found.append((float(place), float(value), float(low), float(high),
                              bars.get(round(float(place), 6), to_hex(data.get_color()))))
    return sorted(found)


def tick(ax: Axes, place: float, across: bool = False) -> str:
    """What the axis says at the place next to this one, in one line; a number is a number of the axis itself."""
    axis = ax.yaxis if across else ax.xaxis
    places = axis.get_ticklocs()
    labels = dict(zip(places, axis.get_major_formatter().format_ticks(places), strict=True))
    nearest = min(labels, key=lambda each: abs(each - place))
    return labels[nearest].replace("-\n", "-").replace("\n", " ").replace("  ", " ")


def panels(world: World, figure: str, word: str = "") -> list[Axes]:
    """The panels of a figure whose title has that word."""
    return [ax for ax in world.figures[figure].axes if word in ax.get_title(loc="left") + ax.get_title()]


@dataclass(frozen=True)
class Marks:
    """A panel: the word in its title, whose rows it shows, and in which columns its ticks are told apart."""

    figure: str
    table: str
    word: str = ""
    only: Callable[[Row], bool] = lambda row: True
    ticks: Callable[[Row], str | float] | None = None  # what the axis says under a row
    columns: tuple[str, str, str] = ("value", "low", "high")
    across: bool = False
    colour: Callable[[Row], str | None] = lambda row: COLOURS[row["method"]]


def title(row: Row) -> str:
    return TITLES[row["task"]]


def of_task(task: str) -> Callable[[Row], bool]:
    return lambda row: row["task"] == task


def moved(task: str, part: str) -> Callable[[Row], bool]:
    return lambda row: (row["task"], row["part"]) == (task, part)


HANDS = {"anywhere": "any-where", "within 3 cm": "within 3 cm", "one place": "one place"}
LESS = {"object": "object", "object+target": "+ target", "all": "+ camera"}
TRIED = {"grasp": "at its own grasps", "random": "elsewhere", "moving": "elsewhere, in motion"}
READINGS = {"as printed": "#999999", "mended": "#56b4e9", "periodic": "#cc79a7"}
DIFFERENCE: dict[str, Any] = {"columns": ("difference", "low", "high"), "across": True,
                              "colour": lambda row: {"static": "#000000", "adc": "#777777"}[row["baseline"]]}
MARKS = [
    Marks("fig1_sparse", "fig1_sparse_hand", "whole", ticks=lambda row: HANDS[row["hand"]]),
    Marks("few_demonstrations", "few_demonstrations_points", "points", ticks=lambda row: row["timesteps"]),
    Marks("few_demonstrations", "few_demonstrations", "space", ticks=lambda row: row["timesteps"]),
    Marks("fig3_dense", "fig3_dense_hand", "hand", ticks=lambda row: HANDS[row["hand"]]),
    Marks("fig3_dense", "fig3_dense_budgets", "budget", ticks=lambda row: row["timesteps"]),
    *[Marks("fig5_circle", "fig5_circle_hand", where, lambda row, where=where: row["where"] == where,
            lambda row: HANDS[row["hand"]]) for where in ("inside", "outside")],
    Marks("table1_spatial_factors", "table1_spatial_factors", "success", ticks=lambda row: LESS[row["factors"]]),
    Marks("table1_spatial_factors", "table1_spatial_factors_differences", "MOVE",
          ticks=lambda row: LESS[row["factors"]], **DIFFERENCE),
    Marks("table2_main", "table2_main", "from pixels", ticks=title),
    Marks("table2_main", "table2_main_keypoints", "from keypoints", ticks=title),
    Marks("table2_main", "table2_main_differences", "MOVE", ticks=title, **DIFFERENCE),
    Marks("table2_main", "table2_main_differences_mean", "MOVE", ticks=lambda row: "mean of 10", **DIFFERENCE),
    *[Marks("generalization", "generalization_rates", title({"task": task}), of_task(task),
            lambda row: TRIED[row["group"]]) for task in ("pick-place", "push", "window-open")],
    *[Marks("fig4_scaling", "fig4_scaling", title({"task": task}), of_task(task), lambda row: row["timesteps"])
      for task in PAPER_TASKS],
    *[Marks("fig6_dimensions", "fig6_dimensions", title({"task": task}), of_task(task), lambda row: row["moves"])
      for task in ("pick-place", "assembly")],
    *[Marks("fig7_speed", "fig7_speed", f"{title({'task': task})}, {part}", moved(task, part), lambda row: row["speed"])
      for task, part in (("pick-place", "object"), ("pick-place", "target"), ("pick-place", "camera"),
                         ("assembly", "object"), ("assembly", "target"))],
    Marks("fig_speed_law", "fig_speed_law", ticks=lambda row: row["law"]),
    Marks("fig_mixture", "fig_mixture", ticks=lambda row: f"{100 * row['share']:.0f}"),
    *[Marks("fig_training_length", "fig_training_length", title({"task": task}), of_task(task),
            lambda row: row["length"]) for task in ("pick-place", "push", "window-open")],
    Marks("equal_demonstrations", "equal_demonstrations", ticks=lambda row: row["equal"]),
    *[Marks("fifty_demonstrations", "fifty_demonstrations", word, lambda row, equal=equal: (
        row["task"], row["equal"]) == ("pick-place", equal), lambda row: row["demonstrations"])
      for word, equal in (("Pick-Place, equal demonstrations", "demonstrations"), ("equal timesteps", "timesteps"))],
    *[Marks("fig_perception", "fig_perception", word, lambda row, seen=seen: row["observation"] == seen,
            lambda row: row["experiment"].replace(", ", " ").replace("+", " + "))
      for seen, word in (("rgb", "from pixels"), ("keypoints", "from keypoints"))],
    *[Marks("table_adc", "table_adc", word, lambda row, seen=seen: row["observation"] == seen, title,
            colour=lambda row: READINGS[row["jumping"]])
      for seen, word in (("rgb", "from pixels"), ("keypoints", "from keypoints"))],
    Marks("keypoint_control", "keypoint_control", ticks=lambda row: row["timesteps"]),
    Marks("table_keypoint_control", "table_keypoint_control", ticks=title),
    *[Marks("table_recipe", "table_recipe", word, lambda row, size=size: row["timesteps"] == size,
            lambda row: row["change"], across=True, colour=lambda row: None)
      for word, size in (("7k", 7000), ("20k", 20_000))],
]


@pytest.mark.parametrize("marks", MARKS, ids=lambda marks: f"{marks.table}-{marks.word}".replace(" ", "-"))
def test_every_mark_and_its_interval_is_its_rows_in_its_methods_colour(world, marks):
    world.show(marks.figure)
    rows = [row for row in world.table(marks.table).to_dict("records") if marks.only(row)]
    assert rows
    for ax in (found := panels(world, marks.figure, marks.word)):
        there = drawn(ax, marks.across)
        if problem := _differs(ax, there, rows, marks):
            continue
        return
    pytest.fail(f"{len(found)} panels, the last: {problem if found else 'none'}")


def _differs(ax: Axes, there: list[Mark], rows: list[Row], marks: Marks) -> str:
    """What a panel lacks of its rows, or draws besides; differences stand over their means in one panel."""
    left = list(there)
    for row in rows:
        numbers, colour, wanted = [row[name] for name in marks.columns], marks.colour(row), marks.ticks(row)
        like = [mark for mark in left if np.allclose(mark[1:4], numbers, rtol=0, atol=2 * ROUNDED)
                and colour in (None, mark[4]) and _stands_at(ax, mark[0], wanted, marks.across)]
        if not like:
            return f"no mark of {row}; drawn are {left}"
        left.remove(like[0])
    return "" if not left or marks.table.endswith("_mean") or f"{marks.table}_mean" in MEANS else f"besides: {left}"


def _stands_at(ax: Axes, place: float, wanted: str | float, across: bool) -> bool:
    if isinstance(wanted, str):
        label = tick(ax, place, across)
        return wanted == label or (len(label) > 0 and label.endswith(wanted))
    low, high = ax.get_xlim()
    near = abs(place - wanted) < 0.04 * (high - low)
    return abs(np.log(place / wanted)) < 0.15 if ax.get_xscale() == "log" else near


@pytest.mark.parametrize(("figure", "group"), [("fig1_sparse", {}), ("fig3_dense", {"timesteps": 7000}),
                                               ("fig5_circle", {})])
@pytest.mark.parametrize("method", ["static", "move"])
def test_a_map_shows_each_place_of_its_own_method(world, figure, group, method):
    world.show(figure)
    (ax,) = panels(world, figure, NAMES[method])
    (mesh,) = (part for part in ax.collections if isinstance(part, QuadMesh))
    runs = world.found(figure, method=method, **{**ANYWHERE, **group})
    rows = pd.concat([pd.DataFrame(run.rows) for run in runs])
    shares = rows[rows.group == "grid"].groupby(["object_y", "object_x"]).success.mean().unstack()
    assert np.asarray(mesh.get_array()).reshape(shares.shape) == pytest.approx(shares.to_numpy())
    points = rows[rows.group == "point"].groupby(["object_x", "object_y"]).success.mean()
    dots = [part for part in ax.collections if isinstance(part, PathCollection) and part.get_array() is not None]
    coloured = {tuple(offset): value for part in dots for offset, value in
                zip(part.get_offsets().round(3).tolist(), np.asarray(part.get_array(), float), strict=True)}
    assert coloured == pytest.approx({(round(100 * x, 3), round(100 * y, 3)): value
                                      for (x, y), value in points.items()})
    if figure == "fig3_dense":
        grasped = sorted(tuple(np.round(100 * np.array(point), 3)) for run in runs
                         for point in run.collection["grasp_points"])
        over = [sorted(map(tuple, part.get_offsets().round(3).tolist())) for part in ax.collections
                if isinstance(part, PathCollection) and len(part.get_offsets()) == len(grasped)]
        assert grasped in over


def test_static_is_a_level_in_its_colour_in_a_band_that_is_its_interval_over_every_speed_of_its_task(world):
    rows = [row for row in rows_of(world, "fig7_speed") if row["part"] == "nothing"]
    for row in rows:
        for ax in panels(world, "fig7_speed", f"{TITLES[row['task']]}, "):
            levels = [line for line in ax.get_lines() if line.get_linestyle() == "--"]
            if drawn(ax):
                assert [float(line.get_ydata()[0]) for line in levels] == pytest.approx([row["value"]], abs=ROUNDED)
                (band,) = ax.patches
                ends = band.get_y(), band.get_y() + band.get_height()
                assert ends == pytest.approx((row["low"], row["high"]), abs=ROUNDED)
                assert {to_hex(levels[0].get_color()), to_hex(band.get_facecolor())} == {COLOURS["static"]}


def test_ceiling_and_floor_stand_over_each_task_and_over_the_budgets(world):
    for figure, words in (("table2_main", ("from pixels", "from keypoints")), ("table_keypoint_control", ("",))):
        world.show(figure)
        for word in words:
            (ax, *_) = [ax for ax in panels(world, figure, word)
                        if drawn(ax) and "MOVE" not in ax.get_title(loc="left")]
            found = {(line.get_label(), round(float(segment[:, 0].mean()))): float(segment[0, 1])
                     for line in ax.collections if "expert" in str(line.get_label())
                     for segment in line.get_segments() if np.shape(segment) == (2, 2) and np.isfinite(segment).all()}
            for place, task in enumerate(PAPER_TASKS):
                for agent, label in (("expert", "expert"), ("goal-blind", "goal-blind expert")):
                    if world.found(figure, task=task, method=agent):
                        expected = world.cell(figure, task=task, method=agent).mean()
                        assert found[label, place] == pytest.approx(expected), (word, task, agent)
    world.show("keypoint_control")
    (ax,) = panels(world, "keypoint_control", "Pick-Place")
    levels = sorted(float(line.get_ydata()[0]) for line in ax.get_lines() if line.get_linestyle() == "--")
    assert levels == pytest.approx(sorted(world.cell("keypoint_control", method=agent).mean()
                                          for agent in ("expert", "goal-blind")))


@pytest.mark.parametrize("table", ["fig4_scaling", "generalization_rates", "table_adc", "fig_training_length"])
def test_open_are_the_points_of_a_single_training_and_no_others(world, table):
    """Whose interval knows of trainings what like cells tell alone; in their methods' markers."""
    rows = rows_of(world, table)
    lines = [line for ax in world.figures[RATES[table].figure].axes for line in ax.get_lines()
             if line.get_label() == "_pooled" and to_hex(line.get_mfc()) == "#ffffff"]
    found = [(line.get_marker(), float(y)) for line in lines for y in line.get_ydata() if np.isfinite(y)]
    markers = {"static": "o", "adc": "s", "move": "^"}
    expected = [(markers[row.get("method", "adc")], row["value"]) for row in rows
                if len(str(row["seeds"]).split()) == 1]
    assert [each[0] for each in sorted(found)] == [each[0] for each in sorted(expected)]
    assert [each[1] for each in sorted(found)] == pytest.approx([each[1] for each in sorted(expected)], abs=ROUNDED)


@pytest.mark.parametrize("place", ["world", "turned"])
def test_the_map_of_the_difference_is_moves_minus_statics(place, request):
    there = request.getfixturevalue(place)
    there.show("fig1_sparse")
    (ax,) = panels(there, "fig1_sparse", "b \u2212 a")
    (mesh,) = (part for part in ax.collections if isinstance(part, QuadMesh))
    shares = {}
    for method in ("static", "move"):
        rows = pd.concat([pd.DataFrame(run.rows) for run in there.found("fig1_sparse", method=method, **ANYWHERE)])
        shares[method] = rows[rows.group == "grid"].groupby(["object_y", "object_x"]).success.mean().unstack()
    change = (shares["move"] - shares["static"]).to_numpy()
    assert np.asarray(mesh.get_array()).reshape(change.shape) == pytest.approx(change)
    assert (change.mean() > 0) == (place == "world")


def test_a_gain_and_its_minutes_stand_on_the_line_of_their_change(world):
    rows = rows_of(world, "table_recipe")
    for ax, size in zip(panels(world, "table_recipe", "gain"), (7000, 20_000), strict=True):
        here = [row for row in rows if row["timesteps"] == size]
        assert [mark[1] for mark in drawn(ax, across=True)] == pytest.approx([row["gain"] for row in here], abs=ROUNDED)
        assert [text.get_text().removesuffix(" min") for text in ax.texts] == [
            "training", *(f"{row['train_minutes']:.1f}" for row in here)]


def test_success_stands_over_what_the_same_data_cover(world):
    rows = rows_of(world, "fig_coverage")
    for word, column in (("object", "object"), ("camera", "camera"), ("both", "joint")):
        (ax,) = panels(world, "fig_coverage", word)
        found = sorted((to_hex(line.get_color()), round(float(x), 3), round(float(y), 3)) for line in ax.get_lines()
                       if line.get_marker() in ("o", "s", "^") for x, y in zip(line.get_xdata(), line.get_ydata(),
                                                                          strict=True))
        methods = {"nothing": "static", "jumps": "adc"}
        expected = sorted((COLOURS[methods.get(row["moves"], "move")], round(row[column], 3), round(row["value"], 3))
                          for row in rows)
        assert [one[0] for one in found] == [one[0] for one in expected]
        assert np.array([one[1:] for one in found]) == pytest.approx(np.array([one[1:] for one in expected]),
                                                                     abs=0.0011)


def test_cells_stand_over_their_prediction_and_leads_on_their_line(world):
    rows = pd.DataFrame(rows_of(world, "radius_cells"))
    for word, setting in (("each cell", "hand anywhere"), ("each from", "ten tasks")):
        (ax,) = panels(world, "radius", word)
        expected = sorted((row.predicted, row.value, row.low, row.high, COLOURS[row.method])
                          for row in rows[rows.setting == setting].itertuples())
        for mark, wanted in zip(drawn(ax), expected, strict=True):
            assert mark[:4] == pytest.approx(wanted[:4], abs=ROUNDED) and mark[4] == wanted[4]
        hollow = [place for bars in ax.containers if to_hex(bars[0].get_mfc()) == "#ffffff"
                  for place in bars[0].get_xdata()]
        from_keypoints = rows[(rows.setting == setting) & (rows.observation == "keypoints")]
        assert sorted(hollow) == pytest.approx(sorted(from_keypoints.predicted), abs=ROUNDED) and hollow
        (band,) = (part for part in ax.collections if isinstance(part, FillBetweenPolyCollection))
        off = np.diff(band.get_paths()[0].vertices)
        assert np.abs(off) == pytest.approx(0.08)
    (ax,) = panels(world, "radius", "MOVE minus")
    (band,) = ax.patches
    assert (band.get_x(), band.get_width()) == pytest.approx((-0.1, 0.2))
    leads = world.table("radius_leads")
    for compared, colour in (("all places", GREY), ("equal distance", "#000000")):
        marks = [mark for mark in drawn(ax, across=True) if mark[4] == colour]
        own = leads[leads.compared == compared]
        assert [mark[1:4] for mark in marks] == [pytest.approx((row.difference, row.low, row.high), abs=ROUNDED)
                                                 for row in own.itertuples()]
        words = {"rgb": "pixels", "keypoints": "keypoints"}
        assert [tick(ax, mark[0], across=True) for mark in marks] == [
            f"{row.setting}, {words[row.observation]}" for row in own.itertuples()]


def test_success_falls_along_the_fitted_curve_and_half_of_it_is_left_at_the_radius(world):
    rows_of(world, "radius_cells")
    (ax,) = panels(world, "radius", "hand anywhere")
    (row,) = world.table("radius_radii").query("setting == 'hand anywhere' and observation == 'rgb'").itertuples()
    curve = next(line for line in ax.get_lines() if to_hex(line.get_color()) == "#000000")
    x, y = curve.get_data()
    assert y == pytest.approx(row.top / (1 + (x / 100 / row.radius) ** row.steepness), abs=3e-3)
    (dashed,) = (line for line in ax.get_lines() if line.get_linestyle() == "--")
    assert dashed.get_xdata()[0] == pytest.approx(100 * row.radius, abs=0.01)
    (band,) = ax.patches
    ends = band.get_x(), min(band.get_x() + band.get_width(), x[-1])
    assert ends == pytest.approx((100 * row.low, min(100 * row.high, x[-1])), abs=0.01)
    binned, marks = world.table("radius_distance"), drawn(ax)
    assert len(marks) == len(binned)
    for method, rows in binned.groupby("method"):
        found = np.array([mark[:4] for mark in marks if mark[4] == COLOURS[method]])
        assert found == pytest.approx(rows[["distance", "value", "low", "high"]].to_numpy(), abs=0.001)


def test_costs_stand_over_their_method_one_bar_an_expert(world):
    world.show("table6_collection")
    means = world.table("table6_collection")
    for word, column in (("length", "mean_steps"), ("rate", "generation_rate")):
        (ax,) = panels(world, "table6_collection", word)
        bars = [(to_hex(bar.get_facecolor()), tick(ax, bar.get_x() + bar.get_width() / 2), float(bar.get_height()))
                for bar in sorted(ax.patches, key=lambda bar: bar.get_x())]
        for method in ("static", "adc", "move"):
            own = [height for colour, name, height in bars if (colour, name) == (COLOURS[method], NAMES[method])]
            expected = means[means.method == method].set_index("expert")[column]
            assert own == pytest.approx([expected["phase"], expected["metaworld"]], abs=ROUNDED)
        strengths = [bar.get_alpha() for bar in sorted(ax.patches, key=lambda bar: bar.get_x())]
        (legend,) = world.figures["table6_collection"].legends
        shown = {text.get_text(): handle.get_alpha() for text, handle in zip(
            legend.get_texts(), legend.legend_handles, strict=True)}
        assert strengths == [shown["phase expert (ours)"], shown["Meta-World's expert"]] * 3
        dotted = {tick(ax, float(np.mean(line.get_xdata()))): float(line.get_ydata()[0]) for line in ax.get_lines()
                  if line.get_linestyle() == ":"}
        theirs = PAPER.query("experiment == 'table6_collection' and condition == 'simulation' and metric == @column")
        assert dotted == {NAMES[row.method]: row.value for row in theirs.itertuples()}


@pytest.mark.parametrize("case", ["figure 1", "pick-place", "push"])
def test_a_waterfall_and_the_leads_beside_it_are_of_their_case(world, case):
    rows = {row["setting"]: row for row in rows_of(world, "gap") if (row["case"], row["method"]) == (case, "static")}
    steps = world.table("gap_steps").query("case == @case and method == 'static'")
    left, right = panels(world, "gap", f"{TITLES.get(case, case)}: ")
    bars = {tick(left, bar.get_y() + bar.get_height() / 2, across=True): (bar.get_x(), bar.get_width(),
                                                                         to_hex(bar.get_facecolor()))
            for bar in left.patches if isinstance(bar, Rectangle)}
    wanted = {row.step: (row.start, row.change, to_hex(GREY)) for row in steps.itertuples()}
    levels = {name: rows[name]["value"] for name in ("the package's protocol", "all of them together")}
    wanted |= {name: (0, value, COLOURS["static"]) for name, value in
               {**levels, "the paper": rows["the package's protocol"]["paper"]}.items()}
    assert set(bars) == set(wanted)
    lighter = {name for name, bar in zip(bars, left.patches, strict=True) if bar.get_alpha() < 0.6}
    assert lighter == {"more together than alone", "the paper"}  # as the caption says of the first
    for name, (start, width, colour) in wanted.items():
        assert bars[name] == (pytest.approx(start, abs=ROUNDED), pytest.approx(width, abs=2 * ROUNDED), colour), name
    ends = {tick(left, place, across=True): (low, high) for place, _, low, high, _ in drawn(left, across=True)}
    for row in steps[steps.low.notna()].itertuples():
        assert ends[row.step] == pytest.approx((row.start + row.low, row.start + row.high), abs=3 * ROUNDED)
    leads = world.table("gap_leads").query("case == @case").set_index("setting")
    found = {tick(left, place, across=True): (value, low, high, colour)
             for place, value, low, high, colour in drawn(right, across=True)}
    assert set(found) == set(leads.index)
    for name, (*numbers, colour) in found.items():
        lead = leads.loc[name]
        assert numbers == pytest.approx([lead.difference, lead.low, lead.high], abs=ROUNDED)
        assert colour == "#000000"
    (diamond,) = (line for line in right.get_lines() if line.get_marker() == "D")
    assert tick(left, float(diamond.get_ydata()[0]), across=True) == "the paper"
    assert float(diamond.get_xdata()[0]) == pytest.approx(leads.paper.iloc[0])


def test_the_gap_tells_each_cases_rates_and_shows_its_largest_step(world):
    text, rows, steps = here(world, "gap"), rows_of(world, "gap"), world.table("gap_steps")
    protocol = "the package's protocol"
    shown = world.displayed["gap", "largest"].set_index("Case")
    for case in ("figure 1", "pick-place", "push"):
        own = {row["setting"]: row for row in rows if (row["case"], row["method"]) == (case, "static")}
        alone = steps[(steps.case == case) & (steps.method == "static") & steps.step.isin(list(own))
                      & ~steps.step.str.endswith("times the steps")]
        largest = alone.loc[alone.change.idxmin()]
        assert tells(text, 100 * own[protocol]["value"], f"{case}:", "static")
        sentence = text.split(f"{case}: static")[1].split(";")[0]
        cells = shown.loc[TITLES.get(case, case)]
        assert cells["Largest single step of static"] == largest.step
        assert [int(each) for each in re.findall(r"[+-]\d+", cells["Change (points)"])] == pytest.approx(
            [100 * largest.change, 100 * largest.low, 100 * largest.high], abs=0.51)
        assert f"{own[protocol]['paper']:.0%} in the paper" in sentence
        assert f"with all settings {own['all of them together']['value']:.0%}" in sentence


def test_an_efficiency_stands_on_the_line_of_its_task(world):
    world.show("fig4_scaling")
    table = world.table("fig4_scaling_efficiency").set_index("task")
    (ax,) = [ax for ax in world.figures["fig4_efficiency"].axes if drawn(ax, across=True)]
    found = {tick(ax, place, across=True): value for place, value, *_ in drawn(ax, across=True)}
    assert found == pytest.approx({TITLES[task]: min(row.ratio, row.most) for task, row in table.iterrows()}, rel=1e-3)


@pytest.mark.parametrize("figure", ["fig1_sparse", "fig3_dense", "fig5_circle", "table1_spatial_factors"])
def test_the_papers_value_is_dotted_over_the_bar_that_it_is_about(world, figure):
    table = figure if figure.startswith("table") else f"{figure}_hand"
    rows = [row for row in rows_of(world, table) if np.isfinite(row["paper"])]
    bars = {(bar.get_x() + bar.get_width() / 2, round(bar.get_height(), 4)): ax for ax in world.figures[figure].axes
            for bar in ax.patches if isinstance(bar, Rectangle)}
    for row in rows:
        ((place, _), ax), *_ = [each for each in bars.items() if abs(each[0][1] - row["value"]) < 2 * ROUNDED]
        over = [float(line.get_ydata()[0]) for line in ax.get_lines()
                if line.get_linestyle() == ":" and abs(np.mean(line.get_xdata()) - place) < 0.01]
        assert over == pytest.approx([row["paper"]]), row


@pytest.mark.parametrize("figure", ["table2_main", "fig4_scaling", "keypoint_control"])
def test_the_papers_diamonds_are_its_rates_in_the_colour_of_their_method(world, figure):
    world.show(figure)
    theirs = PAPER.query("experiment == 'table2_main' and metric == 'success' and method in ('static', 'adc', 'move')")
    if figure == "keypoint_control":
        theirs = theirs[theirs.task == "pick-place"]
    for task, rows in theirs.groupby("task"):
        word = "from pixels" if figure == "table2_main" else TITLES[task]
        axes = [ax for ax in panels(world, figure, word) if ax.get_title(loc="left").endswith(word)] or panels(
            world, figure, word)
        found = {(to_hex(line.get_color()), round(float(y), 4)): (ax, float(x)) for ax in axes[:1]
                 for line in ax.get_lines() if line.get_marker() == "D" and len(line.get_xdata())
                 for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)
                 if figure != "table2_main" or tick(ax, float(x)) == TITLES[task]}
        assert set(found) == {(COLOURS[row.method], round(row.value, 4)) for row in rows.itertuples()}, task


# sentences -----------------------------------------------------------------------------------------------------------


def said(text: str, *words: str) -> list[tuple[float, float]]:
    """The first number after these words in this order, wherever they stand, and half of its last digit."""
    gap = r"[^;]{0,140}?"
    found = re.findall(rf"(?={gap.join(map(re.escape, words))}[^\d;]{{0,60}}?([+\-−]?\d[\d,]*(?:\.\d+)?)(?!\d))", text)
    return [(float(number.replace(",", "").replace("−", "-")), 0.5 / 10 ** len(number.partition(".")[2]))
            for number in found]


def tells(text: str, number: float, *words: str) -> bool:
    """Whether a text tells this number, as it is rounded, after these words."""
    return any(abs(told - number) <= half + 100 * ROUNDED for told, half in said(text, *words))


def here(world: World, figure: str) -> str:
    """What a notebook says of what came out here, after what it says of the paper; the same in the caption's file."""
    shown = world.show(figure)
    plain = " ".join(shown.replace("**", "").split())
    if (world.folder / "paper_figures" / f"{figure}.caption.md").exists():
        assert plain in " ".join(world.text(f"{figure}.caption.md").replace("**", "").split())
    return plain[plain.index("Here"):]


@dataclass(frozen=True)
class Said:
    """A sentence: each row of a table is told after these words."""

    figure: str
    table: str
    words: Callable[[Row], tuple[str, ...]]
    column: str = "value"
    only: Callable[[Row], bool] = lambda row: True


def method(*before: str, after: Sequence[str] = ()) -> Callable[[Row], tuple[str, ...]]:
    return lambda row: (*before, NAMES[row["method"]], *after)


SAID = [
    Said("fig1_sparse", "fig1_sparse_points", method("nine points")),
    Said("fig1_sparse", "fig1_sparse_difference", lambda row: (row["hand"],), "difference"),
    Said("few_demonstrations", "few_demonstrations_points", lambda row: (f"{row['timesteps']:,}", "succeeds"),
         only=lambda row: row["method"] == "static" and row["timesteps"] == 1550),
    Said("few_demonstrations", "few_demonstrations_differences", lambda row: ("whole space", "MOVE minus static"),
         "difference", lambda row: row["timesteps"] == 1550),
    Said("fig3_dense", "fig3_dense_difference", lambda row: (row["hand"],), "difference"),
    Said("fig5_circle", "fig5_circle_differences", lambda row: (row["where"],), "difference",
         lambda row: row["hand"] == "anywhere"),
    Said("fig5_circle", "fig5_circle_points", method("twenty points")),
    Said("table1_spatial_factors", "table1_spatial_factors", lambda row: ("static has", LESS[row["factors"]]),
         only=lambda row: row["method"] == "static"),
    Said("table1_spatial_factors", "table1_spatial_factors_differences",
         lambda row: ("MOVE minus static", LESS[row["factors"]]), "difference"),
    Said("table2_main", "table2_main_differences_mean", lambda row: ("minus", NAMES[row["baseline"]]), "difference"),
    Said("table2_main", "table2_main_differences_keypoints_mean",
         lambda row: ("from keypoints", *["and"] * (row["baseline"] == "adc")), "difference"),
    Said("radius", "radius_leads", lambda row: ("At equal distance",), "difference", lambda row: (
        row["setting"], row["observation"], row["compared"]) == ("hand anywhere", "rgb", "equal distance")),
    Said("fig_mixture", "fig_mixture_gains", lambda row: (f"{100 * row['share']:.0f} %",), "difference"),
    Said("fig_speed_law", "fig_speed_law_others", lambda row: (row["law"],), "difference"),
    Said("fig_training_length", "fig_training_length_depends", lambda row: ("shortest to the longest",), "difference",
         lambda row: row["task"].startswith("mean of")),
    Said("fig_training_length", "fig_training_length_beyond", lambda row: ("recipe's length to the longest",),
         "difference", lambda row: row["task"].startswith("mean of")),
    Said("decided", "decided_differences", lambda row: (
        f"claim {row['claim']}, {row['variant']} minus {row['baseline']}",), "difference"),
    Said("equal_demonstrations", "equal_demonstrations_differences",
         lambda row: ("equal", row["equal"], "MOVE", "static"), "difference"),
    Said("table_adc", "table_adc_differences",
         lambda row: ("from " + {"rgb": "pixels"}.get(row["observation"], row["observation"]) + f" {row['jumping']},",
                      f"{row['items']} tasks"), "difference"),
    Said("keypoint_control", "keypoint_control_differences_mean", lambda row: ("minus", NAMES[row["baseline"]]),
         "difference"),
    Said("table_keypoint_control", "table_keypoint_control_differences_mean",
         lambda row: ("minus", NAMES[row["baseline"]]), "difference"),
]


@pytest.mark.parametrize("sentence", SAID, ids=lambda each: each.table)
def test_a_sentence_tells_the_number_of_each_row_after_whose_it_is(world, sentence):
    text = here(world, sentence.figure)
    rows = [row for row in world.table(sentence.table).to_dict("records") if sentence.only(row)]
    assert rows, "no row"
    for row in rows:
        assert tells(text, 100 * row[sentence.column], *sentence.words(row)), (row, said(text, *sentence.words(row)))


@dataclass(frozen=True)
class Displayed:
    """A table that a notebook shows: of each row of the file the number with its interval, next to whose it is."""

    figure: str
    suffix: str
    words: Callable[[Row], tuple[str, ...]]
    columns: tuple[str, str, str] = ("difference", "low", "high")
    heading: str = "Difference (points)"


VALUE = {"columns": ("value", "low", "high"), "heading": "Success (%)"}
DISPLAYED = [
    Displayed("fig1_sparse", "difference", lambda row: (row["hand"],)),
    Displayed("few_demonstrations", "points", lambda row: (f"{row['timesteps']:,}", NAMES[row["method"]]), **VALUE),
    Displayed("few_demonstrations", "differences", lambda row: (f"{row['timesteps']:,}",)),
    Displayed("fig3_dense", "difference", lambda row: (row["hand"],)),
    Displayed("fig3_dense", "budgets_difference", lambda row: (f"{row['timesteps']:,}",)),
    Displayed("fig5_circle", "differences", lambda row: (row["where"], row["hand"])),
    Displayed("table1_spatial_factors", "differences", lambda row: (NAMES[row["baseline"]],)),
    Displayed("table1_spatial_factors", "lost", lambda row: ("object",)),
    Displayed("table2_main", "differences", lambda row: (title(row), NAMES[row["baseline"]])),
    Displayed("generalization", "differences", lambda row: (title(row), NAMES[row["baseline"]])),
    Displayed("fig4_scaling", "equal", lambda row: (title(row), f"{row['move_timesteps']:,}",
                                                    f"{row['static_timesteps']:,}")),
    Displayed("fig6_dimensions", "steps", lambda row: (title(row), row["moves"].replace(" + ", ", "),
                                                       row["baseline"].replace(" + ", ", "))),
    Displayed("fig7_speed", "ends", lambda row: (title(row), row["part"], f"{row['speed']:.3g}",
                                                 f"{row['baseline']:.3g}")),
    Displayed("fig_mixture", "gains", lambda row: (f"{100 * row['share']:.1f}",)),
    Displayed("fig_speed_law", "others", lambda row: (row["law"], row["baseline"])),
    Displayed("fig_training_length", "differences", lambda row: (title(row), f"{row['length']:.3g}")),
    Displayed("fig_training_length", "depends", lambda row: (TITLES.get(row["task"], row["task"]),)),
    Displayed("fig_training_length", "beyond", lambda row: (TITLES.get(row["task"], row["task"]),)),
    Displayed("fig_perception", "differences_rgb", lambda row: (row["experiment"],)),
    Displayed("fig_perception", "differences_keypoints", lambda row: (row["experiment"],)),
    Displayed("keypoint_control", "differences", lambda row: (f"{row['timesteps']:,}", NAMES[row["baseline"]])),
    Displayed("table_adc", "differences", lambda row: (row["jumping"], str(row["items"]))),
    Displayed("table_recipe", "", lambda row: (f"{row['timesteps']:,}", row["change"]), **VALUE),
    Displayed("table_recipe", "", lambda row: (f"{row['timesteps']:,}", row["change"], f"{row['train_minutes']:.1f}"),
              ("gain", "gain_low", "gain_high"), "Gain (points)"),
]


def shown_numbers(cell: str) -> list[float]:
    return [float(number.replace("−", "-")) for number in re.findall(r"[+−]?\d+(?:\.\d+)?", cell)]


@pytest.mark.parametrize("table", DISPLAYED, ids=lambda each: f"{each.figure}-{each.suffix}-{each.heading}")
def test_a_table_in_a_notebook_shows_the_number_of_each_row_next_to_whose_it_is(world, table):
    world.show(table.figure)
    shown = world.displayed[table.figure, table.suffix]
    rows = world.table(f"{table.figure}{'_' * bool(table.suffix)}{table.suffix}").to_dict("records")
    assert len(rows) == len(shown) > 0
    for row, (_, cells) in zip(rows, shown.iterrows(), strict=True):
        expected = [100 * row[column] for column in table.columns]
        if not np.isnan(expected).any():
            assert shown_numbers(cells[table.heading]) == pytest.approx(expected, abs=0.05 + 100 * ROUNDED), row
        assert all(any(word in str(cell) for cell in cells) for word in table.words(row)), (row, list(cells))


@pytest.mark.parametrize(("figure", "suffixes"), [
    ("table2_main", ("", "keypoints")), ("keypoint_control", ("",)), ("table_keypoint_control", ("",))])
def test_counts_means_and_other_tasks_of_a_summary_are_those_of_its_own_tables(world, figure, suffixes):
    """Where MOVE is above each other method after Holm's adjustment, by how much on the mean and over other tasks."""
    world.show(figure)
    shown = world.displayed[figure, "summary"]
    assert len(shown) == 2 * len(suffixes)
    for suffix in suffixes:
        part = shown if "From" not in shown else shown[shown.From == (suffix or "pixels")]
        ending = "_" * bool(suffix) + suffix
        compared, means = (world.table(f"{figure}_differences{ending}{more}") for more in ("", "_mean"))
        for _, cells in part.iterrows():
            baseline = next(key for key, name in NAMES.items() if name == cells["Against"])
            rows = compared[compared.baseline == baseline]
            clear = rows[rows.holm < 0.05].difference
            assert [int(cells[name]) for name in ("Above on", "Below on", "Not distinguishable on")] == [
                (clear > 0).sum(), (clear < 0).sum(), len(rows) - len(clear)]
            (mean,) = means[means.baseline == baseline].itertuples()
            assert shown_numbers(cells["Mean difference (points)"]) == pytest.approx(
                [100 * mean.difference, 100 * mean.low, 100 * mean.high], abs=0.06)
            if figure == "keypoint_control":
                continue
            (over,) = world.table(f"{figure}_over_tasks{ending}").query("baseline == @baseline").itertuples()
            for heading, expected in (
                    ("Over other tasks (points)", (over.mean_difference, over.low, over.high)),
                    ("IQM (points)", (over.iqm_first - over.iqm_second, over.iqm_low, over.iqm_high)),
                    ("MOVE better (%)", (over.improvement, over.improvement_low, over.improvement_high))):
                assert shown_numbers(cells[heading]) == pytest.approx([100 * each for each in expected], abs=0.06)
            p = cells["p, over tasks"]
            assert p == "<0.001" if over.p_value < 0.001 else float(p) == pytest.approx(over.p_value, abs=0.0006)
    text, rates = here(world, figure), world.table(figure)
    if "task" in rates:
        for name, value in rates.groupby("method").value.mean().items():
            assert tells(text, 100 * value, *["means"] * (figure != "table2_main"), NAMES[name]), name
        counted = world.table(f"{figure}_differences")
    if figure == "table_keypoint_control":
        for baseline, rows in counted.groupby("baseline"):
            above = ((rows.holm < 0.05) & (rows.difference > 0)).sum()
            assert f"above {NAMES[baseline]} on {above} of {len(rows)}" in text


@pytest.mark.parametrize(("figure", "suffix", "words"), [
    ("fig6_dimensions", "steps", ""), ("fig7_speed", "ends", ""), ("fig4_scaling", "equal", "called equal"),
    ("fig_perception", "differences_rgb", "from pixels"),
    ("fig_perception", "differences_keypoints", "from keypoints")])
def test_a_sentence_counts_the_differences_of_its_own_table(world, figure, suffix, words):
    text = here(world, figure)
    table = world.table(f"{figure}_{suffix}").dropna(subset="difference")
    clear = table[table.holm < 0.05].difference
    counts = [(clear > 0).sum(), len(table), (clear < 0).sum(), len(table) - len(clear)]
    found = re.findall(rf"{words}[^;\d]*(\d+) of (\d+) are above 0, (\d+) below(?:, (\d+) not)?", text)
    assert counts in [[int(each or len(table) - len(clear)) for each in one] for one in found], found


@pytest.mark.parametrize(("figure", "suffix", "words"), [
    ("fig6_dimensions", "steps", lambda row: f"{title(row)}, {row['moves']} against {row['baseline']} "),
    ("fig7_speed", "ends", lambda row: f"{title(row)}, {row['part']} {row['speed']:.2g} against {row['baseline']:.2g} ")
])
def test_a_sentence_tells_the_largest_difference_of_its_own_table(world, figure, suffix, words):
    text, table = here(world, figure), world.table(f"{figure}_{suffix}")
    row = table.loc[table.difference.abs().idxmax()].to_dict()
    assert tells(text, 100 * row["difference"], "largest", words(row))


@pytest.mark.parametrize("figure", ["fig1_sparse", "fig3_dense", "fig5_circle"])
def test_the_verdict_of_a_difference_is_that_of_its_own_row(world, figure):
    """By the rule of `move.statistics.verdicts`, of the paper's difference and the room above static."""
    text = here(world, figure)
    name = "differences" if figure == "fig5_circle" else "difference"
    rates = world.table(f"{figure}_hand").query("method == 'static'")
    theirs = PAPER.query("experiment == @figure and metric == 'success'")
    rows = world.table(f"{figure}_{name}").to_dict("records")
    for row, shown in zip(rows, world.displayed[figure, name].Verdict, strict=True):
        by = [key for key in ("where", "hand") if key in row]
        (static,) = rates[(rates[by] == pd.Series(row)[by]).all(axis=1)].value
        papers = theirs if "where" not in row else theirs[theirs.condition == row["where"]]
        papers = papers.set_index("method").value
        finding = verdicts.Finding("", row["difference"], row["low"], row["high"],
                                   paper=papers.move - papers.static, room=1 - static)
        assert shown == verdicts.verdict([finding]), row
        if row["hand"] == "anywhere" or figure != "fig5_circle":
            assert re.search(rf"{row.get('where', row['hand'])} [^;]*\]: {re.escape(shown)}", text), (row, text)


def test_generalization_tells_each_methods_means_over_the_tasks(world):
    text, table = here(world, "generalization"), world.table("generalization")
    shown = world.displayed["generalization", "means"].set_index("Method")
    assert len(shown) == table.method.nunique()
    for name, rows in table.groupby("method"):
        cells = shown.loc[NAMES[name]]
        expected = [100 * rows[column].mean() for column in ("own", "elsewhere", "lost", "in_motion")]
        assert [shown_numbers(cells[heading])[0] for heading in (
            "At its own grasps (%)", "Elsewhere (%)", "Lost elsewhere (points)", "Elsewhere, in motion (%)")] == (
            pytest.approx(expected, abs=0.06)) and int(cells["Tasks"]) == len(rows)
        lowest = f"{TITLES[rows.task[rows.own.idxmin()]]} ({100 * rows.own.min():.0f} %)"
        assert cells["Lowest at its own grasps"] == lowest
        told = re.search(rf"{NAMES[name]} (\d+)%, (\d+)%, (\d+)%", text)
        assert [int(each) for each in told.groups()] == pytest.approx(
            [100 * rows[column].mean() for column in ("own", "elsewhere", "in_motion")], abs=0.51)
    for baseline, rows in world.table("generalization_differences").groupby("baseline"):
        above = ((rows.holm < 0.05) & (rows.difference > 0)).sum()
        assert f"above {NAMES[baseline]} on {above} of {len(rows)}" in text


def test_rollouts_tells_each_methods_rate_over_all_episodes(world):
    text = here(world, "rollouts")
    for name in ("static", "adc", "move"):
        assert tells(text, 100 * world.cell("rollouts", method=name).mean(), "succeed", NAMES[name])


def test_efficiencies_are_shown_task_by_task_and_the_median_one_is_told(world):
    text, table = here(world, "fig4_scaling"), world.table("fig4_scaling_efficiency")
    shown = world.displayed["fig4_scaling", "efficiency"].set_index("Task")["Factor"]
    for row in table.itertuples():
        more = row.ratio > row.most
        found = re.match(r"(> )?([\d.]+) \[", shown[TITLES[row.task]])
        assert bool(found[1]) == more and float(found[2]) == pytest.approx(min(row.ratio, row.most), rel=0.06)
    median = float(re.search(r"Median task (?:> |between )?([\d.]+)", text)[1])
    assert median == pytest.approx(np.median(np.minimum(table.ratio, table.most)), rel=0.06)
    assert f"on {(table.low > 1).sum()} of {len(table)}, after Holm's adjustment on {(table.holm < 0.05).sum()}" in text


def test_what_a_demonstration_costs_is_told_expert_by_expert(world):
    text, means = here(world, "table6_collection"), world.table("table6_collection").set_index(["expert", "method"])
    for name, expert in (("our", "phase"), ("Meta-World", "metaworld")):
        steps, rates = means.loc[expert].mean_steps, means.loc[expert].generation_rate
        clause = next(part for part in text.split(";") if f"with {name}" in part)
        numbers = [float(number) for number in re.findall(r"[+-]?\d+(?:\.\d+)?", clause)[:5]]
        assert numbers == pytest.approx([100 * (steps.move / steps.static - 1), steps.static, steps.move,
                                         100 * rates.move, 100 * rates.static], abs=0.51)


def test_the_recipe_tells_minutes_and_rate_of_the_chosen_lengths(world):
    text = here(world, "table_recipe")
    for row in world.table("table_recipe").query("change == 'chosen'").to_dict("records"):
        words = (f"{row['timesteps']:,} timesteps, {row['change']}:",)
        assert tells(text, row["train_minutes"], *words) and tells(text, 100 * row["value"], *words, "training")


def test_coverages_correlations_are_of_the_cells_that_are_drawn(world):
    text, table = here(world, "fig_coverage"), world.table("fig_coverage")
    centred = table[["joint", "value"]] - table.groupby("task")[["joint", "value"]].transform("mean")
    assert tells(text, stats.spearmanr(centred.joint, centred.value).statistic, "correlation")
    ends = table[table.moves.isin(["nothing", "all"])].pivot(index="task", columns="moves")
    gains = {name: ends[name]["all"] - ends[name]["nothing"] for name in ("joint", "value")}
    assert tells(text, 100 * gains["joint"].min(), "covers")
    assert tells(text, 100 * gains["value"].max(), "success", "to")
    assert tells(text, stats.spearmanr(gains["joint"], gains["value"]).statistic, "points)")


def test_the_noise_that_is_told_is_that_of_its_own_observation(world):
    text = here(world, "table2_main")
    for words, kind in ((("differ by",), "rgb"), (("differ by", "(keypoints"), "keypoints")):
        known = noise(world, kind)
        assert known.degrees and tells(text, 100 * known.deviation, *words), kind
    text = world.show("statistics", draws=20)
    for word, kind in (("pixels", "rgb"), ("keypoints", "keypoints")):
        assert tells(text, 100 * noise(world, kind).deviation, word)
    assert noise(world, "rgb").deviation > 1.3 * noise(world, "keypoints").deviation, "else they could be exchanged"


@pytest.mark.parametrize("figure", sorted({each.figure for each in [*RATES.values()]} - {"table2_main"}))
def test_a_caption_counts_its_own_runs_seeds_and_episodes(world, figure):
    world.show(figure)
    runs = [world.results[spec.hash] for spec in world.specs[figure]]
    text = world.text(f"{figure}.caption.md")
    policies = [run for run in runs if run.training]
    assert f"{len(runs)} runs" in text and f"{sum(len(run.rows) for run in policies):,} in all" in text
    seen = {run.spec.observation for run in policies}
    assert ("pixels" in text.split("**What")[0], "keypoints (" in text) == ("rgb" in seen, "keypoints" in seen)


DIFFERENCE_SAID = re.compile(r"([+-]\d+)(?: points)? \[([+-]\d+), ([+-]\d+)\]"
                             r"(, above 0|, below 0|, not distinguishable from 0)?")
RATE_SAID = re.compile(r"\b(static|ADC|MOVE) (\d+(?:\.\d+)?) ?%")


def tables_of(world: World, figure: str) -> list[pd.DataFrame]:
    world.show(figure)
    return [pd.read_csv(path) for path in (world.folder / "paper_figures").glob(f"{figure}*.csv")]


@pytest.mark.parametrize("figure", sorted({rates.figure for rates in RATES.values()}))
def test_a_difference_in_a_caption_has_the_interval_and_the_word_of_one_row(world, figure):
    """ "+12 points [+2, +22], above 0": some row has that difference and interval, and its p after Holm agrees."""
    rows = [[*(100 * row[name] for name in columns), row.get("holm", np.nan)] for table in tables_of(world, figure)
            for columns in (("difference", "low", "high"), ("gain", "gain_low", "gain_high"),
                            ("effect", "effect_low", "effect_high")) if set(columns) <= set(table)
            for row in table.to_dict("records")]
    for told in DIFFERENCE_SAID.finditer(world.text(f"{figure}.caption.md")):
        numbers, word = [int(number) for number in told.groups()[:3]], (told[4] or "").removeprefix(", ")
        same = [row for row in rows if np.allclose(row[:3], numbers, rtol=0, atol=0.5 + 100 * ROUNDED)]
        words = {"not distinguishable from 0" if not row[3] < 0.05 else "above 0" if row[0] > 0 else "below 0"
                 for row in same}
        assert same and (not word or word in words), told[0]


@pytest.mark.parametrize("figure", sorted({rates.figure for rates in RATES.values()}))
def test_a_rate_in_a_caption_is_that_methods_in_a_table_or_in_the_paper(world, figure):
    """Or the mean over the rows of a table."""
    ours, theirs = {}, 100 * PAPER.query("metric in ('success', 'mean_success')").set_index("method").value
    for table in tables_of(world, figure):
        for column in {"value", "own", "elsewhere", "in_motion", "rate"} & set(table if "method" in table else ()):
            for method, values in table.groupby("method")[column]:
                ours.setdefault(method, []).extend([*(100 * values), 100 * values.mean()])
    text = re.split(r"\*\*(?:What came out|Alternative text)\.\*\*", world.text(f"{figure}.caption.md"))[1]
    for part, known in zip(text.partition("Here")[::2], (theirs, ours), strict=True):
        for name, number in RATE_SAID.findall(part):
            method = next(key for key, named in NAMES.items() if named == name)
            half = 0.5 / 10 ** len(number.partition(".")[2]) + 100 * ROUNDED
            assert np.isclose(known[method], float(number), rtol=0, atol=half).any(), (name, number)


# verdicts ------------------------------------------------------------------------------------------------------------

Values = list[tuple[str, float]]  # a word of what is counted, and its number


def gap(world: World, figure: str, first: Row, other: Row, place: str = "") -> float:
    return world.cell(figure, place, **first).mean() - world.cell(figure, place, **other).mean()


def over_ten(first: str, other: str) -> Callable[[World], list[float]]:
    return lambda world: [gap(world, "table2_main", {"task": task, "method": first, "observation": "rgb"},
                              {"task": task, "method": other, "observation": "rgb"}) for task in PAPER_TASKS]


def each_task(first: str, other: str) -> Callable[[World], Values]:
    return lambda world: [(f"{TITLES[task]}:", value)
                          for task, value in zip(PAPER_TASKS, over_ten(first, other)(world), strict=True)]


def mean_of_ten(first: str, other: str) -> Callable[[World], Values]:
    return lambda world: [("mean", float(np.mean(over_ten(first, other)(world))))]


def relative(world: World) -> Values:
    means = [np.mean([world.cell("table2_main", task=task, method=name, observation="rgb").mean()
                      for task in PAPER_TASKS]) for name in ("move", "static")]
    return [*mean_of_ten("move", "static")(world), ("relative", means[0] / means[1] - 1)]


def efficiencies(*tasks: str) -> Callable[[World], Values]:
    def values(world: World) -> Values:
        found = []
        for task in tasks:
            size = min(20_000, get_task(task).timesteps)
            each = data_efficiency(curves(world, task, "static"), curves(world, task, "move"), size, draws=1)
            found.append((f"{TITLES[task]},", min(each.ratio, each.most)))
        return found
    return values


def equal(task: str, move: int, static: int) -> Callable[[World], Values]:
    return lambda world: [("MOVE", gap(world, "fig4_scaling", {"task": task, "method": "move", "timesteps": move},
                                       {"task": task, "method": "static", "timesteps": static}))]


def again(claim: int, first: str, *others: str) -> Callable[[World], Values]:
    """The variants of a claim that is asked again: the first is claimed to be above, or no worse than, the others."""
    def of(world: World, variant: str) -> float:
        return cell(world, "decided", {"claim": claim, "variant": variant}).mean()

    return lambda world: [(other.split(",")[0], of(world, first) - of(world, other)) for other in others]


def scaling_points(world: World) -> Values:
    return [(f"{TITLES[task]} {size:,}:", gap(
        world, "fig4_scaling", {"task": task, "method": "move", "timesteps": size},
        {"task": task, "method": "static", "timesteps": size}))
            for task in PAPER_TASKS for size in {*curves(world, task, "move")} & {*curves(world, task, "static")}]


def hands_anywhere(figure: str, place: str, **more: Any) -> Callable[[World], float]:
    return lambda world: gap(world, figure, {"method": "move", **ANYWHERE, **more},
                             {"method": "static", **ANYWHERE, **more}, place)


def anywhere(world: World, figure: str, method: str, *places: str, **more: Any) -> float:
    """Success of a method of figures 1 and 5 at all of these places together."""
    return float(np.concatenate([world.cell(figure, place, method=method, **ANYWHERE, **more)
                                 for place in places], axis=1).mean())


def around_the_places(world: World) -> Values:
    near, far = (anywhere(world, "decided_places", "static", place) for place in ("near", "far"))
    return [("3 cm", near - far), ("fails", 1 - far)]


def along_its_path(world: World) -> Values:
    """Beyond 5 cm of all grasp points, for figure 5 counted over the places themselves."""
    found = []
    for run in world.found("fig5_circle", method="move", **ANYWHERE):
        rows = pd.DataFrame(run.rows)
        points = rows[rows.group == "point"][["object_x", "object_y"]].to_numpy()
        places = rows[["object_x", "object_y"]].to_numpy()
        apart = np.hypot(*(places[:, None] - points[None]).transpose(2, 0, 1)).min(axis=1)
        inside = np.array([CIRCLE.contains((x, y, 0.0)) for x, y in places])
        found.append(rows.success[(rows.group == "grid") & (apart > 0.05) & inside].mean())
    return [("figure 1,", anywhere(world, "fig1_sparse", "move", "far")), ("figure 5's", float(np.mean(found)))]


def decay(world: World) -> Values:
    one, two, three = (world.cell("table1_spatial_factors", method="static", factors=factors).mean(axis=1)
                       for factors in ("object", "object+target", "all"))
    return [("decay", float((two / one - three / two).mean()))]


def covered(other: str) -> Callable[[World], Values]:
    def values(world: World) -> Values:
        seen = {}
        for name in ("move", other):
            (run,) = world.found("table6_collection", task="pick-place", method=name, expert="phase")
            seen[name] = visited(run.spec.collection, world.turned)
        return [(part, share(seen["move"], part) - share(seen[other], part)) for part in ("object", "target", "camera")]

    def share(seen: pd.DataFrame, part: str) -> float:
        return coverage.visited_share(seen, get_task("pick-place"), part)

    return values


def gaps_in_motion(world: World) -> Values:
    return [(f"{TITLES[task]},", gap(world, "generalization", {"task": task, "method": "move", "group": "moving"},
                                     {"task": task, "method": "static", "group": "moving"}))
            for task in dict.fromkeys(spec.task for spec in world.specs["generalization"])]


def rungs(world: World) -> Values:
    found = []
    for task, parts in (("pick-place", ("object", "target", "camera")),
                        ("assembly", ("object", "target", "camera", "rotation"))):
        for count in range(len(parts)):
            less, more = frozenset(parts[:count]), frozenset(parts[:count + 1])
            found.append((f"{TITLES[task]}, {' + '.join(parts[:count + 1])} minus", gap(
                world, "fig6_dimensions", {"task": task, "moving": more}, {"task": task, "moving": less})))
        steps = [value for words, value in found if words.startswith(TITLES[task])]
        levels = np.concatenate([[0.0], np.cumsum(steps)])
        found.append((f"{TITLES[task]}, slope", float(np.polyfit(np.arange(len(levels)), levels, 1)[0])))
    return found


def speed_ranges(world: World) -> Values:
    """By how much a straight line over the logarithm of a speed changes from its slowest to its fastest."""
    found, each = [], (0.01, 0.02, 0.03, 0.05, 0.08)
    for task in ("pick-place", "assembly"):
        for part in ("object", "target"):
            rates = [world.cell("fig7_speed", task=task, **speed({"part": part, "speed": one})).mean() for one in each]
            slope = np.polyfit(np.log(each), rates, 1)[0]
            found.append((f"{TITLES[task]}, change of success over an eightfold range of the {part}'s",
                          float(slope * np.log(each[-1] / each[0]))))
    return found


def metaworlds(world: World, method: str) -> np.ndarray:
    return np.array([collected(world, method, "metaworld", task) for task in PAPER_TASKS])


def mean_efficiency(world: World) -> Values:
    each = efficiencies(*PAPER_TASKS)(world)
    return [*each, ("geometric mean", float(np.exp(np.mean([np.log(value) for _, value in each]))))]


CLAIMS: dict[int, Callable[[World], Values]] = {
    1: relative,
    2: each_task("move", "static"),
    3: each_task("move", "adc"),
    4: mean_of_ten("move", "adc"),
    5: mean_of_ten("adc", "static"),
    6: efficiencies("pick-place", "assembly", "pick-place-wall"),
    7: again(7, "MOVE, 20,000", "static, 50,000"),
    8: equal("assembly", 50_000, 100_000),
    9: equal("pick-place-wall", 20_000, 100_000),
    10: scaling_points,
    11: around_the_places,
    12: lambda world: [("MOVE", hands_anywhere("fig1_sparse", "grid")(world))],
    13: lambda world: [("static", anywhere(world, "decided_places", "static", "point"))],
    14: lambda world: [(f"{size:,}", 1 - anywhere(world, "few_demonstrations", "static", "point", timesteps=size))
                       for size in (1550, 3900)],
    15: lambda world: [("MOVE", hands_anywhere("fig3_dense", "", timesteps=7000)(world))],
    16: lambda world: [("inside", hands_anywhere("fig5_circle", "inside")(world))],
    17: lambda world: [("outside", hands_anywhere("fig5_circle", "outside")(world))],
    18: lambda world: [("static", gap(world, "table1_spatial_factors", {"method": "static", "factors": "object"},
                                      {"method": "static", "factors": "all"}))],
    19: decay,
    20: covered("static"),
    21: covered("adc"),
    23: along_its_path,
    24: gaps_in_motion,
    25: again(25, "Beta", "uniform", "constant"),
    26: again(26, "with rotation", "without"),
    28: rungs,
    29: speed_ranges,
    30: lambda world: [("length", float(
        metaworlds(world, "move")[:, 1].mean() / metaworlds(world, "static")[:, 1].mean() - 1))],
    31: lambda world: [(f"{NAMES[method]},", metaworlds(world, method)[:, 0].mean()) for method in ("static", "move")],
    36: mean_efficiency,
}
"""By its number: what a claim hangs on, in its own direction."""
OF_THE_PAPER = {22: "contradicted by the paper", 27: "not built here", 32: "not testable", 33: "reproduced",
                34: "undecided", 35: "undecided"}
"""Decided without any stored run, whatever the world."""
TURNED = {8: "undecided", 29: "reproduced"}
"""Verdicts in the turned world that are not "refuted here": of a small difference, and that a change is small."""


def ledger(world: World) -> dict[int, Row]:
    """What the notebook wrote of each claim, for readers and for programs, which is the same."""
    world.show("claims")
    table = {row["number"]: row for row in world.table("claims").to_dict("records")}
    entries = {entry["number"]: entry for entry in json.loads(world.text("claims.json"))["claims"]}
    assert {number: row["verdict"] for number, row in table.items()} == {
        number: entry["verdict"] for number, entry in entries.items()}
    for number, entry in entries.items():
        assert all(each["what"] in table[number]["evidence"] for each in entry["numbers"]), number
    return entries


def value_of(told: Row) -> float:
    """A claim's number; one that is "more than" something is that bound."""
    if told["value"] is None or re.search(r": [<>]=? ", told["what"]):
        return float(re.search(r": [<>]=? ([\d.]+)", told["what"])[1])
    return told["value"]


def test_every_claim_of_the_ledger_is_held_to_what_was_planted(world):
    assert set(ledger(world)) == {*CLAIMS, *OF_THE_PAPER}


@pytest.mark.parametrize("number", CLAIMS)
@pytest.mark.parametrize("place", ["world", "turned"])
def test_a_claims_numbers_are_what_was_planted_and_its_verdict_follows(place, number, request):
    """In the turned world every success is a failure: each difference has the other sign, and no claim holds."""
    there = request.getfixturevalue(place)
    entry, expected = ledger(there)[number], CLAIMS[number](there)
    assert len(entry["numbers"]) == len(expected), entry["numbers"]
    for word, value in expected:
        told = [value_of(each) for each in entry["numbers"] if word in each["what"]]
        rough = 0.06 if entry["figure"] == "fig4_scaling" and number in (6, 36) else 1e-5
        assert any(each == pytest.approx(value, rel=rough, abs=1e-6) for each in told), (word, value, told)
    verdict, sizes = entry["verdict"], {each["size"] for each in entry["numbers"]} - {""}
    if place == "turned":
        assert verdict == TURNED.get(number, "refuted here"), entry["numbers"]
    elif "," in verdict:
        assert sizes == {verdict.removeprefix("reproduced, ")}, entry["numbers"]
    else:
        assert verdict == "reproduced", entry["numbers"]


@pytest.mark.parametrize(("number", "other"), [(1, "static"), (4, "adc"), (5, "static")])
def test_the_room_of_a_difference_is_what_the_other_side_leaves(world, number, other):
    rates = [world.cell("table2_main", task=task, method=other, observation="rgb").mean() for task in PAPER_TASKS]
    (room,) = {each["room"] for each in ledger(world)[number]["numbers"] if each["room"] is not None}
    assert room == pytest.approx(1 - np.mean(rates), abs=1e-5)


def test_a_reader_of_the_ledger_is_told_which_rules_changed(world):
    told = {number: entry["changed"] for number, entry in ledger(world).items()}
    assert told == {claim.number: " ".join(claim.changed.split()) for claim in claims()} and any(told.values())


INTERVALS: dict[int, tuple[str, dict[str, Any]]] = {  # a claim's number -> the table of the same differences, its rows
    1: ("table2_main_differences_mean", {"baseline": "static"}),
    2: ("table2_main_differences", {"baseline": "static"}), 3: ("table2_main_differences", {"baseline": "adc"}),
    4: ("table2_main_differences_mean", {"baseline": "adc"}), 12: ("fig1_sparse_difference", {"hand": "anywhere"}),
    15: ("fig3_dense_difference", {"hand": "anywhere"}),
    16: ("fig5_circle_differences", {"hand": "anywhere", "where": "inside"}),
    17: ("fig5_circle_differences", {"hand": "anywhere", "where": "outside"}),
    18: ("table1_spatial_factors_lost", {"factors": "all"}),
    24: ("generalization_differences", {"baseline": "static"}),
    **{number: ("decided_differences", {"claim": number}) for number in (7, 25, 26)},
}
OTHER_SIDE_FIRST = (18,)  # claims that are above 0 where the table's row is below


@pytest.mark.parametrize("number", INTERVALS)
def test_a_claims_intervals_are_those_of_the_figures_own_table(world, number):
    name, only = INTERVALS[number]
    entry = ledger(world)[number]
    world.show(entry["figure"])
    rows = [row for row in world.table(name).to_dict("records") if all(row[key] == only[key] for key in only)]
    numbers = [each for each in entry["numbers"] if "relative" not in each["what"]]
    for each, row in zip(numbers, rows, strict=True):
        found = each["value"], each["low"], each["high"]
        if number in OTHER_SIDE_FIRST:
            found = -each["value"], -each["high"], -each["low"]
        assert found == pytest.approx((row["difference"], row["low"], row["high"]), abs=1.1 * ROUNDED), each
    if number == 1:
        assert set(entry["runs"]) == {run.spec.hash for method in ("static", "move") for run in world.found(
            "table2_main", method=method, observation="rgb")}


def test_rates_near_and_far_from_nine_places_that_are_asked_again_stand_and_are_told_at_their_names(world):
    text, (_, ax, *_) = here(world, "decided_places"), world.figures["decided_places"].axes
    names = {"point": "nine places", "near": "within 3 cm", "far": "beyond 5 cm", "grid": "whole space"}
    rows = {names[row.group]: row for row in world.table("decided_places").itertuples()}
    for place, *numbers, colour in drawn(ax):
        row = rows.pop(tick(ax, place))
        assert (numbers, colour) == (pytest.approx([row.value, row.low, row.high], abs=ROUNDED), COLOURS["static"])
        assert f"{names[row.group]} {row.value:.0%} [{row.low:.0%}, {row.high:.0%}]" in text
    assert not rows


def test_the_papers_rate_at_nine_places_is_dotted_where_the_whole_space_stands(world):
    world.show("decided_places")
    _, ax = world.figures["decided_places"].axes[:2]
    (dotted,) = (line for line in ax.get_lines() if line.get_linestyle() == ":")
    assert tick(ax, float(np.mean(dotted.get_xdata()))) == "whole space" and set(dotted.get_ydata()) == {0.295}


@pytest.mark.parametrize("number", OF_THE_PAPER)
def test_what_no_run_decides_has_one_verdict_in_every_world(world, turned, number):
    for there in (world, turned):
        entry = ledger(there)[number]
        assert (entry["verdict"], entry["runs"]) == (OF_THE_PAPER[number], [])


def test_the_size_of_a_claim_is_told_on_the_side_of_the_papers_number(world, turned):
    sized = 0
    for entry in [*ledger(world).values(), *ledger(turned).values()]:
        for each in entry["numbers"]:
            if each["size"] and each["value"] is not None:
                sized += 1
                assert (each["value"] < each["paper"]) == (each["size"] == "smaller"), each
    assert sized > 20


@pytest.mark.parametrize("place", ["world", "turned"])
def test_the_figure_of_the_claims_shows_their_numbers_in_the_colours_of_their_verdicts(place, request):
    there = request.getfixturevalue(place)
    entries, seen, edges = ledger(there), set(), {}
    for ax in there.figures["claims"].axes:
        for height, value, low, high, colour in drawn(ax, across=True):
            number = int(tick(ax, height, across=True).split()[-1])
            entry = entries[number]
            found = [(each["value"], each["low"], each["high"]) for each in entry["numbers"]
                     if each["value"] is not None]
            mean = float(np.mean([each[0] for each in found]))
            less, more = (float(np.hypot.reduce([each[0] - each[end] for each in found])) / len(found) if None not in
                          np.ravel(found) else np.nan for end in (1, 2))
            marks = [*found, (mean, mean - less, mean + more)] if len(found) > 2 and entry["join"] == "every" else found
            assert any((value, low, high) == pytest.approx(each, abs=1e-5) for each in marks), (number, value, marks)
            assert colour == to_hex(VERDICT_COLOURS.get(entry["verdict"], GREY)), number
            seen.add(number)
        upright = max(float(line.get_xdata()[0]) for line in ax.get_lines() if list(line.get_ydata()) == [0, 1])
        for line in (line for line in ax.get_lines() if line.get_marker() in ("|", ">", "D") and len(line.get_xdata())):
            if line.get_marker() == "|" and not line.get_alpha():
                continue  # the cap of an interval
            number, value = int(tick(ax, float(line.get_ydata()[0]), across=True).split()[-1]), line.get_xdata()[0]
            numbers = entries[number]["numbers"]
            assert all(each["above"] == upright for each in numbers) or upright == 0
            papers = [np.nan if each["paper"] is None else each["paper"] for each in numbers]
            marked = {"|": [each["value"] for each in numbers if each["value"] is not None],
                      ">": [each["low"] for each in numbers if each["value"] is None],
                      "D": [*papers, np.mean(papers)]}[line.get_marker()]
            assert any(float(value) == pytest.approx(each, abs=1e-5, nan_ok=True) for each in marked), (number, value)
            seen.add(number)
        for strokes in (part for part in ax.collections if isinstance(part, LineCollection)):
            for (edge, below), (_, above) in (stroke for stroke in strokes.get_segments() if len(stroke) == 2):
                if below != above:
                    number = int(tick(ax, (below + above) / 2, across=True).split()[-1])
                    edges.setdefault(number, set()).add(round(float(edge), 6))
    assert edges == {number: {each[name] for each in entries[number]["numbers"] for name in ("above", "below")} - {None}
                     for number in seen}
    assert seen == {number for number, entry in entries.items()
                    if any(each["low"] is not None for each in entry["numbers"])}


def test_the_ledgers_sentence_counts_the_verdicts(world):
    verdicts = [entry["verdict"] for entry in ledger(world).values()]
    told = " ".join(world.show("claims").split())
    assert f"Of {len(verdicts)} claims" in told
    for verdict in set(verdicts):
        assert re.search(rf"\b{verdicts.count(verdict)} {re.escape(verdict)}(?!,? (smaller|larger))", told), verdict


# pictures ------------------------------------------------------------------------------------------------------------


LACKING: dict[str, Row] = {  # question marks stand in the place of these cells
    "fig4_scaling": {"task": "pick-place", "method": "move", "timesteps": 40_000},
    "fig7_speed": {"task": "pick-place", "method": "move", "camera_speed": round(float(np.radians(2.67)), 6)},
    "few_demonstrations": {"method": "static", "timesteps": 1550},
    "fig_training_length": {"task": "push", "method": "move", "length": 3.0},
    "fifty_demonstrations": {"task": "pick-place", "method": "move", "demonstrations": 25, "placement": ("random", 25)},
}


@pytest.fixture(scope="module")
def lacking(world):
    """The same world, of which four figures lack a cell; no other test can follow."""
    for figure, cell in LACKING.items():
        world.lose(figure, **cell)
    return world


def test_one_question_mark_stands_for_one_cell_that_is_missing(lacking):
    lacking.show("fifty_demonstrations")
    marks = [line for ax in lacking.figures["fifty_demonstrations"].axes for line in ax.get_lines()
             if line.get_marker() == "$?$" and len(line.get_xdata())]
    assert [len(line.get_xdata()) for line in marks] == [1] and to_hex(marks[0].get_color()) == COLOURS["move"]
    assert float(marks[0].get_xdata()[0]) == pytest.approx(25, rel=0.1)


def picture(name: str, world: World) -> plt.Figure:
    if name in BY_HAND:
        return BY_HAND[name]()
    world.show(PICTURES[name])
    return world.figures[name]


def seen_texts(figure: plt.Figure) -> list[Text]:
    """Every text of a drawn figure that a reader sees: not those of ticks beyond an axis, or of an axis that is off."""
    unseen = set()
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            slack = 1e-6 * (high - low)
            for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
                if not (ax.axison and low - slack <= tick.get_loc() <= high + slack):
                    unseen |= {tick.label1, tick.label2}
            unseen |= set() if ax.axison else {axis.label, axis.get_offset_text()}
    return [text for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible()
            and text not in unseen]


@pytest.fixture(params=PICTURES, scope="module")
def printed(request, lacking):
    style.use_style()
    figure = picture(request.param, lacking)
    figure.set_label(request.param)
    style.remark(figure, "114 of 154 runs are missing")
    figure.set_dpi(plt.rcParams["savefig.dpi"])  # as it is written
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "MOST_PASSES", 10)  # figure 8 comes to no rest in forty
        style.settle(figure)
    figure.draw_without_rendering()
    yield figure
    plt.close(figure)


def test_a_figure_can_be_printed(printed):
    """One or two columns wide, no text under 7 points, none cut off at the edge, none over another."""
    assert round(printed.get_figwidth(), 2) in (style.COLUMN_WIDTH, style.PAGE_WIDTH)
    texts = seen_texts(printed)
    assert texts and [text for text in texts if text.get_fontsize() < style.LEAST_POINTS] == []
    width, height = printed.bbox.width, printed.bbox.height
    boxes = {text: text.get_window_extent() for text in texts}
    cut = [text.get_text() for text, box in boxes.items()
           if box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1]
    assert cut == []
    inner = [(text.get_text(), box.x0 + 1, box.x1 - 1, box.y0 + 1, box.y1 - 1) for text, box in boxes.items()]
    over = [(one[0], other[0]) for place, one in enumerate(inner) for other in inner[:place]
            if min(one[2], other[2]) > max(one[1], other[1]) and min(one[4], other[4]) > max(one[3], other[3])]
    assert over == []


def test_panels_have_letters_in_order(printed):
    named = [ax.get_title(loc="left") for ax in printed.axes if ax.get_title(loc="left")]
    letters = re.findall(r"\\bf\{([a-z])\}", " ".join(named))
    assert letters == (list("abcdefghijkl"[:len(named)]) if len(named) > 1 else [])
    panels = [ax for ax in printed.axes if ax.get_label() != "<colorbar>"]
    assert len(named) == len(panels) or len(panels) == 1


def lines(figure: plt.Figure, **wanted) -> list[Line2D]:
    """The lines and points of a figure, legends left out, whose properties are these."""
    return [line for ax in figure.axes for line in ax.get_lines() if len(line.get_xdata())
            and all(getattr(line, f"get_{name}")() == value for name, value in wanted.items())]


NAMED = {  # what a caption calls it -> whether it is drawn
    r"[Ww]hite dots": lambda figure: any(
        isinstance(dots, PathCollection) and dots.get_sizes().tolist() == [8] and len(dots.get_offsets())
        for ax in figure.axes for dots in ax.collections),
    r"dotted": lambda figure: lines(figure, linestyle=":", color="black"),
    r"[Dd]iamond": lambda figure: lines(figure, marker="D") and figure.get_label() != "statistics",  # "one shape a ..."
    r"[Qq]uestion marks": lambda figure: lines(figure, marker="$?$"),
    r"seen from above": lambda figure: any(isinstance(mesh, QuadMesh) for ax in figure.axes for mesh in ax.collections)
    or figure.get_label() in ("fig2_overview", "fig8_real_setup"),
    r"interval": lambda figure: any(isinstance(bars, ErrorbarContainer) for ax in figure.axes for bars in ax.containers)
    or figure.get_label() == "statistics",
    r"Rings": lambda figure: any(isinstance(dots, PathCollection) and dots.get_sizes().tolist() == [22]
                                 for ax in figure.axes for dots in ax.collections)
    and figure.get_label() != "fig3_dense",  # whose grasp points lie everywhere
    r"Open points": lambda figure: lines(figure, label="_pooled"),
    r"hollow": lambda figure: [line for line in lines(figure, marker="o") if to_hex(line.get_mfc()) == "#ffffff"
                               and line.get_label() != "_pooled"],
}


AXES = {  # what the axes of a picture are called, each name once, in the order of its panels
    "fig1_sparse": ("object x (cm)", "object y (cm)", "success (%)", "seeds that succeed, of 3",
                    "more seeds with MOVE"),
    "fig3_dense": ("object x (cm)", "object y (cm)", "success (%)", "timesteps", "seeds that succeed, of 3"),
    "fig4_efficiency": ("static's timesteps / MOVE's, same success",),
    "fig4_scaling": ("success (%)", "timesteps"),
    "fig5_circle": ("object x (cm)", "object y (cm)", "success (%)", "seeds that succeed, of 3"),
    "fig6_dimensions": ("what moves in the demonstrations", "success (%)"),
    "fig7_speed": ("object's speed (m per step)", "success (%)", "target's speed (m per step)",
                   "camera's speed (degrees per step)"),
    "table1_spatial_factors": ("what is random", "success (%)", "difference of success (points)"),
    "table2_main": ("success (%)", "difference of success (points)"),
    "table6_collection": ("timesteps a demonstration", "attempts that succeed (%)"),
    "claims": ("difference, rate or share, as the claim has it", "static's timesteps / MOVE's, same success"),
    "decided": ("difference of success (points)",),
    "few_demonstrations": ("timesteps of demonstrations", "success (%)"),
    "fifty_demonstrations": ("demonstrations", "success (%)", "timesteps / 72", "50 demonstrations"),
    "fig_coverage": ("cells that the data visit (%)", "success (%)"),
    "fig_mixture": ("timesteps by MOVE (%), the rest static", "success (%)"),
    "fig_speed_law": ("how the speeds are drawn, all with one mean", "success (%)"),
    "fig_training_length": ("gradient steps / the recipe's", "success (%)"),
    "gap": ("success (%)", "points"),
    "keypoint_control": ("timesteps of demonstrations", "success (%)"),
    "radius": ("distance to the nearest place seen (cm)", "success (%)", "predicted success (%)",
               "MOVE minus static (points)"),
    "statistics": ("trainings differ by (points, standard deviation)", "intervals that hold the truth (%)", "seeds",
                   "half width of the interval (points)"),
    "table_recipe": ("success (%)", "gain (points)"),
}


@pytest.mark.parametrize("name", AXES)
def test_an_axis_is_called_what_it_shows(name, lacking):
    found = [text for ax in picture(name, lacking).axes if ax.axison for text in (ax.get_xlabel(), ax.get_ylabel())]
    assert tuple(dict.fromkeys(filter(None, found))) == AXES[name]


def test_the_caption_names_the_marks_that_are_drawn_and_no_other(printed):
    text = captions.caption(words_of(printed.get_label())).text
    told = {mark: bool(re.search(mark, text)) for mark in NAMED}
    assert told == {mark: bool(there(printed)) for mark, there in NAMED.items()}


def test_a_legend_gives_each_method_and_verdict_its_own_colour(printed):
    known = {**{NAMES[method]: colour for method, colour in COLOURS.items()},
             **{verdict: to_hex(colour) for verdict, colour in VERDICT_COLOURS.items()}}
    legends = [*printed.legends, *(ax.get_legend() for ax in printed.axes if ax.get_legend())]
    for text, handle in ((text.get_text(), handle) for legend in legends
                         for text, handle in zip(legend.get_texts(), legend.legend_handles, strict=True)):
        colour = handle.get_color() if isinstance(handle, (Line2D, LineCollection)) else handle.get_facecolor()
        if text in known:
            assert to_hex(np.ravel(colour)[:3] if not isinstance(colour, str) else colour) == known[text], text


def test_every_letter_that_the_caption_names_is_a_panel(printed):
    panels = set(re.findall(r"\\bf\{([a-z])\}", " ".join(ax.get_title(loc="left") for ax in printed.axes)))
    told = re.findall(r"\(([a-z])(?:, ([a-z])| to ([a-z])| and ([a-z]))?\)", words_of(printed.get_label()).shown)
    assert {letter for letters in told for letter in letters if letter} <= panels


def test_what_comes_from_keypoints_says_so(lacking):
    for name in ("keypoint_control", "table_keypoint_control", "table2_main", "table_adc", "fig_perception"):
        assert any("keypoints" in text.get_text() for text in seen_texts(picture(name, lacking))), name

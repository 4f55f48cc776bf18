"""Figures 4, 6 and 7 ask for what they say: growing budgets, one motion after the other, one speed at a time."""

import math

import numpy as np
import pandas as pd
import pytest

from move.figures import (
    fig4_scaling,
    fig6_dimensions,
    fig7_speed,
    fig_speed_law,
    table1_spatial_factors,
    table2_main,
    tables,
)
from move.figures.page import parameters
from move.sim.collect import Collection, collect
from move.sim.motion.wrappers import Motions
from move.study.profiles import load_profile

LAPTOP = load_profile("laptop")


@pytest.mark.parametrize("method", ["static", "adc", "move"])
def test_a_larger_budget_begins_with_the_smaller_ones_demonstrations(method):
    small, large = (collect(Collection(task="pick-place", method=method, timesteps=size), seed=3)[0]
                    for size in (150, 400))
    whole = small.episode_ends[-2] if small.episodes > 1 else 0
    assert (large.observations[:150] == small.observations).all() and (large.actions[:150] == small.actions).all()
    assert large.timesteps == 400 and (small.episode_ends[:-1] <= 150).all() and whole < 150


def test_a_collection_holds_its_frames_once(monkeypatch):
    import tracemalloc

    collection = Collection(task="window-open", method="static", timesteps=450, observation="rgb", image_size=96)
    collect(collection.model_copy(update={"timesteps": 10}), 0)
    tracemalloc.start()
    made, _ = collect(collection, 0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    one_demonstration = 200 * 96 * 96 * 3
    assert made.observations.nbytes <= peak < made.observations.nbytes + 2 * one_demonstration


def test_figure_4_has_table_2s_runs_and_the_pairs_that_the_paper_calls_equal():
    runs = [run for run in fig4_scaling.runs(LAPTOP) if run.spec.training]
    table = {spec.hash for spec in parameters.specs("table2_main", LAPTOP)
             if spec.training and spec.observation == "rgb"}
    assert table <= {run.spec.hash for run in runs}
    asked = {(run.spec.task, run.spec.method, run.spec.collection.timesteps) for run in runs}
    assert {("pick-place", "static", 50_000), ("pick-place", "move", 20_000), ("assembly", "static", 100_000),
            ("assembly", "move", 50_000), ("pick-place-wall", "static", 100_000)} <= asked
    assert {size for task, _, size in asked if task == "window-open"} == {2500, 5000, 10_000, 20_000}
    assert len({run.spec.hash for run in runs}) == len(runs)


def test_figure_4_has_each_tasks_floor_and_ceiling_and_without_policies_nothing():
    controls = {(run.spec.task, run.spec.method) for run in fig4_scaling.runs(LAPTOP) if not run.spec.training}
    assert controls == {(spec.task, spec.method) for spec in parameters.specs("table2_main", LAPTOP)
                        if not spec.training}
    assert fig4_scaling.runs(LAPTOP, seeds=0, table_seeds=0) == []


def test_figure_6_adds_one_motion_after_the_other_and_ends_with_move():
    runs = fig6_dimensions.runs(LAPTOP, seeds=1)
    moving = {(run.spec.task, run.labels["moves"]): run.spec.collection.moving for run in runs}
    assert moving["pick-place", "object + target"] == ("object", "target")
    assert moving["assembly", "object + target + camera"] == ("object", "target", "camera")
    assert moving["pick-place", "camera alone"] == ("camera",)
    whole = {run.spec.hash for run in table2_main.runs(LAPTOP) if run.spec.method == "move"}
    for task, last in (("pick-place", "object + target + camera"), ("assembly", "object + target + camera + rotation")):
        assert {run.spec.hash for run in runs if (run.spec.task, run.labels["moves"]) == (task, last)} <= whole
    assert all(run.spec.method == "static" for run in runs if run.labels["moves"] == "nothing")


def test_figure_7_varies_one_speed_and_leaves_the_others():
    runs = [run for run in fig7_speed.runs(LAPTOP, seeds=1) if run.spec.method == "move"]
    for run in runs:
        used, usual = run.spec.collection.motions_used, Motions()
        assert used.speed_law == usual.speed_law
        changed = {name for name in vars(usual) if name.endswith("_speed")
                   and not math.isclose(getattr(used, name), getattr(usual, name))}
        part, speed = run.labels["part"], run.labels["speed"]
        assert changed == (set() if speed == fig7_speed.USUAL[part] else {f"{part}_speed"})
        shown = getattr(used, f"{part}_speed")
        assert math.isclose(math.degrees(shown) if part == "camera" else shown, speed)


def test_a_law_of_the_speeds_changes_the_law_alone():
    runs = {run.labels["law"]: run.spec for run in fig_speed_law.runs(LAPTOP, seeds=1)}
    beta = runs["beta"].collection
    assert {name: spec.method for name, spec in runs.items()} == {
        "static": "static", "beta": "move", "uniform": "move", "constant": "move"}
    for law in ("uniform", "constant"):
        assert runs[law].collection == beta.model_copy(update={"speed_law": law})
        assert (runs[law].training, runs[law].evaluation) == (runs["beta"].training, runs["beta"].evaluation)
        assert runs[law].collection.motions_used == Motions(speed_law=law)
    table2 = {run.spec.hash for run in table2_main.runs(LAPTOP)}
    assert {runs["static"].hash, runs["beta"].hash} <= table2


def test_laws_are_held_against_the_papers():
    rows = pd.DataFrame([{"law": law, "method": "static" if law == "static" else "move", "seed": seed, "trial": trial,
                          "success": trial < 100 * rate}
                         for law, rate in [("static", 0.2), ("beta", 0.5), ("uniform", 0.4), ("constant", 0.6)]
                         for seed in range(2) for trial in range(100)])
    table = fig_speed_law.law_table(rows)
    assert list(zip(table.law, table.baseline, table.difference.round(3), strict=True)) == [
        ("uniform", "beta", -0.1), ("constant", "beta", 0.1)]


def episodes(**rates) -> pd.DataFrame:
    rows = [{"task": "pick-place", "moves": name.replace("_", " "), "method": "static" if name == "nothing" else "move",
             "seed": seed, "trial": trial, "success": trial < 100 * rate}
            for name, rate in rates.items() for seed in range(3) for trial in range(100)]
    return pd.DataFrame(rows)


def test_each_rung_is_held_against_the_one_before_and_each_motion_alone_against_nothing():
    table = fig6_dimensions.step_table(episodes(nothing=0.2, object=0.3, both=0.7, camera_alone=0.5))
    assert list(zip(table.moves, table.baseline, table.difference.round(3), strict=True)) == [
        ("object", "nothing", 0.1), ("both", "object", 0.4), ("camera alone", "nothing", 0.3)]
    assert (table.holm >= table.p).all()


def test_what_every_random_factor_costs_static_is_held_against_the_object_alone():
    rows = pd.concat([episodes(object=rates[0]).assign(factors=factors, method=method)
                      for factors, *rates in (("object", 0.9), ("object+target", 0.8), ("all", 0.5))
                      for method in ("static", "move")])
    table = table1_spatial_factors.factor_table(rows)
    assert list(zip(table.method, table.factors, table.baseline, table.difference.round(3), strict=True)) == [
        ("static", "object+target", "object", -0.1), ("static", "all", "object", -0.4)]
    assert (table.low < table.difference).all() and (table.high > table.difference).all() and table.holm[1] < 0.01
    assert table1_spatial_factors.factor_table(rows[rows.factors != "object"]).empty


def test_an_efficiency_table_has_a_row_only_where_both_curves_are():
    rows = [{"task": task, "method": method, "timesteps": size, "seed": 0, "trial": trial,
             "success": trial < 100 * rate}
            for task, method, size, rate in [("push", "static", 10_000, 0.2), ("push", "static", 20_000, 0.4),
                                             ("push", "move", 10_000, 0.3), ("push", "move", 20_000, 0.4),
                                             ("hammer", "static", 20_000, 0.5), ("hammer", "move", 20_000, 0.5)]
            for trial in range(100)]
    table = fig4_scaling.efficiency_table(pd.DataFrame(rows), 20_000)
    assert list(table.task) == ["push"] and np.isclose(table.ratio[0], 1)
    assert "Median task 1; above 1 with its whole interval on 0 of 1" in fig4_scaling.efficiency_text(table)


def test_the_papers_points_stand_at_the_papers_budgets():
    printed = tables.printed_success(["box-close", "push"]).set_index(["task", "method"])
    assert tuple(printed.loc[("box-close", "move")]) == (0.417, 100_000)
    assert printed.loc[("push", "static"), "value"] == 0.163

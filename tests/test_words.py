"""What is said of the numbers: signs, counts and comparisons in words, on tables whose answers are written by hand."""

import numpy as np
import pandas as pd
import pytest
import recipes

from move.experiments import noise
from move.report import captions, covered, differences, efficiency, page, tables, variants
from move.sim.collect import Collection
from move.statistics.estimates import UNKNOWN
from move.study import results
from move.study.profiles import Profile, load_profile
from move.study.spec import PolicyRun

LAPTOP = load_profile("laptop")


def cells(rates: dict[tuple, float], columns: tuple[str, ...], seeds: int = 3, trials: int = 100) -> pd.DataFrame:
    """Episodes of each cell, of which the first share succeeds, the same in every seed."""
    return pd.DataFrame([{**dict(zip(columns, cell, strict=True)), "seed": seed, "trial": trial,
                          "success": trial < round(rate * trials)}
                         for cell, rate in rates.items() for seed in range(seeds) for trial in range(trials)])


def row(value: float, low: float, high: float, holm: float) -> pd.Series:
    return pd.Series({"difference": value, "low": low, "high": high, "holm": holm})


@pytest.mark.parametrize(("given", "said"), [
    (row(0.123, 0.031, 0.21, 0.01), "+12 points [+3, +21], above 0"),
    (row(-0.123, -0.21, -0.031, 0.01), "-12 points [-21, -3], below 0"),
    (row(0.123, 0.031, 0.21, 0.06), "+12 points [+3, +21], not distinguishable from 0"),
    (row(-0.001, -0.004, 0.004, 0.9), "+0 points [+0, +0], not distinguishable from 0"),
])
def test_a_difference_is_told_with_its_sign_and_the_word_that_holm_allows(given, said):
    assert differences.spoken_difference(given) == said


@pytest.mark.parametrize(("value", "low", "high", "published", "baseline", "half", "said"), [
    (0.2, 0.1, 0.3, 0.25, 0.4, 0.0, "reproduced"),
    (0.2, 0.1, 0.3, 0.45, 0.4, 0.0, "reproduced, smaller"),
    (0.2, 0.1, 0.3, 0.35, 0.4, 0.15, "reproduced"),  # the paper's noise
    (0.2, 0.1, 0.3, 0.05, 0.4, 0.0, "reproduced, larger"),
    (-0.2, -0.3, -0.1, 0.25, 0.4, 0.0, "refuted here"),
    (0.02, -0.1, 0.1, 0.25, 0.4, 0.0, "undecided"),
    (0.02, -0.04, 0.08, 0.25, 0.9, 0.0, "at the ceiling"),
])
def test_a_differences_verdict_is_the_ledgers(value, low, high, published, baseline, half, said):
    given = pd.Series({"difference": value, "low": low, "high": high, "paper": published})
    assert differences.difference_verdict(given, baseline, half) == said


def test_over_tasks_the_first_is_move_and_the_second_the_other_method():
    over = pd.DataFrame([{"baseline": "adc", "tasks": 4, "mean_difference": -0.1, "low": -0.2, "high": 0.02,
                          "iqm_first": 0.3, "iqm_second": 0.45, "iqm_low": -0.3, "iqm_high": 0.01,
                          "improvement": 0.25, "improvement_low": 0.1, "improvement_high": 0.6, "p_value": 0.25}])
    assert differences.spoken_tasks(over) == (
        "Over 4 tasks, taken as a sample of tasks, MOVE minus ADC is -10 points [-20, +2], of the interquartile means "
        "-15 [-30, +1]; MOVE is better on a task drawn at random with probability 0.25 [0.10, 0.60]; flipping the "
        "tasks' signs gives p = 0.250.")
    assert differences.spoken_tasks(over.iloc[:0]) == "Fewer than three tasks are stored."


def test_every_reading_is_held_against_the_one_as_printed_where_both_are():
    episodes = cells({("rgb", "push", "as printed"): 0.5, ("rgb", "push", "mended"): 0.4,
                      ("rgb", "hammer", "as printed"): 0.5, ("keypoints", "push", "as printed"): 0.1,
                      ("keypoints", "push", "periodic"): 0.4}, ("observation", "task", "jumping"))
    table = differences.reading_differences(episodes.assign(method="adc"), "observation", "jumping", "as printed",
                                     ["mended", "periodic"])
    found = [(line["observation"], line["jumping"], line["baseline"], line["items"], round(line["difference"], 6))
             for line in table.to_dict("records")]
    assert found == [("rgb", "mended", "as printed", 1, -0.1), ("keypoints", "periodic", "as printed", 1, 0.3)]


def test_a_speed_is_held_against_the_one_used_everywhere_else_and_a_share_against_none():
    speeds = cells({("object", 0.01): 0.3, ("object", 0.03): 0.5, ("object", 0.08): 0.4, ("nothing", 0.0): 0.1,
                    ("camera", 2.0): 0.9}, ("part", "speed")).assign(task="push", method="move")
    table = variants.speed_table(speeds)
    assert [(line.part, line.speed, line.baseline, round(line.difference, 6)) for line in table.itertuples()] == [
        ("object", 0.01, 0.03, -0.2), ("object", 0.08, 0.03, -0.1)]  # the camera's usual speed is not there
    shares = cells({(0.0,): 0.2, (0.5,): 0.5, (1.0,): 0.1}, ("share",)).assign(method="mixture")
    found = variants.share_table(shares)
    assert [(line.share, line.baseline, round(line.difference, 6)) for line in found.itertuples()] == [
        (0.5, 0.0, 0.3), (1.0, 0.0, -0.1)]
    assert variants.share_table(shares[shares.share > 0]).empty


def test_what_the_paper_calls_equal_is_move_at_the_smaller_budget_minus_static_at_the_larger():
    episodes = cells({("pick-place", "move", 20_000): 0.8, ("pick-place", "static", 50_000): 0.6,
                      ("pick-place", "static", 20_000): 0.1, ("assembly", "move", 50_000): 0.5},
                     ("task", "method", "timesteps"))
    table = efficiency.equal_budgets(episodes)
    assert list(table.task) == ["pick-place", "assembly"]
    assert list(table.move_timesteps) == [20_000, 50_000] and list(table.static_timesteps) == [50_000, 100_000]
    assert table.difference[0] == pytest.approx(0.2) and table.holm[0] == table.p[0] and np.isnan(table.difference[1])
    first, second = efficiency.spoken_equal(table).split("; ")
    assert first.startswith("Pick-Place, MOVE at 20,000 timesteps minus static at 50,000 (the paper: equal): +20 poin")
    assert first.endswith("above 0")
    assert second == "Assembly, MOVE at 50,000 timesteps minus static at 100,000 (the paper: equal): not computed yet"
    others = efficiency.equal_budgets(episodes.assign(task="push"))
    assert others.empty and efficiency.spoken_equal(others).startswith("None of these tasks")


def test_an_efficiency_is_told_task_by_task_and_by_its_median():
    table = pd.DataFrame([
        {"task": "push", "timesteps": 20_000, "ratio": 2.0, "low": 1.5, "high": 3.0, "least": 0.25, "most": 2.0,
         "holm": 0.01},
        {"task": "hammer", "timesteps": 20_000, "ratio": 0.5, "low": 0.4, "high": 1.2, "least": 0.25, "most": 2.0,
         "holm": 1.0},
        {"task": "assembly", "timesteps": 20_000, "ratio": np.inf, "low": 0.9, "high": np.inf, "least": 0.25,
         "most": 2.0, "holm": 0.06}])
    said = efficiency.spoken_efficiency(table)
    assert "Push 2 [1.5, " in said and "Hammer 0.5 [0.4, 1.2]" in said and "Assembly > 2 [0.9, > 2]" in said
    assert said.endswith("Median task 2; above 1 with its whole interval on 1 of 3, after Holm's adjustment on 1.")
    said = efficiency.spoken_efficiency(table.assign(low=1.1, holm=[0.01, 0.2, 0.05]))
    assert said.endswith("on 3 of 3, after Holm's adjustment on 1.")
    assert "Median task > 2;" in efficiency.spoken_efficiency(table.iloc[[2, 2, 0]])
    bounded = pd.concat([table, table.iloc[[2]].assign(most=1.0, task="basketball")])  # 2, 0.5, > 2, > 1
    assert "Median task between 1.5 and 2" not in efficiency.spoken_efficiency(bounded)
    assert "Median task > 1.5;" in efficiency.spoken_efficiency(bounded)
    assert "Median task between 1 and 2;" in efficiency.spoken_efficiency(bounded.iloc[[0, 1, 3]])
    assert efficiency.spoken_efficiency(table.iloc[:0]) == "No task has two budgets of both methods yet."


# coverage ------------------------------------------------------------------------------------------------------------


def run(task: str, method: str, seed: int = 0, timesteps: int = 5000, **labels) -> results.Result:
    spec = PolicyRun(task=task, seed=seed, training=recipes.keypoints(),
                     collection=Collection(task=task, method=method, timesteps=timesteps))
    return results.Result(spec, [{"success": True}] * 4, {"demonstrations": 10 + seed},
                          {"curve": [(1, 0.1)]}, {"collect": 30.0, "train": 60.0, "evaluate": 30.0}, {}, labels)


def test_coverage_is_measured_once_a_cell_on_the_first_seeds_data_and_stands_beside_its_success(monkeypatch):
    collected = []

    def configurations(collection, seed):
        collected.append((collection.method, collection.timesteps, seed))
        return collection.method

    monkeypatch.setattr(covered.coverage, "configurations", configurations)
    monkeypatch.setattr(covered.coverage, "visited_joint_share", lambda seen, task: {"static": 0.1, "move": 0.6}[seen])
    monkeypatch.setattr(covered.coverage, "visited_share", lambda seen, task, part: {"static": 0.2, "move": 0.9}[seen])
    runs = [run("push", method, seed, moves=moves) for seed in (0, 1)
            for method, moves in (("static", "nothing"), ("move", "all"))]
    episodes = cells({("push", "nothing", "static"): 0.3, ("push", "all", "move"): 0.8}, ("task", "moves", "method"))
    done = []
    table = covered.coverage_table(runs, episodes, 2000, on_cell=lambda *counts: done.append(counts)).set_index("moves")
    assert sorted(collected) == [("move", 2000, 0), ("static", 2000, 0)] and done == [(1, 2), (2, 2)]
    assert table.joint.to_dict() == {"nothing": 0.1, "all": 0.6}
    assert table.camera.to_dict() == {"nothing": 0.2, "all": 0.9}
    assert table.value.to_dict() == pytest.approx({"nothing": 0.3, "all": 0.8})


def test_within_tasks_the_tasks_own_levels_do_not_count():
    """Three tasks of other levels; in each, success rises by as much as coverage: by 25, 50 and 75 points."""
    table = pd.DataFrame([
        {"task": task, "moves": moves, "method": "move", "joint": covered_share, "value": level + covered_share}
        for task, level, gain in (("push", 0.25, 0.25), ("hammer", -0.125, 0.5), ("assembly", 0.0, 0.75))
        for moves, covered_share in (("nothing", 0.125), ("all", 0.125 + gain))])
    said = covered.spoken_coverage(table)
    assert said.startswith("Within tasks (6 cells of 3) success and joint coverage have the rank correlation +1.00")
    assert ("over 3 tasks MOVE covers +25 to +75 points more than static, and that gain and its gain in success "
            "(+25 to +75 points) have +1.00") in said
    falling = covered.spoken_coverage(table.assign(value=-table.value))
    assert "rank correlation -1.00" in falling and "(-75 to -25 points) have -1.00" in falling
    assert covered.spoken_coverage(table[:1]) == "Fewer than three cells are stored."


# what stands behind --------------------------------------------------------------------------------------------------


def test_a_run_that_stands_in_two_conditions_counts_once():
    shared, other = run("push", "move", equal="timesteps"), run("push", "static", equal="timesteps")
    again = results.Result(shared.spec, shared.rows, shared.collection, shared.training, shared.seconds, {},
                           {"equal": "demonstrations"})
    lost = run("push", "static", seed=1).spec
    loaded = page.Loaded(LAPTOP, [shared, other, again], pd.DataFrame(), [(lost, "not computed yet")])
    assert loaded.behind == ("It rests on 1 seed a method and condition, 4 evaluation episodes a seed; 1 of 3 runs are "
                             "missing.")
    assert "8 in all. 2 runs, 4 minutes in all" in loaded.source and "1 of 3 runs are missing" in loaded.remark


def test_runs_that_share_a_training_have_its_minutes_once():
    one = run("push", "move")
    moving = one.spec.model_copy(update={"evaluation": one.spec.evaluation.model_copy(update={"starts": "moving"})})
    both = [one, results.Result(moving, one.rows, one.collection, one.training, one.seconds, {})]
    assert one.spec.policy_hash == moving.policy_hash and one.spec.hash != moving.hash
    assert "2 runs, 3 minutes in all" in captions.numbers(both, 0, "")  # 60 s once, and twice 60 s


def test_costs_are_the_median_run_of_a_method_and_budget_in_minutes():
    runs = [run("push", "move", seed) for seed in range(3)]
    runs[2].seconds["train"] = 600.0
    (line,) = tables.run_costs([*runs, run("push", "static")]).query("method == 'move'").to_dict("records")
    assert (line["collect"], line["train"], line["evaluate"], line["whole"]) == (0.5, 1.0, 0.5, 2.0)
    assert (line["runs"], line["all_runs"]) == (3, 15.0)


def test_pairs_of_real_cells_have_the_methods_names_and_sizes():
    table = pd.DataFrame({"first": ["static 35k"], "second": ["move 75k"], "fisher": [0.002]})
    assert tables.printed_pairs(table)[["first", "second"]].values.tolist() == [["static 35k", "MOVE 75k"]]


@pytest.mark.parametrize("observation", ["rgb", "keypoints"])
@pytest.mark.parametrize("grid", [False, True])
def test_the_noise_of_a_figure_is_that_of_all_cells_that_are_tried_alike(observation, grid, monkeypatch):
    asked = []
    monkeypatch.setattr(noise, "split", lambda specs, folder: (asked.extend(specs) or [], []))
    assert noise.known_noise(LAPTOP, observation, grid) is UNKNOWN
    assert {(spec.observation, spec.evaluation.starts == "grid") for spec in asked} == {(observation, grid)}
    assert len({spec.task for spec in asked}) == (1 if grid else 10) and all(spec.training for spec in asked)


def test_nothing_is_known_of_the_noise_without_a_recipe_or_from_one_seed(tmp_path, monkeypatch):
    assert noise.known_noise(load_profile("laptop-keypoints"), "rgb") is UNKNOWN
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    assert noise.known_noise(LAPTOP, "rgb") is UNKNOWN

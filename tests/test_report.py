"""Statistics against slow or known answers; tables; and plots that draw what the table says."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
import recipes  # noqa: E402

from move import (
    experiments,  # noqa: E402
    )
from move.report import captions, differences, maps, page, plots, printed, style, tables  # noqa: E402
from move.sim.collect import Collection  # noqa: E402
from move.sim.configuration import Disc  # noqa: E402
from move.sim.tasks import TASKS  # noqa: E402
from move.statistics import estimates as statistics  # noqa: E402
from move.statistics.cells import training_noise  # noqa: E402
from move.study import results  # noqa: E402
from move.study.labels import LabelledRun  # noqa: E402
from move.study.profiles import Profile, load_profile  # noqa: E402
from move.study.spec import CollectionRun, PolicyRun  # noqa: E402


def episodes(rates: dict[str, float], seeds: int = 3, trials: int = 16) -> pd.DataFrame:
    rng = np.random.default_rng(0)
    side = int(trials**0.5)
    return pd.DataFrame([
        {"method": method, "seed": seed, "trial": trial, "success": bool(rng.random() < rate), "group": "grid",
         "object_x": trial % side * 0.1, "object_y": trial // side * 0.1, "timesteps": 100}
        for method, rate in rates.items() for seed in range(seeds) for trial in range(trials)
    ])


def test_one_seed_is_judged_by_the_noise_of_cells_with_several_and_an_agent_without_training_by_none():
    several, one = episodes({"static": 0.5}, seeds=4, trials=64), episodes({"move": 0.5, "expert": 0.5}, 1, trials=64)
    several["success"] ^= (several.seed == 0) & (several.trial % 2 == 0)  # a training that is unlike the others
    table = tables.rate_table(pd.concat([several, one]), ["method"]).set_index("method")
    alone = tables.rate_table(one, ["method"]).set_index("method")
    assert table.trainings.to_dict() == {"static": "moderated", "move": "like cells", "expert": "none"}
    assert alone.trainings.to_dict() == {"move": "unknown", "expert": "none"}
    assert table.low["move"] < alone.low["move"] and table.low["expert"] == alone.low["expert"]


def test_what_is_known_of_the_noise_comes_before_a_tables_own_few_cells():
    cells = episodes({"static": 0.2, "move": 0.8}, seeds=2, trials=64)
    known = statistics.TrainingNoise(0.02, 25)
    assert training_noise(cells, ["method"], known) == known
    assert training_noise(cells, ["method"]).repeats == 2
    own, pooled = (tables.rate_table(cells, ["method"], noise) for noise in (statistics.UNKNOWN, known))
    assert ((pooled.high - pooled.low) > (own.high - own.low)).all()


def test_words_hold_after_holm():
    items = [three_methods(name, 0.2).assign(task=name) for name in "abcdefghij"]
    compared = differences.difference_table(pd.concat(items), "task", ("static",)).assign(
        low=0.01, high=0.3, difference=0.15, p=0.03)
    compared["holm"] = statistics.holm(compared.p)
    assert "not distinguishable" in differences.spoken_difference(compared.iloc[0])
    means = differences.difference_means(pd.concat(items), "task")
    assert "above static on 0 of 10" in differences.spoken_differences(compared, means)


def test_the_table_over_tasks_has_the_task_as_its_unit():
    both = pd.concat([three_methods(task, 0.9) for task in ("push", "hammer", "assembly", "basketball")])
    table = differences.tasks_table(both).set_index("baseline")
    assert table.tasks.tolist() == [4, 4] and table.loc["static"].improvement == 1.0
    assert table.loc["static"].p_value == pytest.approx(2 / 2**4)
    assert "p = 0.125" in differences.spoken_tasks(table.reset_index())
    assert differences.tasks_table(both[both.task == "push"]).empty


def test_the_heatmap_shows_each_cell_where_its_object_was():
    data = episodes({"static": 0.5}, seeds=1)
    data["success"] = (data.object_x > 0.25) & (data.object_y < 0.05)  # one cell only
    _, ax = plt.subplots()
    values = maps.heatmap(data, ax).get_array().reshape(4, 4)
    assert values[0, 3] == 1 and values.sum() == 1


def test_a_saved_figure_is_the_same_file_every_time(tmp_path):
    style.use_style()
    written = []
    for folder in ("a", "b"):
        figure, ax = plt.subplots()
        ax.plot([0, 1])
        style.save(figure, "f", tmp_path / folder)
        written.append([(tmp_path / folder / f"f.{kind}").read_bytes() for kind in ("pdf", "png")])
    assert written[0] == written[1]


def test_a_figure_is_saved_alike_whether_or_not_it_has_been_shown(tmp_path):
    style.use_style()
    written = []
    for shown in ((), (150,), (72, 200, 150)):
        figure, panels = plt.subplots(1, 3, figsize=(style.PAGE_WIDTH, 2.3))
        for ax in panels:
            ax.set(aspect="equal", xlabel="object x (m)", title="a panel")
        figure.colorbar(panels[0].imshow(np.eye(3)), ax=panels[2], label="success rate")
        for dpi in shown:
            figure.set_dpi(dpi)
            figure.canvas.draw()
        folder = tmp_path / str(len(shown))
        style.save(figure, "f", folder)
        written.append([(folder / f"f.{kind}").read_bytes() for kind in ("pdf", "png")])
    assert written[0] == written[1] == written[2]


def a_scene(levels: int, folder, size: float = 1.0, title: str = "Scene") -> list[bytes]:
    """What is in `folder` once a grey scene is saved there, one pixel of which is so many levels brighter."""
    image = np.full((40, 40, 3), 100, np.uint8)
    image[20, 20] += levels
    figure = plt.figure(figsize=(size, size))
    figure.figimage(image, resize=False)
    style.save(figure, "f", folder, captions.Caption(title, "Drawn.", "Grey.", "A scene."))
    return [(folder / f"f.{kind}").read_bytes() for kind in ("pdf", "png")]


def test_a_picture_that_differs_by_less_than_can_be_seen_is_left_as_it_is(tmp_path):
    first = a_scene(0, tmp_path)
    assert a_scene(2, tmp_path) == first, "another machine draws a pixel a level or two apart"
    for changed in (a_scene(3, tmp_path), a_scene(0, tmp_path, size=1.1), a_scene(0, tmp_path, title="Another")):
        assert changed[0] != first[0] and changed[1] != first[1]


def test_a_picture_is_written_where_one_of_its_files_is_missing_or_none(tmp_path):
    first = a_scene(0, tmp_path)
    for file, what in (("f.pdf", None), ("f.png", None), ("f.png", b"none"), ("f.png", first[1][:80])):
        (tmp_path / file).unlink()
        if what is not None:
            (tmp_path / file).write_bytes(what)
        assert a_scene(0, tmp_path) == first, (file, what)


def collector(method: str, outcomes: list[tuple[bool, int]]) -> results.Result:
    collection = Collection(task="hammer", method=method, timesteps=1)
    spec = CollectionRun(task="hammer", seed=0, collection=collection)
    rows = [{"trial": number, "group": "attempt", "success": success, "steps": steps}
            for number, (success, steps) in enumerate(outcomes)]
    return results.Result(spec, rows, None, None, {}, {})


def test_collection_costs_count_all_attempts_but_only_successful_steps():
    table = tables.collection_costs([collector("static", [(True, 80), (True, 100), (False, 200)])])
    assert table.loc[0, "generation_rate"] == pytest.approx(2 / 3) and table.loc[0, "mean_steps"] == 90
    assert table.loc[0, "low"] < 2 / 3 < table.loc[0, "high"]
    assert np.isnan(tables.collection_costs([collector("move", [(False, 200)])]).loc[0, "mean_steps"])


def test_table_5_is_the_papers_and_counts_demonstrations():
    costs = pd.DataFrame([{"task": name, "method": method, "expert": "phase", "mean_steps": 100.0}
                          for name in TASKS for method in ("static", "adc", "move")])
    table = tables.data_sizes(costs)
    assert table.timesteps.tolist() == table.paper.tolist()
    assert table.paper[table.task == "Box-Close"].tolist() == [100_000]
    assert table["static demonstrations"].tolist() == [size / 100 for size in table.timesteps]


def test_table_4_agrees_with_the_paper_where_it_should():
    table = tables.hyperparameters([load_profile("laptop"), load_profile("paper")]).set_index("hyperparameter")
    for name in ("prediction horizon", "action horizon", "observation horizon", "denoising steps in training",
                 "denoising steps in inference", "batch size"):
        assert table.loc[name, "paper"] == table.loc[name, "paper, simulation"]
    assert table.loc["gradient steps", "paper"] == "220000"


def test_the_shipped_table_4_is_that_of_the_profiles():
    laptop, other = load_profile("laptop"), load_profile("paper")
    shipped = pd.read_csv(laptop.figures / "table4_hyperparameters.csv", dtype=str, keep_default_na=False)
    drawn = tables.hyperparameters([laptop, other])
    told = {name: shipped[name].tolist() == drawn[name].tolist() for name in drawn}
    assert told == dict.fromkeys(drawn, True)


def test_kept_shares_name_the_tasks_with_a_limited_reach():
    shares = tables.acceptance_rates(np.random.default_rng(0), 50).set_index("task").acceptance_rate
    assert shares["pick-place"] == 1.0 and shares["window-open"] < 1.0 and shares.between(0, 1).all()


# differences ---------------------------------------------------------------------------------------------------------


def test_it_tells_what_a_policy_loses_away_from_its_own_grasps():
    outcomes = {("static", "grasp"): [1, 1, 1, 0], ("static", "random"): [1, 0, 0, 0], ("move", "random"): [1, 1, 0, 0]}
    episodes = pd.DataFrame([{"task": "push", "method": method, "group": group, "seed": 0, "trial": trial,
                              "success": success}
                             for (method, group), successes in outcomes.items()
                             for trial, success in enumerate(successes)])
    rates = tables.rate_table(episodes, ["task", "method", "group"])
    wide = tables.own_and_elsewhere(rates).set_index("method")
    assert wide.loc["static", ["own", "elsewhere", "lost"]].tolist() == [0.75, 0.25, 0.5]
    assert np.isnan(wide.loc["move"].lost) and wide.loc["move"].elsewhere == 0.5
    _, ax = plt.subplots()
    plots.own_and_elsewhere(rates, ax)
    hollow = [line for line in ax.get_lines() if line.get_marker() == "o" and line.get_mfc() == "white"]
    assert [line.get_ydata()[0] for line in hollow] == [0.75]  # and none for MOVE, whose own is missing


def three_methods(task: str, move: float) -> pd.DataFrame:
    return episodes({"static": 0.2, "adc": 0.5, "move": move}, seeds=3, trials=64).assign(task=task)


def test_the_table_of_differences_names_the_winner_on_each_item_and_on_the_mean():
    both = pd.concat([three_methods("a", 0.95), three_methods("b", 0.2)])
    table, means = differences.difference_table(both, "task"), differences.difference_means(both, "task")
    assert list(zip(table.task, table.baseline, strict=True)) == [
        ("a", "static"), ("a", "adc"), ("b", "static"), ("b", "adc")]
    assert means.baseline.tolist() == ["static", "adc"] and means["items"].tolist() == [2, 2]
    above, _, _, below = table.itertuples()
    mean = means.iloc[0]
    assert above.low > 0 and below.high < 0
    assert mean.difference == pytest.approx(table[table.baseline == "static"].difference.mean())
    assert "above 0" in differences.spoken_difference(table.iloc[0])
    assert "below 0" in differences.spoken_difference(table.iloc[3])
    spoken = differences.spoken_differences(table, means)
    assert "above static on 1 of 2" in spoken and "below it on 1" in spoken
    assert f"on the mean {differences.spoken_difference(mean)}" in spoken
    _, ax = plt.subplots()
    plots.differences(table, "task", ["a", "b"], ax, means)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["a", "b", "mean of 2"]
    static = table[table.baseline == "static"]
    assert ax.containers[0].lines[0].get_xdata().tolist() == [*static.difference, mean.difference]


def test_the_papers_difference_stands_beside_ours_on_the_same_items():
    both = pd.concat([three_methods("push", 0.9), three_methods("hammer", 0.9)])
    compared = differences.difference_table(both, "task", ("static",))
    table = tables.with_paper(compared, "table2_main", on=["task", "baseline"], metric="difference")
    assert table.paper.tolist() == pytest.approx([0.410 - 0.163, 0.309 - 0.156])


def test_two_readings_are_compared_on_the_tasks_that_have_both():
    one = episodes({"adc": 0.9}, trials=64).assign(jumping="mended")
    other = episodes({"adc": 0.2}, trials=64).assign(jumping="as printed")
    both = pd.concat([one.assign(task="push"), other.assign(task="push"), one.assign(task="hammer")])
    found = differences.reading_difference(both, "jumping", "mended", "as printed")
    assert found["items"] == 1 and found.low > 0
    assert found.difference == pytest.approx(one.success.mean() - other.success.mean())
    assert differences.reading_difference(both, "jumping", "periodic", "mended").empty


def test_a_method_that_is_missing_leaves_no_difference():
    half = three_methods("a", 0.9)
    table = differences.difference_table(half[half.method != "adc"], "task")
    assert list(table.baseline) == ["static"]
    assert differences.difference_table(half[half.method == "adc"], "task").empty
    means = differences.difference_means(half, "task")
    nothing = differences.difference_table(half[half.method == "adc"], "task")
    assert means.empty and differences.spoken_differences(nothing, means) == "nothing is stored yet."


def test_cells_are_inside_the_circle_by_their_centre():
    grid = episodes({"move": 0.5}, seeds=1, trials=16)
    where = tables.inside_and_outside(grid, Disc((0.0, 0.0), 0.15)).set_index("trial")["where"]
    assert {trial for trial, side in where.items() if side == "inside"} == {0, 1, 4, 5}  # 0.0 and 0.1 m on both axes


def test_plots_draw_one_mark_a_row_and_survive_a_missing_method():
    rates = pd.DataFrame([
        {"where": where, "method": method, "value": 0.5, "low": 0.4, "high": 0.6, "paper": 0.3, "seeds": [0.5]}
        for where, method in (("inside", "static"), ("inside", "move"), ("outside", "move"))])
    _, ax = plt.subplots()
    plots.grouped_rates(rates, "where", ["inside", "outside"], ax)
    assert len(ax.patches) == 3
    _, ax = plt.subplots()
    plots.differences(differences.difference_table(three_methods("a", 0.9), "task"), "task", ["a"], ax)
    assert len(ax.containers) == 2
    _, ax = plt.subplots()
    table = differences.difference_table(three_methods("push", 0.9), "task").assign(paper=0.2)
    plots.differences(table, "task", ["push"], ax)
    assert [line.get_xdata().tolist() for line in ax.lines if line.get_marker() == "D"] == [[0.2], [0.2]]
    _, ax = plt.subplots()
    nothing = differences.difference_table(three_methods("a", 0.9).query("method == 'adc'"), "task")
    plots.differences(nothing, "task", [], ax)
    assert not ax.containers


def test_a_figure_drawn_from_what_is_stored_runs_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("MOVE_STORED_ONLY", "1")
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    stored = collector("static", [(True, 10)])
    results.store(stored, tmp_path)
    monkeypatch.setattr(results, "read", lambda path: stored)  # a toy, whose file would be refused
    other = stored.spec.model_copy(update={"seed": 5})
    monkeypatch.setattr(page, "execute", lambda *arguments: pytest.fail("something was run"))
    loaded = page.load_or_run([LabelledRun(stored.spec), LabelledRun(other)], load_profile("smoke"))
    assert len(loaded.results) == 1 and loaded.missing == [(other, "not computed yet")]
    assert "1 more run missing" in loaded.source and loaded.remark == "1 of 2 runs are missing"
    assert "1 of 2 runs are missing" in loaded.behind


def test_a_picture_from_keypoints_says_so_and_so_does_its_caption():
    spec = PolicyRun(task="push", seed=0, training=recipes.keypoints(),
                   collection=Collection(task="push", method="move", timesteps=2500))
    both = [results.Result(spec.model_copy(update={"seed": seed}), [{"success": True}] * 4, None, None,
                           {"train": 60.0 + seed}, {}) for seed in range(2)]
    loaded = page.Loaded(load_profile("laptop"), both, pd.DataFrame(), [])
    assert loaded.remark == "from keypoints: perception is given"
    assert loaded.source.startswith("From keypoints (perception is given). 2,500 timesteps a data set. 2 seeds a")
    assert "4 evaluation episodes a seed, 8 in all. 2 runs, 2 minutes in all" in loaded.source
    assert "smaller networks" in loaded.source and "no run is missing" in loaded.behind
    untrained = captions.numbers([collector("static", [(True, 10)] * 3)], 0, "smaller networks")
    assert "smaller networks" not in untrained and "1 runs, 3 attempts each" in untrained


# tables for people ---------------------------------------------------------------------------------------------------


def test_a_readable_table_is_in_per_cent_and_points_with_human_names_and_no_nan():
    table = pd.DataFrame([
        {"task": "disassemble", "method": "move", "value": 0.5, "low": 0.4, "high": 0.61234, "seeds": [0.5, 1 / 3],
         "episodes": 1000, "paper": np.nan},
        {"task": "pick-place", "method": "adc", "value": 1.0, "low": 0.9, "high": 1.0, "seeds": [1.0],
         "episodes": 100, "paper": 0.447}])
    shown = tables.readable(table)
    assert list(shown) == ["Task", "Method", "Success (%)", "Each seed (%)", "Episodes", "Paper (%)"]
    assert shown.values.tolist() == [["Disassembly", "MOVE", "50.0 [40.0, 61.2]", "50.0, 33.3", "1,000", "—"],
                                     ["Pick-Place", "ADC", "100.0 [90.0, 100.0]", "100.0", "100", "44.7"]]
    compared = pd.DataFrame([{"baseline": "static", "difference": -0.012, "low": -0.1, "high": 0.08, "p": 0.0001,
                              "paper": 0.08}])
    assert tables.readable(compared).values.tolist() == [["static", "−1.2 [−10.0, +8.0]", "<0.001", "+8.0"]]
    assert tables.readable(compared.iloc[:0]).values.tolist() == [["not computed yet"]]
    assert "Pick-Place" in tables.shown(table).to_html() and "NaN" not in tables.shown(table).to_html()


@pytest.mark.parametrize("path", sorted(load_profile("laptop").figures.glob("*.csv")),
                         ids=lambda path: path.stem)
def test_every_shipped_table_can_be_shown(path):
    """No heading is a variable's name, no cell is NaN or a list; the CSV itself stays tidy."""
    table = pd.read_csv(path)
    text = tables.readable(table.assign(seeds=[[float(one) for one in str(cell).split()] for cell in table.seeds])
                           if {"value", "seeds"} <= set(table) else table)
    assert not [heading for heading in text if "_" in heading]
    assert not [cell for cell in text.to_numpy().ravel() if cell in ("nan", "NaN") or cell.startswith("[")]
    assert not any("[" in str(cell) for name in table if name != "evidence" for cell in table[name])


def test_a_table_is_written_tidy_and_printed_with_caption_and_label(tmp_path):
    table = pd.DataFrame([{"method": "move", "value": 0.5, "low": 0.4, "high": 0.6, "seeds": [0.5, 0.4]}])
    printed.save(table, "fig1_sparse", tmp_path, source="seven & three %")
    assert pd.read_csv(tmp_path / "fig1_sparse.csv").seeds.tolist() == ["0.5 0.4"]
    text = (tmp_path / "fig1_sparse.tex").read_text()
    assert r"\caption{Figure 1" in text and r"Seven \& three \%.}" in text and r"\label{tab:fig1_sparse}" in text
    assert r"MOVE & 50.0 [40.0, 60.0] & 50.0, 40.0" in text
    long = printed.latex(tables.readable(pd.concat([table] * 60)), "fig1_sparse")
    assert "longtable" in long and r"\begin{table" not in long


def test_the_printed_table_2_has_the_papers_columns_and_the_mean_row():
    rates = pd.DataFrame([{"task": task, "method": method, "value": 0.2, "low": 0.1, "high": 0.3, "paper": 0.4}
                          for task in ("push", "hammer") for method in ("static", "move")])
    means = pd.DataFrame({"method": ["static", "move"], "value": [0.2, 0.2], "paper": [0.222, 0.391]})
    wide = tables.beside(rates, pd.DataFrame({"expert": [1.0]}, index=["push"]), means)
    assert wide["Task", ""].tolist() == ["Push", "Hammer", "mean of 2"]
    assert wide["MOVE", "paper"].tolist() == ["40.0", "40.0", "39.1"]
    assert wide["expert", ""].tolist() == ["100.0", "—", "—"]
    assert wide["static", "here"].tolist() == ["20.0 [10.0, 30.0]"] * 2 + ["20.0"]


def test_what_is_missing_stands_in_its_place():
    profile = load_profile("laptop")
    runs = experiments.runs("fig_mixture", profile)
    there = pd.DataFrame([{"share": 1.0, "method": "move", "value": 0.8, "low": 0.7, "high": 0.9, "seeds": [0.8]}])
    table = tables.with_missing(there, runs, ["share", "method"])
    assert table.share.tolist() == sorted({run.labels["share"] for run in runs})
    assert table.value.notna().tolist() == [False] * (len(table) - 1) + [True]
    assert table.seeds.tolist() == [[]] * (len(table) - 1) + [[0.8]]


def test_comparisons_are_counted_after_holm():
    table = pd.DataFrame({"difference": [0.2, -0.2, 0.1], "holm": [0.01, 0.01, 0.5]})
    assert differences.spoken_counts(table) == "1 of 3 are above 0, 1 below, 1 not distinguishable from it"


def test_a_table_is_told_with_what_it_says_of_the_papers_and_an_empty_one_as_such():
    rates = pd.DataFrame({"method": ["static", "move"], "value": [0.2, 0.452], "paper": [0.1, 0.5]})
    assert differences.spoken_rates(rates) == "static 20.0%, MOVE 45.2%"
    assert differences.spoken_rates(rates, "paper") == "static 10.0%, MOVE 50.0%"
    assert differences.spoken_rates(rates[:0]) == "nothing is computed yet"
    table = pd.DataFrame({"where": ["inside", "outside"], "baseline": "static", "difference": [0.25, -0.02],
                          "low": [0.1, -0.1], "high": [0.4, 0.06], "holm": [0.01, 0.6], "paper": [0.6, 0.2]})
    baselines = pd.DataFrame({"where": ["inside", "outside"], "method": "static", "value": [0.3, 0.9]})
    inside, outside = differences.spoken_verdicts(table, baselines, "where").split("; ")
    assert inside == "inside MOVE minus static +25 points [+10, +40], above 0: reproduced, smaller"
    assert outside.startswith("outside MOVE minus static -2 points") and outside.endswith(": at the ceiling")
    alone = baselines[:1].drop(columns="where")
    assert differences.spoken_verdicts(table[:1], alone).startswith("MOVE minus static +25")
    assert differences.spoken_verdicts(table[:0], baselines, "where") == "there is nothing to compare yet"


def test_what_is_not_counted_of_the_data_sizes_is_absent_and_the_rest_is_there():
    costs = pd.DataFrame([{"task": "push", "method": method, "expert": "phase", "mean_steps": steps}
                          for method, steps in (("static", 80.0), ("move", 100.0))])
    sizes = tables.data_sizes(costs).set_index("task")
    assert (sizes.loc["Push", "static demonstrations"], sizes.loc["Push", "move demonstrations"]) == (250, 200)
    assert sizes["adc demonstrations"].isna().all() and sizes.loc["Hammer"].isna().sum() == 3
    assert tables.run_costs([]).empty

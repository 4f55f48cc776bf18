"""Around the marks of whole figures: titles, legends, axes that are named once, and sizes that follow the panels."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402

from move.paper import PAPER_METHODS, PAPER_TASKS  # noqa: E402
from move.report import figures, plots, style  # noqa: E402
from move.sim.tasks import TASKS, get_task  # noqa: E402

TITLES = [TASKS[task].title for task in PAPER_TASKS]
LABELS = {"object": "object", "all": "+ camera"}
GREY = "#444444"


@pytest.fixture(autouse=True)
def close():
    yield
    plt.close("all")


def rates(methods=("static", "move"), missing: bool = False, **columns) -> pd.DataFrame:
    index = pd.MultiIndex.from_product([*columns.values(), methods], names=[*columns, "method"])
    table = pd.DataFrame({"value": 0.5, "low": 0.4, "high": 0.6, "paper": 0.3, "seeds": [[0.5]] * len(index)}, index)
    table = table.reset_index()
    if missing:
        table.loc[0, ["value", "low", "high"]] = np.nan
    return table


def grid() -> pd.DataFrame:
    return pd.DataFrame([{"method": method, "group": group, "object_x": 0.1 * x, "object_y": 0.1 * y, "seed": seed,
                          "success": True} for method in ("static", "move") for group in ("grid", "point")
                         for x in range(2) for y in range(2) for seed in range(4)])


HANDS = ["anywhere", "within 3 cm", "one place"]


def titles(figure: plt.Figure) -> list[str]:
    return [ax.get_title(loc="left").split("$   ")[-1] for ax in figure.axes if ax.get_title(loc="left")]


def legend(figure: plt.Figure) -> list[str]:
    """What the legend over the figure names."""
    (shown,) = figure.legends
    return [text.get_text() for text in shown.get_texts()]


def beside(ax: plt.Axes) -> list[str]:
    """What a panel's own legend names."""
    return [text.get_text() for text in ax.get_legend().get_texts()]


def ylabels(figure: plt.Figure) -> list[str]:
    return [ax.get_ylabel() for ax in figure.axes]


def test_a_letter_stands_before_each_title_but_not_before_a_single_one():
    figure, axes = plt.subplots(1, 3)
    style.titles(axes, ["one", "two", "three"])
    assert [ax.get_title(loc="left") for ax in axes] == [
        r"$\bf{a}$   one", r"$\bf{b}$   two", r"$\bf{c}$   three"]
    figure, ax = plt.subplots()
    style.titles([ax], ["alone"])
    assert ax.get_title(loc="left") == "alone"
    with pytest.raises(ValueError):
        style.titles([ax], ["one", "too many"])


def test_a_stamp_lies_behind_the_marks_and_shrinks_with_the_figure():
    sizes = []
    for width in (style.PAGE_WIDTH, style.PAGE_WIDTH / 2, 0.1):
        figure, ax = plt.subplots(figsize=(width, 2))
        style.stamp(figure, "SMOKE", "red", 80)
        (text,) = figure.texts
        assert text.get_zorder() < 0 and not ax.patch.get_visible() and text.get_alpha() < 0.5
        assert 0 < text.get_rotation() < 90 and text.get_color() == "red"
        sizes.append(text.get_fontsize())
    assert sizes == [80, 40, style.LEAST_POINTS]


def test_a_remark_stands_under_and_a_change_over_the_figure_wrapped_to_its_width():
    figure, _ = plt.subplots(figsize=(style.COLUMN_WIDTH, 2))
    style.remark(figure, "3 of 9 runs are missing")
    style.changed(figure, "Not the shipped figure: " + "timesteps 100 (7,000), " * 6)
    assert figure.get_supxlabel() == "3 of 9 runs are missing"
    lines = figure.get_suptitle().split("\n")
    assert len(lines) > 2 and max(map(len, lines)) <= 15 * style.COLUMN_WIDTH
    assert all(text.get_position()[0] == 0.01 for text in (figure._supxlabel, figure._suptitle))


def test_maps_name_their_vertical_axis_once_and_share_a_bar_of_all_seeds():
    figure = figures.fig1_sparse(grid(), rates(hand=HANDS))
    left, right, whole, bar = figure.axes
    assert (left.get_ylabel(), right.get_ylabel(), whole.get_ylabel()) == ("object y (cm)", "", "success (%)")
    assert bar.get_ylabel() == "seeds that succeed, of 4" and titles(figure)[:2] == ["static", "MOVE"]
    assert sorted(beside(whole)) == ["MOVE", "a seed", "paper", "static"]


def test_figure_3_names_its_curves():
    figure = figures.fig3_dense(grid(), grid(), rates(hand=HANDS), rates(timesteps=[2000, 7000]))
    budget = figure.axes[3]
    assert beside(budget) == ["static", "MOVE"] and budget.get_ylabel() == "" and budget.get_xscale() == "log"
    assert [label.get_text() for label in budget.get_xticklabels()] == ["2k", "7k"]
    assert titles(figure) == ["static", "MOVE", "by the hand's start", "by budget"]


def test_fewer_demonstrations_name_their_axis_once_and_what_is_missing():
    one, other = rates(timesteps=[1300, 7000]), rates(missing=True, timesteps=[1300, 7000])
    figure = figures.few_demonstrations(one, one)
    assert ylabels(figure) == ["success (%)", ""] and legend(figure) == ["static", "MOVE"]
    assert {ax.get_xlabel() for ax in figure.axes} == {"timesteps of demonstrations"}
    assert legend(figures.few_demonstrations(one, other)) == legend(figures.few_demonstrations(other, one)) == [
        "static", "MOVE", "missing"]


def test_figure_5_names_bars_papers_lines_and_seeds():
    by_hand = pd.concat([rates(hand=HANDS).assign(where=where) for where in ("inside", "outside")])
    figure = figures.fig5_circle(grid(), by_hand)
    for ax in figure.axes[2:4]:
        assert sorted(beside(ax)) == ["MOVE", "a seed", "paper", "static"]
    assert titles(figure)[2:] == ["inside", "outside"]


def seen(method: str) -> pd.DataFrame:
    return pd.DataFrame({"method": [method], "object_x": 0.0, "object_y": 0.6, "target_x": 0.0, "target_y": 0.8})


@pytest.mark.parametrize("count", [1, 3])
def test_figure_2_names_each_row_at_its_left_and_each_column_at_its_foot(count):
    task = get_task("pick-place")
    strips = {f"strip {number}": (np.zeros((2, 16, 16, 3), np.uint8), [0, 40]) for number in range(count)}
    figure = figures.fig2_overview({method: seen(method) for method in PAPER_METHODS},
                                   pd.DataFrame({"method": PAPER_METHODS, "object": 0.25, "target": 0.4}),
                                   {"object": task.object_range, "target": task.target_range}, strips)
    panels = figure.axes[:6]
    assert [ax.get_ylabel() for ax in panels] == ["object y (cm)", "", "", "target y (cm)", "", ""]
    assert [ax.get_xlabel() for ax in panels] == ["", "", "", "x (cm)", "x (cm)", "x (cm)"]
    assert titles(figure)[6:] == [f"strip {number}" for number in range(count)] and len(figure.axes) == 6 + count
    assert [text.get_text() for text in figure.axes[6].texts] == ["0", "40"]
    assert figure.get_figheight() == pytest.approx(2.9 + 0.98 * count)
    top, bottom = (part.bbox.height / figure.bbox.height for part in figure.subfigs)
    assert bottom / top == pytest.approx((0.1 + 1.05 * count) / 2.7)


def test_figure_4_has_ten_panels_in_the_papers_order_named_at_the_left():
    table = rates(task=PAPER_TASKS, timesteps=[5000, 20_000])
    theirs = pd.DataFrame([{"task": task, "method": "static", "timesteps": 20_000, "value": 0.3}
                           for task in PAPER_TASKS])
    figure = figures.fig4_scaling(table, theirs)
    assert titles(figure) == TITLES
    assert ylabels(figure) == ["success (%)", "", "", "", ""] * 2
    assert [ax.get_xlabel() for ax in figure.axes] == [""] * 5 + ["timesteps"] * 5
    assert legend(figure) == ["static", "MOVE", "paper, in the method's colour"]
    figure = figures.fig4_scaling(rates(missing=True, task=PAPER_TASKS, timesteps=[5000, 20_000]), theirs)
    assert legend(figure)[-1] == "missing"


def test_a_panel_of_figure_4_has_a_tick_where_only_the_paper_has_a_point():
    table = rates(task=PAPER_TASKS, timesteps=[5000, 20_000])
    theirs = pd.DataFrame([{"task": "push", "method": "static", "timesteps": 100_000, "value": 0.3}])
    figure = figures.fig4_scaling(table, theirs)
    ticks = {title: [label.get_text() for label in ax.get_xticklabels()]
             for title, ax in zip(titles(figure), figure.axes, strict=True)}
    assert ticks["Push"] == ["5k", "20k", "100k"] and ticks["Hammer"] == ["5k", "20k"]


def test_figure_6_gives_each_bar_as_much_room_in_every_panel():
    table = pd.concat([rates(("move",), task=["pick-place"], moves=["nothing", "object", "camera alone"]),
                       rates(("move",), task=["assembly"], moves=["nothing"])])
    figure = figures.fig6_dimensions(table)
    assert titles(figure) == ["Pick-Place", "Assembly"] and ylabels(figure) == ["success (%)", ""]
    assert {ax.get_xlabel() for ax in figure.axes} == {"what moves in the demonstrations"}
    assert legend(figure) == ["MOVE", "a seed"]
    assert figure.axes[0].get_gridspec().get_width_ratios() == [3, 1]


def test_figure_7_names_units_legend_and_rows():
    moved = rates(("move",), missing=True, task=["pick-place", "assembly"], part=["object", "target", "camera"],
                  speed=[0.01, 0.05])
    still = rates(("static",), task=["pick-place", "assembly"], part=["nothing"], speed=[0.0])
    figure = figures.fig7_speed(pd.concat([moved, still]))
    assert titles(figure) == [f"{task}, {part}" for task in ("Pick-Place", "Assembly")
                              for part in ("object", "target", "camera")]
    assert ylabels(figure) == ["success (%)", "", ""] * 2 and legend(figure) == ["static", "MOVE", "missing"]
    assert [ax.get_xlabel().split("(")[1] for ax in figure.axes[:3]] == [
        "m per step)", "m per step)", "degrees per step)"]
    assert figure.get_figheight() == pytest.approx(1.75 * 2 + 0.4)
    assert not [text for ax in figure.axes for text in ax.texts], "the legend names the line"


def test_figure_7_draws_no_level_where_static_is_missing():
    moved = rates(("move",), task=["pick-place"], part=["object"], speed=[0.01, 0.05])
    still = rates(("static",), missing=True, task=["pick-place"], part=["nothing"], speed=[0.0])
    (ax,) = figures.fig7_speed(pd.concat([moved, still])).axes
    assert legend(ax.figure) == ["MOVE", "missing"]
    assert not ax.patches and not [line for line in ax.get_lines() if line.get_linestyle() == "--"]
    assert titles(ax.figure) == ["Pick-Place, object"]


def test_one_bar_figures_are_named_by_task_and_method():
    figure = figures.fig_mixture(rates(("mixture",), share=[0, 0.25]), "push")
    assert titles(figure) == ["Push"] and legend(figure) == ["mixture", "a seed"]
    assert figure.axes[0].get_xlabel() == "timesteps by MOVE (%), the rest static"
    figure = figures.equal_demonstrations(rates(equal=["timesteps", "demonstrations"]), "push")
    assert titles(figure) == ["Push"] and legend(figure) == ["static", "MOVE", "a seed"]
    assert not [line for line in figure.axes[0].get_lines() if line.get_linestyle() == ":"], "the paper has none"


def test_the_legends_patches_have_the_bars_colours():
    figure = figures.fig6_dimensions(rates(("static", "move"), task=["push"], moves=["nothing"]))
    bars, dot = figure.legends[0].get_patches(), figure.legends[0].get_lines()
    assert [to_hex(bar.get_facecolor()) for bar in bars] == [style.COLOURS[name].lower() for name in ("static", "move")]
    assert {bar.get_alpha() for bar in bars} == {0.85} and [to_hex(one.get_mfc()) for one in dot] == ["#ffffff"]


def test_the_length_of_training_names_its_axis_once_and_what_is_missing():
    figure = figures.fig_training_length(rates(task=["push", "hammer"], length=[1 / 3, 1, 3]))
    assert ylabels(figure) == ["success (%)", ""] and legend(figure) == ["static", "MOVE"]
    assert titles(figure) == ["Push", "Hammer"] and {ax.get_xscale() for ax in figure.axes} == {"log"}
    assert {ax.get_xlabel() for ax in figure.axes} == {"gradient steps / the recipe's"}
    assert legend(figures.fig_training_length(rates(missing=True, task=["push"], length=[1, 3])))[-1] == "missing"


def test_coverage_and_perception_name_their_axis_once():
    cells = rates(PAPER_METHODS, task=["push"], moves=["all", "camera"]).assign(object=0.1, camera=0.2, joint=0.3)
    figure = figures.fig_coverage(cells)
    assert ylabels(figure) == ["success (%)", "", ""] and titles(figure) == ["object", "camera", "both together"]
    assert legend(figure) == ["static", "static, in part", "ADC", "ADC, in part", "MOVE", "MOVE, in part"]
    figure = figures.fig_perception(rates(observation=["rgb", "keypoints"], experiment=["table 1, object+target"]))
    assert ylabels(figure) == ["success (%)", ""] and legend(figure) == ["static", "MOVE", "a seed"]
    assert [label.get_text() for label in figure.axes[0].get_xticklabels()] == ["table 1\nobject\n+ target"]


def test_generalisation_and_controls_name_shapes_and_levels():
    figure = figures.generalization(rates(PAPER_METHODS, task=["push"], group=["grasp", "random", "moving"]))
    assert legend(figure) == ["static", "ADC", "MOVE", "at its own grasps", "elsewhere", "elsewhere, in motion"]
    figure = figures.keypoint_control(rates(timesteps=[1000, 4000]), {"expert": 1.0, "goal-blind": 0.3},
                                      pd.DataFrame([{"method": "move", "timesteps": 20_000, "value": 0.6}]))
    (ax,) = figure.axes
    assert legend(figure) == ["static", "MOVE", "paper, from images"] and ax.get_ylim() == (-0.03, 1.12)
    assert [(text.get_text(), text.xy[1]) for text in ax.texts] == [("expert", 1.0), ("goal-blind expert", 0.3)]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["1k", "4k", "20k"]


def test_rollouts_are_a_strip_an_episode_with_the_timesteps_and_tell_who_is_absent():
    strips = {f"episode {number}": (np.zeros((2, 16, 16, 3), np.uint8), [0, 10 * number]) for number in (1, 2)}
    figure = figures.rollouts(strips, ["ADC"])
    assert titles(figure) == ["episode 1", "episode 2"] and figure.get_figheight() == pytest.approx(2.28)
    assert [[text.get_text() for text in ax.texts] for ax in figure.axes] == [["0", "10"], ["0", "20"]]
    assert figure.get_supxlabel() == "not shown, for the policy is not shipped: ADC"
    figure = figures.rollouts({}, problem="no GL")
    assert [text.get_text() for text in figure.axes[0].texts] == ["no GL"] and not figure.get_supxlabel()
    assert [text.get_text() for text in figures.rollouts({}).axes[0].texts] == ["no run is stored"]


def test_the_statistics_show_our_intervals_widths_alone():
    simulated = pd.DataFrame([{"seeds": seeds, "deviation": 0.1, "interval": name, "covered": 0.95, "half_width": width}
                              for name, width in (("ours", 0.1), ("episodes alone", 0.9)) for seeds in (1, 3)])
    left, right = figures.statistics(simulated).axes
    assert [line.get_ydata().tolist() for line in right.get_lines()] == [[0.1, 0.1]] and len(left.get_lines()) == 4
    assert len(beside(left)) == 4


def test_table_1_names_what_is_random_and_tables_2_and_adc_their_marks():
    compared = pd.DataFrame([{"factors": name, "baseline": "static", "difference": 0.1, "low": 0.0, "high": 0.2,
                              "paper": 0.3} for name in LABELS])
    figure = figures.table1_spatial_factors(rates(factors=list(LABELS)), compared, LABELS)
    assert sorted(legend(figure)) == ["MOVE", "a seed", "paper", "static"]
    assert figure.axes[0].get_xlabel() == "what is random" and titles(figure) == ["success", "MOVE minus static"]
    figure = figures.table_adc(rates(("adc",), observation=["rgb", "keypoints"], task=["push"],
                                     jumping=list(plots.READINGS)))
    assert legend(figure) == list(plots.READINGS) and len(figure.axes) == 2
    assert figure.get_figheight() == pytest.approx(4.5)


def test_table_2_names_its_methods_once_and_its_differences_with_the_papers_last():
    compared = pd.DataFrame([{"task": task, "baseline": other, "difference": 0.1, "low": 0.0, "high": 0.2, "paper": 0.3}
                             for task in PAPER_TASKS for other in ("static", "adc")])
    controls = pd.DataFrame({"expert": 1.0, "goal-blind": 0.3}, index=list(PAPER_TASKS))
    table = rates(PAPER_METHODS, task=PAPER_TASKS)
    figure = figures.table2_main(table, table.drop(columns="paper"), controls, compared, pd.DataFrame())
    assert sorted(legend(figure)) == sorted(["static", "ADC", "MOVE", "paper", "expert", "goal-blind expert"])
    assert beside(figure.axes[2]) == ["MOVE − static", "MOVE − ADC", "MOVE − static, paper", "MOVE − ADC, paper"]
    assert not figure.axes[0].xaxis.get_tick_params()["labelbottom"]
    assert not [line for line in figure.axes[1].get_lines() if line.get_marker() == "D"], "none from keypoints"
    assert sorted(legend(figures.table_keypoint_control(table.drop(columns="paper"), controls))) == sorted(
        ["static", "ADC", "MOVE", "expert", "goal-blind expert"])


def test_table_6_names_its_axes_and_whose_bars_they_are():
    costs = pd.DataFrame([{"task": task, "method": method, "expert": expert, "mean_steps": 100.0 + 10 * number,
                           "generation_rate": 0.5 + 0.1 * number}
                          for number, task in enumerate(PAPER_TASKS[:3]) for method in PAPER_METHODS
                          for expert in ("phase", "metaworld")])
    figure = figures.table6_collection(costs, pd.DataFrame(
        {"method": ["static", "move"], "paper_mean_steps": [83.8, np.nan], "paper_generation_rate": [0.93, 0.75]}))
    steps, share = figure.axes
    assert ylabels(figure) == ["timesteps a demonstration", "attempts that succeed (%)"]
    dotted = [[line.get_ydata()[0] for line in ax.get_lines() if line.get_linestyle() == ":"] for ax in (steps, share)]
    assert dotted == [[83.8], [0.93, 0.75]], "none where the paper has none"
    assert share.get_ylim() == (0, 1.05) and steps.get_ylim()[1] > 120
    assert legend(figure) == ["phase expert (ours)", "Meta-World's expert", "a task", "paper"]


def recipe(budget: int, names: list[str]) -> pd.DataFrame:
    return pd.DataFrame([{"timesteps": budget, "change": name, "value": 0.9, "low": 0.8, "high": 1.0, "gain": -0.05,
                          "gain_low": -0.2, "gain_high": 0.1, "train_minutes": 19.5} for name in names])


@pytest.mark.parametrize(("second", "named"), [(["chosen", "wider"], False), (["chosen", "longer"], True)])
def test_the_recipes_changes_are_named_once_where_both_budgets_have_the_same(second, named):
    figure = figures.table_recipe(pd.concat([recipe(7000, ["chosen", "wider"]), recipe(20_000, second)]))
    assert titles(figure) == ["7k timesteps", "gain", "20k timesteps", "gain"]
    shown = [ax.yaxis.get_tick_params()["labelleft"] for ax in figure.axes]
    assert shown == [True, False, named, False]


def test_one_column_figures_are_one_column_wide():
    (efficiency,) = figures.fig4_efficiency(pd.DataFrame(columns=["task", "ratio", "low", "high", "most"]),
                                            PAPER_TASKS).axes
    assert efficiency.figure.get_figwidth() == style.COLUMN_WIDTH
    assert [text.get_text() for text in efficiency.texts] == ["missing"] * 10
    assert [label.get_text() for label in efficiency.get_yticklabels()] == TITLES

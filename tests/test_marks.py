"""Every mark and both ends of its interval stand where the table says, on an axis that tells the unit."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402
from matplotlib.patches import Circle, Rectangle  # noqa: E402

from move.paper import PAPER_TASKS  # noqa: E402
from move.report import maps, plots, real_plots  # noqa: E402
from move.report.style import COLOURS, DIFFERENCES, NAMES  # noqa: E402
from move.sim.configuration import Disc  # noqa: E402

METHODS = ["static", "adc", "move"]
PLACES = {"low": 0.03, "high": 0.05}  # how far the ends of an interval are from its value, in the first row


@pytest.fixture
def ax():
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def rows(count: int, methods=METHODS, **columns) -> pd.DataFrame:
    """`count` rows whose values, lower and upper ends are all different numbers."""
    number = np.arange(count)
    return pd.DataFrame({"method": [methods[row % len(methods)] for row in number], "value": 0.3 + 0.04 * number,
                         "low": 0.3 + 0.04 * number - 0.03 - 0.001 * number,
                         "high": 0.3 + 0.04 * number + 0.05 + 0.002 * number, "paper": 0.9 - 0.05 * number,
                         "seeds": [[0.3 + 0.04 * row, 0.31 + 0.04 * row] for row in number], **columns})


def ends(table: pd.DataFrame, names=("value", "low", "high")) -> list[tuple[float, ...]]:
    return [tuple(round(float(number), 6) for number in row) for row in table[list(names)].to_numpy()]


def intervals(ax: Axes, axis: int = 1) -> list[tuple[float, float, float, float]]:
    """(place, value, low, high) of every mark that has an interval, in the order drawn.

    Args:
        axis: 1 for values that go up, 0 for values that go to the right.
    """
    found = []
    for container in ax.containers:
        if isinstance(container, matplotlib.container.ErrorbarContainer):
            data, _, (lines,) = container
            segments = [segment for segment in lines.get_segments() if len(segment)]
            ways = (data.get_xdata(), data.get_ydata()) if data is not None else (None, None)
            for number, segment in enumerate(segments):
                low, high = segment[:, axis]
                value = ways[axis][number] if data is not None else np.nan
                found.append(tuple(round(float(part), 6) for part in (segment[0, 1 - axis], value, low, high)))
    return found


def numbers(values) -> list[float]:
    return np.asarray(values, dtype=float).round(6).tolist()


def heights(ax: Axes) -> list[tuple[float, float]]:
    """Middle and height of each bar."""
    return [(round(bar.get_x() + bar.get_width() / 2, 6), round(bar.get_height(), 6)) for bar in ax.patches
            if isinstance(bar, Rectangle)]


def written(axis, values) -> list[str]:
    return [axis.get_major_formatter()(value, 0) for value in values]


def names(axis) -> list[str]:
    return [label.get_text() for label in axis.get_ticklabels()]


def test_bars_stand_at_their_rates_under_their_intervals_and_end_at_zero(ax):
    table = rows(3)
    plots.rates(table, ax)
    assert heights(ax) == [(place, value) for place, value in enumerate(table.value.round(6))]
    assert [mark[0] for mark in intervals(ax)] == [0, 1, 2]
    assert [mark[1:] for mark in intervals(ax)] == ends(table)
    assert ax.get_ylim() == (0, 1.05) and ax.get_ylabel() == "success (%)"
    assert written(ax.yaxis, (0, 0.2, 1)) == ["0", "20", "100"]
    assert ax.get_xlim() == (-0.6, pytest.approx(2.6))
    dotted = [line for line in ax.get_lines() if line.get_linestyle() == ":"]
    assert [tuple(line.get_xdata()) for line in dotted] == [(place - 0.4, place + 0.4) for place in range(3)]


def test_single_seeds_stand_on_the_right_half_of_their_own_bar(ax):
    plots.rates(rows(3), ax)
    for place, dots in enumerate(collection.get_offsets() for collection in ax.collections
                                 if len(collection.get_offsets()) == 2):
        assert (dots[:, 0] > place).all() and (dots[:, 0] < place + 0.31).all()
        assert dots[0, 0] < dots[1, 0] and dots[:, 0].mean() == pytest.approx(place + 0.3 * 0.62)


def test_groups_of_bars_stand_side_by_side_and_never_over_each_other(ax):
    table = rows(6).assign(where=["in"] * 3 + ["out"] * 3)
    plots.grouped_rates(table, "where", ["inside", "outside"], ax)
    assert [height for _, height in heights(ax)] == table.value.round(6).tolist()
    places = [place for place, _ in heights(ax)]
    assert places == sorted(places) and np.diff(places).min() > ax.patches[0].get_width()
    assert np.mean(places[:3]) == pytest.approx(0) and np.mean(places[3:]) == pytest.approx(1)
    assert [mark[0] for mark in intervals(ax)] == places and [mark[1:] for mark in intervals(ax)] == ends(table)
    assert names(ax.xaxis) == ["inside", "outside"] and ax.get_xlim() == (-0.5, 1.5)
    over = [line for line in ax.get_lines() if line.get_linestyle() == ":"]
    assert [line.get_xdata().mean() for line in over] == pytest.approx(places, abs=1e-5)
    assert [line.get_ydata()[0] for line in over] == table.paper.tolist()


def test_two_methods_stand_left_and_right_of_the_middle(ax):
    plots.grouped_rates(rows(2, ["move", "static"]).assign(where="in"), "where", ["inside"], ax)
    by_colour = {to_hex(bar.get_facecolor()): place
                 for bar, (place, _) in zip(ax.patches, heights(ax), strict=True)}
    assert by_colour == {COLOURS["static"].lower(): pytest.approx(-0.2), COLOURS["move"].lower(): pytest.approx(0.2)}


def test_the_ladder_stands_at_its_rates(ax):
    table = rows(3, ["move"]).assign(moves=["nothing", "object + camera", "camera alone"])
    plots.ladder(table, "moves", ax)
    assert heights(ax) == list(enumerate(table.value.round(6))) and [mark[1:] for mark in intervals(ax)] == ends(table)
    assert ax.get_xlim() == (-0.6, 2.6) and ax.get_ylim() == (0, 1.05)


@pytest.mark.parametrize("log", [False, True])
def test_a_curve_goes_through_its_rates_in_order_each_method_a_little_aside(ax, log):
    table = rows(9).assign(timesteps=np.repeat([40_000, 10_000, 20_000], 3))
    plots.curve(table, "timesteps", "timesteps", ax, log=log)
    apart = []
    for container, method in zip(ax.containers, METHODS, strict=True):
        line, ordered = container[0], table[table.method == method].sort_values("timesteps")
        assert line.get_ydata().tolist() == ordered.value.tolist() and container.get_label() == NAMES[method]
        segments = container[2][0].get_segments()
        assert [tuple(segment[:, 1].round(6)) for segment in segments] == ends(ordered, ("low", "high"))
        near = line.get_xdata() / ordered.timesteps if log else line.get_xdata() - ordered.timesteps
        assert near.to_numpy() == pytest.approx(near.iloc[0]), "aside by as much at every budget"
        apart.append(near.iloc[0])
    side = 4**0.025 if log else 0.025 * 30_000
    assert apart == pytest.approx([1 / side, 1, side] if log else [-side, 0, side])
    assert ax.get_xlabel() == "timesteps" and ax.get_ylim()[0] < 0, "a rate of 0 is seen whole"
    assert names(ax.xaxis) == ["10k", "20k", "40k"] and ax.get_xscale() == ("log" if log else "linear")


def test_question_marks_stand_at_the_missing_budget_one_over_another(ax):
    table = pd.concat([rows(3).assign(timesteps=1000, value=np.nan), rows(3).assign(timesteps=2000)])
    plots.curve(table, "timesteps", "timesteps", ax)
    asked = [(line.get_xdata().tolist(), line.get_ydata()[0]) for line in ax.get_lines()
             if line.get_marker() == "$?$"]
    assert [places for places, _ in asked] == [[1000]] * 3
    levels = [height for _, height in asked]
    assert levels == pytest.approx([0.03, 0.12, 0.21])


def test_one_method_alone_stands_at_its_budgets(ax):
    plots.curve(rows(2, ["move"]).assign(speed=[0.01, 0.08]), "speed", "speed", ax)
    assert ax.containers[0][0].get_xdata().tolist() == [0.01, 0.08] and names(ax.xaxis) == ["0.01", "0.08"]


def test_short_numbers():
    assert [plots.short(number) for number in (0.333, 1, 999, 1000, 2500, 100_000)] == [
        "0.33", "1", "1e+03", "1k", "2.5k", "100k"]


def test_the_papers_points_stand_a_little_to_the_right_of_their_budget(ax):
    plots.printed_points(rows(3).assign(timesteps=[1000, 2000, 4000]), ax)
    assert [(line.get_xdata()[0], line.get_ydata()[0]) for line in ax.get_lines()] == [
        (pytest.approx(1150), 0.3), (pytest.approx(2300), pytest.approx(0.34)), (pytest.approx(4600), 0.38)]
    assert [to_hex(line.get_color()) for line in ax.get_lines()] == [COLOURS[name].lower() for name in METHODS]


def test_differences_stand_at_their_numbers_with_the_means_last_under_a_line(ax):
    table = pd.DataFrame([{"task": task, "baseline": other, "difference": value, "low": value - 0.1,
                           "high": value + 0.2, "paper": value + 0.3}
                          for task, shift in (("push", 0.0), ("hammer", 0.1))
                          for other, value in (("static", 0.2 + shift), ("adc", -0.1 + shift))])
    means = pd.DataFrame([{"baseline": "static", "difference": 0.5, "low": 0.4, "high": 0.55, "items": 2, "paper": 0.6},
                          {"baseline": "adc", "difference": 0.1, "low": 0.0, "high": 0.3, "items": 2, "paper": 0.6}])
    plots.differences(table, "task", ["Push", "Hammer"], ax, means)
    drawn = {container.get_label(): (numbers(container[0].get_xdata()), numbers(container[0].get_ydata()),
                                     [tuple(segment[:, 0].round(6)) for segment in container[2][0].get_segments()])
             for container in ax.containers}
    assert drawn["MOVE − static"] == ([0.2, 0.3, 0.5], [-0.2, 0.8, 1.8], [(0.1, 0.4), (0.2, 0.5), (0.4, 0.55)])
    assert drawn["MOVE − ADC"] == ([-0.1, 0.0, 0.1], [0.2, 1.2, 2.2], [(-0.2, 0.1), (-0.1, 0.2), (0.0, 0.3)])
    theirs = {line.get_label(): (numbers(line.get_xdata()), numbers(line.get_ydata()), to_hex(line.get_mfc()))
              for line in ax.get_lines() if line.get_marker() == "D"}
    assert theirs == {"MOVE − static, paper": ([0.5, 0.6, 0.6], [-0.2, 0.8, 1.8], "#ffffff"),
                      "MOVE − ADC, paper": ([0.2, 0.3, 0.6], [0.2, 1.2, 2.2], "#ffffff")}
    assert names(ax.yaxis) == ["Push", "Hammer", "mean of 2"] and ax.get_ylim() == (2.5, -0.5), "first item on top"
    levels = [line.get_ydata()[0] for line in ax.get_lines() if line.get_color() == "#BBBBBB"]
    assert levels == [1.5], "the line is between the last item and the mean"
    assert [line.get_xdata()[0] for line in ax.get_lines() if line.get_color() == "black" and line.get_lw() == 0.8] == [
        0]
    assert {container[0].get_marker() for container in ax.containers} == {mark for mark in ("o", "s")} == {
        DIFFERENCES[other][1] for other in ("static", "adc")}


@pytest.mark.parametrize("means", [None, pd.DataFrame()])
def test_differences_without_a_mean_have_no_line(ax, means):
    table = pd.DataFrame([{"task": "push", "baseline": "static", "difference": 0.2, "low": 0.1, "high": 0.4}])
    plots.differences(table, "task", ["Push"], ax, means)
    assert names(ax.yaxis) == ["Push"] and ax.containers[0][0].get_ydata()[0] == 0 and ax.get_ylim() == (0.5, -0.5)
    assert not [line for line in ax.get_lines() if line.get_marker() == "D"], "the paper has none"
    assert written(ax.xaxis, (-0.1, 0, 0.001, 0.12)) == ["−10", "0", "0", "+12"]


def test_efficiencies_stand_at_their_factors_cut_at_what_could_be_found(ax):
    table = pd.DataFrame([{"task": "push", "ratio": 1.5, "low": 1.2, "high": 1.8, "most": 2.0},
                          {"task": "hammer", "ratio": 1.6, "low": 1.1, "high": np.inf, "most": 2.0},
                          {"task": "assembly", "ratio": np.inf, "low": 1.0, "high": np.inf, "most": 4.0}])
    plots.efficiencies(table, ax)
    assert intervals(ax, axis=0) == [(0, 1.5, 1.2, 1.8), (1, 1.6, 1.1, 2.0), (2, 4.0, 1.0, 4.0)]
    assert [container[0].get_markerfacecolor() for container in ax.containers] == ["black", "black", "white"]
    arrows = [(line.get_xdata()[0], line.get_ydata()[0]) for line in ax.get_lines() if line.get_marker() == ">"]
    assert arrows == [(2.0, 1), (4.0, 2)]
    assert names(ax.yaxis) == ["Push", "Hammer", "Assembly"] and ax.get_ylim() == (2.5, -0.5)
    assert names(ax.xaxis) == ["1/4", "1/2", "1", "2", "4"] and ax.get_xticks().tolist() == [0.25, 0.5, 1, 2, 4]
    low, high = ax.get_xlim()
    assert low < 0.25 and high > 4 and ax.get_xscale() == "log" and "static's timesteps" in ax.get_xlabel()


def test_coverage_of_intervals_stands_at_its_share_one_mark_a_number_of_seeds(ax):
    table = pd.DataFrame([{"interval": name, "seeds": seeds, "deviation": deviation,
                           "covered": 0.5 + 0.1 * (name == "ours") + seeds / 100 + deviation}
                          for name in ("ours", "episodes alone") for seeds in (1, 3) for deviation in (0.03, 0.2)])
    plots.coverages(table, ax)
    drawn = {line.get_label(): (line.get_xdata().round(2).tolist(), line.get_ydata().round(6).tolist(),
                                line.get_marker(), to_hex(line.get_mfc())) for line in ax.get_lines()}
    assert drawn == {"ours, 1 seed": ([-0.22, 0.78], [0.64, 0.81], "o", "#000000"),
                     "ours, 3 seeds": ([0.22, 1.22], [0.66, 0.83], "s", "#000000"),
                     "episodes alone, 1 seed": ([-0.22, 0.78], [0.54, 0.71], "o", "#ffffff"),
                     "episodes alone, 3 seeds": ([0.22, 1.22], [0.56, 0.73], "s", "#ffffff")}
    (band,) = ax.patches
    assert (band.get_y(), band.get_y() + band.get_height()) == (0.93, pytest.approx(0.97))
    assert names(ax.xaxis) == ["3", "20"] and "points" in ax.get_xlabel() and "(%)" in ax.get_ylabel()


def test_half_widths_are_a_line_a_deviation_named_at_its_end(ax):
    table = pd.DataFrame([{"seeds": seeds, "deviation": deviation, "half_width": deviation + 0.1 / seeds}
                          for deviation in (0.03, 0.2) for seeds in (1, 2, 5)])
    plots.half_widths(table, ax)
    assert [line.get_ydata().round(4).tolist() for line in ax.get_lines()] == [[0.13, 0.08, 0.05], [0.3, 0.25, 0.22]]
    assert [line.get_xdata().tolist() for line in ax.get_lines()] == [[1, 2, 5]] * 2
    faint, full = (line.get_alpha() for line in ax.get_lines())
    assert faint < full == 1
    assert [(text.get_text(), text.xy) for text in ax.texts] == [
        ("3 points", (5, pytest.approx(0.05))), ("20 points", (5, pytest.approx(0.22)))]
    assert ax.get_xticks().tolist() == [1, 2, 5] and ax.get_xlim()[1] == 6 and ax.get_ylim()[0] == 0
    assert written(ax.yaxis, (0.05,)) == ["5"]


def test_a_level_is_a_named_line_at_its_value(ax):
    plots.level(0.7, "expert", ax)
    assert ax.get_lines()[0].get_ydata()[0] == 0.7
    assert [(text.get_text(), text.xy) for text in ax.texts] == [("expert", (1, 0.7))]


def test_rates_of_tasks_stand_over_the_tasks_and_a_task_without_runs_says_so(ax):
    table = rows(6).assign(task=["push"] * 3 + ["hammer"] * 3)
    controls = pd.DataFrame({"expert": [1.0, 0.9], "goal-blind": [0.3, 0.2]}, index=["push", "hammer"])
    plots.task_rates(table, controls, ax)
    order = list(PAPER_TASKS)
    places = {task: order.index(task) for task in ("push", "hammer")}
    for container, method in zip(ax.containers, METHODS, strict=True):
        line, segments = container[0], container[2][0].get_segments()
        for task, place in places.items():
            row = table[(table.task == task) & (table.method == method)].iloc[0]
            assert line.get_ydata()[place] == row.value and abs(line.get_xdata()[place] - place) < 0.3
            assert segments[place][:, 1] == pytest.approx([row.low, row.high])
    shifts = [container[0].get_xdata()[0] for container in ax.containers]
    assert shifts == pytest.approx([-0.28, -0.02, 0.24]), "static, ADC, MOVE from the left"
    theirs = [line for line in ax.get_lines() if line.get_marker() == "D" and len(line.get_xdata())]
    assert [line.get_xdata()[0] for line in theirs] == pytest.approx([-0.18, 0.08, 0.34])
    assert {text.xy[0] for text in ax.texts} == {order.index(task) for task in order} - set(places.values())
    ceiling = next(lines for lines in ax.collections if lines.get_label() == "expert").get_segments()
    assert ceiling[places["push"]].tolist() == [[places["push"] - 0.42, 1.0], [places["push"] + 0.42, 1.0]]
    assert names(ax.xaxis)[:2] == ["Pick-\nPlace", "Push"] and ax.get_xlim() == (-0.6, pytest.approx(9.6))


def test_few_tasks_have_unbroken_names(ax):
    table = rows(3, ["adc"]).assign(task=["push", "pick-place", "hammer"], jumping="as printed")
    plots.readings(table, "jumping", ax)
    assert names(ax.xaxis) == ["Pick-Place", "Push", "Hammer"], "in the tasks' own order"
    printed = ax.containers[0]
    assert numbers(printed[0].get_ydata()) == [0.34, 0.3, 0.38]
    assert printed[0].get_xdata() == pytest.approx([-0.2, 0.8, 1.8])


def test_a_policy_at_its_own_grasps_elsewhere_and_in_motion_is_joined_from_left_to_right(ax):
    table = rows(9).assign(task="push", group=np.repeat(["moving", "grasp", "random"], 3))
    plots.own_and_elsewhere(table, ax)
    shifts = dict(zip(METHODS, (-0.26, 0.0, 0.26), strict=True))
    for method in METHODS:
        here = table[table.method == method].set_index("group").value
        (joined,) = [line for line in ax.get_lines() if line.get_lw() == 2
                     and to_hex(line.get_color()) == COLOURS[method].lower()]
        assert joined.get_ydata().tolist() == [here.grasp, here.random, here.moving]
        assert joined.get_xdata() == pytest.approx(shifts[method] + np.array([-0.08, 0, 0.08]))
    assert sorted(mark[1:] for mark in intervals(ax)) == sorted(ends(table))


def test_one_change_of_the_recipe_a_line_the_chosen_one_in_black(ax):
    table = rows(2).assign(change=["chosen", "wider"], gain=[0.0, -0.1], gain_low=[0.0, -0.3], gain_high=[0.0, 0.05],
                           train_minutes=[2.04, 3.0])
    plots.changes(table, ax)
    assert [mark[1:] for mark in intervals(ax, axis=0)] == ends(table) and [
        mark[0] for mark in intervals(ax, axis=0)] == [0, 1]
    assert [container[0].get_color() for container in ax.containers] == ["black", "#777777"]
    assert names(ax.yaxis) == ["chosen", "wider"] and ax.get_ylim() == (1.5, -0.5)
    assert ax.get_xlim() == (0.4, 1.03) and ax.get_xlabel() == "success (%)"
    figure, other = plt.subplots()
    plots.gains(table, other)
    assert [mark[1:] for mark in intervals(other, axis=0)] == ends(table, ("gain", "gain_low", "gain_high"))
    assert [(text.get_text(), text.xy) for text in other.texts] == [("2.0 min", (1, 0)), ("3.0 min", (1, 1))]
    assert other.get_xlabel() == "gain (points)"
    plt.close(figure)


def test_costs_of_two_experts_stand_side_by_side_with_the_papers_over_both(ax):
    table = pd.DataFrame([{"task": task, "method": method, "expert": expert, "steps": base + 10 * task + less}
                          for method, base in (("static", 100.0), ("move", 200.0))
                          for expert, less in (("phase", 0), ("metaworld", 50)) for task in range(3)])
    plots.costs(table, "steps", {"move": 230.0}, ax)
    assert heights(ax) == [(-0.2, 110), (0.2, 160), (0.8, 210), (1.2, 260)]
    assert [round(bar.get_alpha(), 2) for bar in ax.patches] == [0.85, 0.45] * 2
    dots = [(line.get_xdata().round(6).tolist(), line.get_ydata().tolist()) for line in ax.get_lines()
            if line.get_marker() == "."]
    assert dots[0] == ([-0.1] * 3, [100, 110, 120]) and dots[3] == ([1.3] * 3, [250, 260, 270])
    (paper,) = [line for line in ax.get_lines() if line.get_linestyle() == ":"]
    assert list(paper.get_xdata()) == pytest.approx([0.58, 1.42]) and list(paper.get_ydata()) == [230, 230]
    assert all(mark[1] - mark[2] == pytest.approx(mark[3] - mark[1]) for mark in intervals(ax))
    assert [entry.get_label() for entry in plots.cost_entries(["phase", "metaworld", "else"])] == [
        "phase expert (ours)", "Meta-World's expert", "a task", "paper"]


def test_an_interval_of_shares_is_worth_its_spread_or_its_number_where_there_is_none():
    alike = plots.share_interval(pd.Series([0.5] * 4))
    assert alike == pytest.approx((0.15, 0.85), abs=1e-3), "Wilson's of 2 in 4"
    spread = plots.share_interval(pd.Series([0.45, 0.55, 0.5, 0.5]))
    half = 3.182 * np.std([0.45, 0.55, 0.5, 0.5], ddof=1) / 2  # Student's of three degrees of freedom
    assert (spread[1] - spread[0]) / 2 == pytest.approx(half, rel=0.02)
    assert sum(spread) / 2 == pytest.approx(0.5)


def test_success_against_coverage_stands_at_both_with_parts_of_move_as_triangles(ax):
    table = rows(4, ["static", "adc", "move", "move"]).assign(
        task=["push", "push", "push", "hammer"], moves=["nothing", "jumps", "all", "camera"],
        joint=[0.4, 0.2, 0.9, 0.5])
    plots.covered(table, "joint", ax)
    marks = {line.get_label(): (line.get_marker(), line.get_xdata().tolist(), line.get_ydata().round(6).tolist())
             for line in ax.get_lines() if line.get_marker() in ("o", "^")}
    assert marks == {"static": ("o", [0.4], [0.3]), "ADC": ("o", [0.2], [0.34]), "MOVE": ("o", [0.9], [0.38]),
                     "MOVE, in part": ("^", [0.5], [0.42])}
    assert [(place, low, high) for place, _, low, high in intervals(ax)] == [
        (place, *pair) for place, pair in zip(table.joint, ends(table, ("low", "high")), strict=True)]
    joined = [(line.get_xdata().tolist(), line.get_ydata().round(6).tolist()) for line in ax.get_lines()
              if line.get_color() == "#bbbbbb"]
    assert joined == [([0.2, 0.4, 0.9], [0.34, 0.3, 0.38]), ([0.5], [0.42])], "a task's marks, from the left"
    assert written(ax.xaxis, (0.25,)) == ["25"] and ax.get_xlabel() == "cells that the data visit (%)"
    assert ax.get_xlim() == (-0.02, 1.04)


def episodes() -> pd.DataFrame:
    """Three by two cells; success differs from cell to cell and from seed to seed."""
    cells = [{"group": "grid", "object_x": 0.1 * x, "object_y": 0.6 + 0.2 * y, "seed": seed,
              "success": x + 3 * y > 2 * seed} for x in range(3) for y in range(2) for seed in range(2)]
    points = [{"group": "point", "object_x": 0.05, "object_y": 0.7, "seed": seed, "success": seed == 0}
              for seed in range(2)]
    return pd.DataFrame(cells + points)


def test_a_maps_cell_is_a_place_in_centimetres_and_its_colour_the_share_of_seeds(ax):
    mesh = maps.heatmap(episodes(), ax)
    assert np.asarray(mesh.get_array()).round(3).tolist() == [[0, 0.5, 0.5], [1, 1, 1]], "rows are y, columns are x"
    corners = np.asarray(mesh.get_coordinates())
    assert corners[0, :, 0] == pytest.approx([-5, 5, 15, 25]) and corners[:, 0, 1] == pytest.approx([50, 70, 90])
    halo, ring = (dots for dots in ax.collections if dots is not mesh)
    for dots in (halo, ring):
        assert dots.get_offsets().tolist() == [[pytest.approx(5), pytest.approx(70)]]
    assert ring.get_array().tolist() == [0.5] and ring.get_zorder() > halo.get_zorder() > mesh.get_zorder()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("object x (cm)", "object y (cm)") and ax.get_aspect() == 1
    assert mesh.norm.vmin == -0.25 and mesh.norm.vmax == 1.25, "colours are centred on 0, 1 and 2 seeds of 2"


def test_the_bar_of_a_map_names_the_seeds(ax):
    maps.seeds_bar(maps.heatmap(episodes(), ax), [ax], 2)
    bar = ax.figure.axes[1]
    assert bar.get_yticks() == pytest.approx([0, 0.5, 1]) and names(bar.yaxis) == ["0", "1", "2"]
    assert bar.get_ylabel() == "seeds that succeed, of 2"


def test_a_map_of_one_column_of_cells_is_drawn(ax):
    only = episodes().query("object_x == 0 and group == 'grid'")
    corners = np.asarray(maps.heatmap(only, ax).get_coordinates())
    assert corners[0, :, 0] == pytest.approx([-1, 1])


def test_what_lies_over_a_map_is_in_centimetres(ax):
    maps.grasps(pd.DataFrame({"object_x": [0.1, -0.2], "object_y": [0.6, 0.75]}), ax)
    assert ax.collections[0].get_offsets().round(6).tolist() == [[10, 60], [-20, 75]]
    maps.circle(Disc(centre=(0.05, 0.7), radius=0.1), ax)
    (outline,) = [patch for patch in ax.patches if isinstance(patch, Circle)]
    assert outline.center == pytest.approx((5, 70)) and outline.radius == pytest.approx(10) and not outline.get_fill()


def test_where_a_thing_was_is_drawn_in_centimetres_over_the_range_of_evaluation(ax):
    seen = pd.DataFrame({"method": "move", "object_x": [9.0, 9.0], "object_y": [9.0, 9.0], "target_x": [0.1, -0.2],
                         "target_y": [0.65, 0.75]})
    maps.coverage(seen, "target", (-0.1, 0.6, 0.0), (0.2, 0.9, 0.0), ax)
    (dots,) = ax.get_lines()
    assert dots.get_xdata() == pytest.approx([10, -20]) and dots.get_ydata() == pytest.approx([65, 75])
    (box,) = ax.patches
    assert (*box.get_xy(), box.get_width(), box.get_height()) == pytest.approx((-10, 60, 30, 30))
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_aspect()) == ("target x (cm)", "target y (cm)", 1)


def test_frames_keep_their_order_and_their_labels_stand_on_them(ax):
    frames = np.stack([np.full((40, 90, 3), value, np.uint8) for value in (10, 20, 30)])
    maps.strip(frames, ["0", "5", "9"], ax)
    row = np.asarray(ax.get_images()[0].get_array())[0, :, 0]
    assert row.shape == (3 * 90 + 2 * 3,) and set(row[:90]) == {10} and set(row[93:183]) == {20} and set(
        row[186:]) == {30} and set(row[90:93]) == {255}
    assert [(text.get_text(), text.xy) for text in ax.texts] == [("0", (0, 0)), ("5", (93, 0)), ("9", (186, 0))]
    assert not ax.axison


CELLS = pd.DataFrame([{"timesteps": 2000, "method": "static", "successes": 3, "trials": 30, "rate": 0.1, "low": 0.02,
                       "high": 0.27, "normalised": 0.2, "score_low": 0.1, "score_high": 0.7},
                      {"timesteps": 4000, "method": "move", "successes": 15, "trials": 30, "rate": 0.5, "low": 0.31,
                       "high": 0.69, "normalised": 0.6, "score_low": 0.5, "score_high": 0.8}])


def test_the_robots_successes_stand_with_their_counts_over_the_interval(ax):
    real_plots.success_cells(CELLS, ax)
    assert heights(ax) == [(0, 0.1), (1, 0.5)]
    assert [mark[1:] for mark in intervals(ax)] == [(0.1, 0.02, 0.27), (0.5, 0.31, 0.69)]
    assert [(text.get_text(), *text.get_position()) for text in ax.texts] == [
        ("3/30", 0, pytest.approx(0.285)), ("15/30", 1, pytest.approx(0.705))]
    assert names(ax.xaxis) == ["static\n2,000", "MOVE\n4,000"] and ax.get_ylim() == (0, 1)
    assert [to_hex(bar.get_facecolor()) for bar in ax.patches] == [COLOURS["static"].lower(), COLOURS["move"].lower()]


def test_the_robots_scores_stand_in_the_range_that_the_successes_allow(ax):
    real_plots.score_cells(CELLS, ax)
    assert [(bar.get_y(), round(bar.get_y() + bar.get_height(), 6)) for bar in ax.patches] == [(0.1, 0.7), (0.5, 0.8)]
    assert [(line.get_xdata()[0], line.get_ydata()[0], line.get_color()) for line in ax.get_lines()] == [
        (0, 0.2, COLOURS["static"]), (1, 0.6, COLOURS["move"])]
    assert [text.get_text() for text in ax.texts] == ["20.0", "60.0"] and "three points" in ax.get_ylabel()


def test_the_half_disc_is_seen_from_above_with_y_to_the_left(ax):
    outline = real_plots.half_disc(ax, radius_m=0.6)
    assert (outline.r, outline.theta1, outline.theta2) == (0.6, 0, 180)
    left, right = ax.get_xlim()
    assert left > 0.6 and right < -0.6 and ax.get_ylim()[1] > 0.6 > 0 > ax.get_ylim()[0]
    assert [text.get_text() for text in ax.texts] == ["base"]


def test_visited_cells_are_darker_the_more_often_and_the_way_ends_at_the_grasp(ax):
    cells = pd.DataFrame({"x_m": [0.1, 0.3], "y_m": [0.2, -0.2], "visits": [1, 16]})
    shades = real_plots.coverage_map(cells, ax, cell_m=0.1)
    squares = [patch for patch in ax.patches if isinstance(patch, Rectangle)]
    assert [square.get_xy() for square in squares] == [pytest.approx((0.15, 0.05)), pytest.approx((-0.25, 0.25))]
    assert {(square.get_width(), square.get_height()) for square in squares} == {(0.1, 0.1)}
    assert shades.norm(1) == pytest.approx(0.25) and shades.norm(16) == 1, "the square root of the visits"
    assert to_hex(squares[1].get_facecolor()) == COLOURS["move"].lower()
    figure, other = plt.subplots()
    steps = pd.DataFrame({"part": "a", "index": [0, 0, 0, 1], "x_m": [0.1, 0.2, 0.3, 0.4], "y_m": [0.0, 0.1, 0.2, 0.3],
                          "grasped": [False, False, True, False]})
    real_plots.paths(steps, other)
    drawn = [(np.atleast_1d(line.get_xdata()).tolist(), np.atleast_1d(line.get_ydata()).tolist(), line.get_marker())
             for line in other.get_lines() if line.get_color() == COLOURS["move"]]
    assert drawn == [([0.0, 0.1], [0.1, 0.2], "None"), ([0.1], [0.2], "o"), ([0.3], [0.4], "None")]
    plt.close(figure)


def test_speeds_are_a_dot_a_demonstration_and_places_are_joined_within_one(ax):
    speeds = pd.DataFrame({"method": ["move", "static", "move"], "mean_speed": [3.0, 1.0, np.nan], "unit": "cm"})
    real_plots.speed_dots(speeds, ax)
    assert [line.get_ydata().tolist() for line in ax.get_lines()] == [[1.0], [3.0]]
    assert [abs(line.get_xdata()[0] - place) <= 0.2 for place, line in enumerate(ax.get_lines())] == [True, True]
    assert names(ax.xaxis) == ["static\nn = 1", "MOVE\nn = 2"] and ax.get_ylabel() == "object's speed (cm/s)"
    assert ax.get_ylim()[0] == 0
    figure, other = plt.subplots()
    real_plots.object_map(pd.DataFrame({"part": "a", "index": [0, 0, 1], "row": [1, 2, 5], "column": [10, 20, 30],
                                        "height": 72, "width": 128}), other)
    assert [(line.get_xdata().tolist(), line.get_ydata().tolist()) for line in other.get_lines()] == [
        ([10, 20], [1, 2]), ([30], [5])]
    assert other.get_xlim() == (0, 128) and other.get_ylim() == (72, 0), "as the image is: row 0 on top"
    plt.close(figure)

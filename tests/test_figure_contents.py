"""Each panel of a whole figure holds what its title says: the data of that task, method, part or observation.

In these tables every number tells whose it is, so that two panels or two columns that change places are noticed.
"""

import matplotlib

matplotlib.use("Agg")

import claimed  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
from matplotlib.collections import PathCollection, QuadMesh  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402

from move.claims.rule import VERDICTS  # noqa: E402
from move.paper import PAPER_METHODS, PAPER_TASKS, published  # noqa: E402
from move.report import figures, plots, style, tables  # noqa: E402
from move.sim.grasp_points import CIRCLE  # noqa: E402
from move.sim.tasks import TASKS, get_task  # noqa: E402

SHIFT = {"static": 0.0, "adc": 0.03, "move": 0.06, "mixture": 0.045}
COLOUR = {method: style.COLOURS[method].lower() for method in SHIFT}


@pytest.fixture(autouse=True)
def close():
    yield
    plt.close("all")


def titled(figure: plt.Figure) -> dict[str, plt.Axes]:
    """The panels by their titles, without the letter."""
    return {ax.get_title(loc="left").split("$   ")[-1]: ax for ax in figure.axes if ax.get_title(loc="left")}


def rates(cells: dict[tuple, float], columns: tuple[str, ...], methods=("static", "move")) -> pd.DataFrame:
    """Of each cell its number, a little more for each method."""
    return pd.DataFrame([
        {**dict(zip(columns, cell, strict=True)), "method": method, "value": level + SHIFT[method],
         "low": level + SHIFT[method] - 0.01, "high": level + SHIFT[method] + 0.01, "paper": np.nan,
         "seeds": [level + SHIFT[method]]}
        for cell, level in cells.items() for method in methods])


def heights(ax: plt.Axes) -> dict[str, list[float]]:
    """Colour -> the heights of its bars, else of the points of its error bars."""
    found: dict[str, list[float]] = {}
    for bar in ax.patches:
        found.setdefault(to_hex(bar.get_facecolor()), []).append(round(float(bar.get_height()), 4))
    if not found:
        for container in ax.containers:
            values = [round(float(value), 4) for value in np.atleast_1d(container[0].get_ydata()) if np.isfinite(value)]
            found.setdefault(to_hex(container[0].get_color()), []).extend(values)
    return found


def grid(shares: dict[str, float], seeds: int = 2) -> pd.DataFrame:
    """A grid of 4 by 4 cells of which the first share succeeds with every seed, and one grasp point a method."""
    return pd.DataFrame([
        {"method": method, "group": "grid", "object_x": 0.1 * (cell % 4), "object_y": 0.1 * (cell // 4), "seed": seed,
         "success": cell < 16 * share}
        for method, share in shares.items() for cell in range(16) for seed in range(seeds)] + [
        {"method": method, "group": "point", "object_x": 0.05, "object_y": 0.05, "seed": seed, "success": True}
        for method in shares for seed in range(seeds)])


def mapped(ax: plt.Axes) -> float:
    """The mean of the map on an axis."""
    (mesh,) = (part for part in ax.collections if isinstance(part, QuadMesh))
    return float(np.mean(mesh.get_array()))


WHOLE = rates({(): 0.4}, ()).assign(paper=[0.295, 0.808])


@pytest.mark.parametrize("make", [
    lambda: figures.fig1_sparse(grid({"static": 0.25, "move": 0.75}), WHOLE),
    lambda: figures.fig3_dense(grid({"static": 0.25, "move": 0.75}), grid({"static": 0, "move": 0}), WHOLE,
                               rates({(2000,): 0.2, (7000,): 0.7}, ("timesteps",))),
    lambda: figures.fig5_circle(grid({"static": 0.25, "move": 0.75}), rates({("inside",): 0.2}, ("where",))),
])
def test_the_left_map_is_statics_and_the_right_one_moves(make):
    panels = titled(make())
    assert (mapped(panels["static"]), mapped(panels["MOVE"])) == (0.25, 0.75)


def test_a_method_without_episodes_leaves_its_map_empty_and_says_so():
    panels = titled(figures.fig1_sparse(grid({"static": 0.25}), WHOLE))
    assert [text.get_text() for text in panels["MOVE"].texts] == ["missing"] and mapped(panels["static"]) == 0.25


def test_figure_1_has_the_papers_rates_over_each_methods_bar():
    ax = titled(figures.fig1_sparse(grid({"static": 0.25, "move": 0.75}), WHOLE))["whole space"]
    assert heights(ax) == {COLOUR["static"]: [0.4], COLOUR["move"]: [0.46]}
    dotted = {round(float(np.mean(line.get_xdata()))): line.get_ydata()[0] for line in ax.get_lines()
              if line.get_linestyle() == ":"}
    assert dotted == {0: 0.295, 1: 0.808}


def test_figure_3_shows_each_methods_own_grasps_and_its_curve_over_budgets():
    grasped = pd.DataFrame({"method": ["static", "move", "move"], "object_x": [0.01, 0.02, 0.03], "object_y": 0.1})
    panels = titled(figures.fig3_dense(grid({"static": 0.25, "move": 0.75}), grasped, WHOLE,
                                       rates({(2000,): 0.2, (7000,): 0.7}, ("timesteps",))))
    for method, title, expected in (("static", "static", [1.0]), ("move", "MOVE", [2.0, 3.0])):
        dots = [part for part in panels[title].collections if isinstance(part, PathCollection)][-1]
        assert [round(x, 6) for x, _ in dots.get_offsets()] == expected, method
    assert heights(panels["by budget"]) == {COLOUR["static"]: [0.2, 0.7], COLOUR["move"]: [0.26, 0.76]}


def test_fewer_demonstrations_are_shown_at_their_points_first_and_over_the_whole_space_second():
    at_points, whole = (rates({(1300,): level, (7000,): level + 0.2}, ("timesteps",)) for level in (0.1, 0.5))
    panels = titled(figures.few_demonstrations(at_points, whole))
    assert heights(panels["at the nine points"]) == {COLOUR["static"]: [0.1, 0.3], COLOUR["move"]: [0.16, 0.36]}
    assert heights(panels["whole space"]) == {COLOUR["static"]: [0.5, 0.7], COLOUR["move"]: [0.56, 0.76]}


def test_figure_5_draws_its_circle_over_both_maps_and_the_papers_values_at_their_sides():
    table = rates({("inside",): 0.2, ("outside",): 0.6}, ("where",)).assign(paper=[0.213, 0.437, 0.446, 0.674])
    panels = titled(figures.fig5_circle(grid({"static": 0.25, "move": 0.75}), table))
    for name in ("static", "MOVE"):
        (outline,) = panels[name].patches
        assert outline.get_radius() == pytest.approx(100 * CIRCLE.radius)
        assert outline.center == pytest.approx([100 * value for value in CIRCLE.centre[:2]])
    ax = panels["in and out of the circle"]
    assert heights(ax) == {COLOUR["static"]: [0.2, 0.6], COLOUR["move"]: [0.26, 0.66]}
    dotted = sorted((float(np.mean(line.get_xdata())), line.get_ydata()[0]) for line in ax.get_lines()
                    if line.get_linestyle() == ":")
    assert [value for _, value in dotted] == [0.213, 0.437, 0.446, 0.674]


def test_figure_2_tells_each_share_over_its_own_places():
    places = {method: pd.DataFrame({"method": method, "object_x": [x], "object_y": 0.6, "target_x": [-x],
                                    "target_y": 0.8})
              for method, x in (("static", 0.01), ("adc", 0.02), ("move", 0.03))}
    shares = pd.DataFrame({"method": ["move", "static", "adc"], "object": [0.9, 0.2, 0.4],
                           "target": [0.8, 0.3, 0.5]})  # in another order than the panels
    task = get_task("pick-place")
    panels = titled(figures.fig2_overview(places, shares, {"object": task.object_range, "target": task.target_range},
                                          {}, "no GL"))
    drawn = {title: round(float(ax.get_lines()[0].get_xdata()[0]), 6) for title, ax in panels.items() if title}
    assert drawn == {"static, object: 20 % of cells": 1.0, "ADC, object: 40 % of cells": 2.0,
                     "MOVE, object: 90 % of cells": 3.0, "static, target: 30 % of cells": -1.0,
                     "ADC, target: 50 % of cells": -2.0, "MOVE, target: 80 % of cells": -3.0}
    assert [text.get_text() for text in panels[""].texts] == ["no GL"]


def test_figure_4_has_each_tasks_curves_and_the_papers_point_at_its_budget_under_its_title():
    levels = {task: 0.1 + 0.05 * place for place, task in enumerate(PAPER_TASKS)}
    table = rates({(task, size): level for task, level in levels.items() for size in (10_000, 20_000)},
                  ("task", "timesteps"))
    panels = titled(figures.fig4_scaling(table[table.task != "hammer"], tables.printed_success(list(PAPER_TASKS))))
    budgets = published("table5_data_sizes", "timesteps").set_index("task").value
    theirs = published("table2_main").set_index(["task", "method"]).value
    for task, level in levels.items():
        ax = panels[TASKS[task].title]
        if task == "hammer":
            assert [text.get_text() for text in ax.texts] == ["missing"]
            continue
        assert heights(ax)[COLOUR["move"]] == pytest.approx([level + 0.06] * 2)
        diamonds = {(to_hex(line.get_color()), line.get_ydata()[0]): line.get_xdata()[0] / budgets[task]
                    for line in ax.get_lines() if line.get_marker() == "D"}
        assert set(diamonds) == {(COLOUR[method], theirs[task, method]) for method in PAPER_METHODS}
        assert all(1 <= beside < 1.2 for beside in diamonds.values()), "a little to the right of our points"


def test_an_efficiency_stands_on_its_tasks_line_and_the_others_are_missing():
    factors = pd.DataFrame([{"task": "hammer", "ratio": 2.0, "low": 1.5, "high": 3.0, "most": 4.0}])
    (ax,) = figures.fig4_efficiency(factors, ["push", "hammer", "assembly"]).axes
    names = [label.get_text() for label in ax.get_yticklabels()]
    (container,) = ax.containers
    assert names[int(container[0].get_ydata()[0])] == "Hammer" and container[0].get_xdata()[0] == 2.0
    assert sorted(names[int(text.xy[1])] for text in ax.texts) == ["Assembly", "Push"]


def test_figure_6_has_a_ladder_a_task():
    cells = {("pick-place", "nothing"): 0.1, ("pick-place", "object"): 0.2, ("assembly", "nothing"): 0.3}
    table = rates(cells, ("task", "moves"), ("move",))
    panels = titled(figures.fig6_dimensions(table))
    assert heights(panels["Pick-Place"]) == {COLOUR["move"]: [0.16, 0.26]}
    assert heights(panels["Assembly"]) == {COLOUR["move"]: [0.36]}


def test_figure_7_has_a_row_a_task_a_column_a_part_and_static_as_a_level_of_its_task():
    moved = rates({(task, part, speed): level + speed for (task, part), level in {
        ("pick-place", "object"): 0.2, ("pick-place", "target"): 0.3, ("assembly", "object"): 0.5}.items()
        for speed in (0.01, 0.08)}, ("task", "part", "speed"), ("move",))
    still = rates({("pick-place", "nothing", 0.0): 0.11, ("assembly", "nothing", 0.0): 0.44},
                  ("task", "part", "speed"), ("static",))
    panels = titled(figures.fig7_speed(pd.concat([moved, still])))
    for title, level, base in (("Pick-Place, object", 0.11, 0.26), ("Pick-Place, target", 0.11, 0.36),
                               ("Assembly, object", 0.44, 0.56)):
        ax = panels[title]
        (band,) = ax.patches
        assert band.get_y() < level < band.get_y() + band.get_height() < level + 0.05
        band.remove()
        assert heights(ax) == {COLOUR["move"]: [round(base + 0.01, 4), round(base + 0.08, 4)]}
        (line,) = [line for line in ax.get_lines() if line.get_linestyle() == "--"]
        assert line.get_ydata()[0] == level and to_hex(line.get_color()) == COLOUR["static"]
        assert title.split(", ")[1] in ax.get_xlabel()
    assert [text.get_text() for text in panels["Assembly, target"].texts] == ["not part of this study"]


def test_a_mixture_has_its_share_in_per_cent_under_each_bar():
    (ax,) = figures.fig_mixture(rates({(0.0,): 0.1, (0.25,): 0.3, (1.0,): 0.6}, ("share",), ("mixture",)),
                                "pick-place").axes
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0", "25", "100"]
    assert heights(ax) == {COLOUR["mixture"]: [0.145, 0.345, 0.645]}


def test_the_length_of_training_has_a_panel_a_task():
    table = rates({(task, length): level * length for task, level in (("push", 0.1), ("hammer", 0.2))
                   for length in (1.0, 3.0)}, ("task", "length"))
    panels = titled(figures.fig_training_length(table))
    assert heights(panels["Push"])[COLOUR["static"]] == [0.1, 0.3]
    assert heights(panels["Hammer"])[COLOUR["static"]] == [0.2, 0.6]


def test_equal_timesteps_stand_over_their_name_and_equal_demonstrations_over_theirs():
    (ax,) = figures.equal_demonstrations(rates({("timesteps",): 0.2, ("demonstrations",): 0.5}, ("equal",)),
                                         "pick-place").axes
    places = {round(bar.get_height(), 4): round(bar.get_x() + bar.get_width() / 2) for bar in ax.patches}
    names = [label.get_text() for label in ax.get_xticklabels()]
    assert {height: names[place] for height, place in places.items()} == {
        0.2: "equal timesteps", 0.26: "equal timesteps", 0.5: "equal demonstrations", 0.56: "equal demonstrations"}


def test_what_is_covered_of_the_object_the_camera_and_both_has_a_panel_each():
    cells = rates({("push", "all"): 0.2, ("push", "nothing"): 0.5}, ("task", "moves"), ("move",)).assign(
        object=[0.1, 0.2], camera=[0.3, 0.4], joint=[0.6, 0.7])
    panels = titled(figures.fig_coverage(cells))
    for title, expected in (("object", {0.1, 0.2}), ("camera", {0.3, 0.4}), ("both together", {0.6, 0.7})):
        marks = [line for line in panels[title].get_lines() if line.get_marker() == "o"]
        assert {float(x) for line in marks for x in line.get_xdata()} == expected, title
        assert {round(float(y), 4) for line in marks for y in line.get_ydata()} == {0.26, 0.56}


def test_pixels_and_keypoints_are_never_exchanged():
    table = rates({("rgb", "figure 1"): 0.2, ("keypoints", "figure 1"): 0.8}, ("observation", "experiment"))
    panels = titled(figures.fig_perception(table))
    assert heights(panels["from pixels"])[COLOUR["static"]] == [0.2]
    assert heights(panels["from keypoints: perception given"])[COLOUR["static"]] == [0.8]
    readings = rates({(seen, "push", "mended"): level for seen, level in (("rgb", 0.2), ("keypoints", 0.7))},
                     ("observation", "task", "jumping"), ("adc",))
    panels = titled(figures.table_adc(readings))
    assert sum(heights(panels["from pixels"]).values(), []) == [0.23]
    assert sum(heights(panels["from keypoints: perception given"]).values(), []) == [0.73]


def test_table_2_has_pixels_over_keypoints_over_the_differences_from_pixels():
    seen, given = ({(task,): level for task in PAPER_TASKS} for level in (0.2, 0.8))
    compared = pd.DataFrame([{"task": task, "baseline": other, "difference": value, "low": value - 0.1,
                              "high": value + 0.1, "paper": 0.15}
                             for task in PAPER_TASKS for other, value in (("static", 0.06), ("adc", 0.03))])
    means = pd.DataFrame([{"baseline": "static", "items": 10, "difference": 0.07, "low": 0.0, "high": 0.1,
                           "paper": 0.169}])
    controls = pd.DataFrame({"expert": 1.0, "goal-blind": 0.3}, index=list(PAPER_TASKS))
    panels = titled(figures.table2_main(rates(seen, ("task",), PAPER_METHODS), rates(given, ("task",), PAPER_METHODS)
                                        .drop(columns="paper"), controls, compared, means))
    assert set(heights(panels["from pixels"])[COLOUR["move"]]) == {0.26}
    assert set(heights(panels["from keypoints: perception given"])[COLOUR["move"]]) == {0.86}
    differences = panels["from pixels: MOVE minus the others"]
    statics, adcs = (container[0].get_xdata().tolist() for container in differences.containers)
    assert statics == [0.06] * 10 + [0.07] and adcs == [0.03] * 10
    assert [label.get_text() for label in differences.get_yticklabels()] == [
        *(TASKS[task].title for task in PAPER_TASKS), "mean of 10"]


def test_table_1_names_what_is_random_in_both_panels():
    labels = {"object": "object", "all": "+ camera"}
    compared = pd.DataFrame([{"factors": name, "baseline": "static", "difference": value, "low": value - 0.1,
                              "high": value + 0.1} for name, value in (("object", 0.0), ("all", 0.23))])
    success = rates({("object",): 0.9, ("all",): 0.5}, ("factors",))
    panels = titled(figures.table1_spatial_factors(success, compared, labels))
    assert heights(panels["success"])[COLOUR["static"]] == [0.9, 0.5]
    assert [label.get_text() for label in panels["success"].get_xticklabels()] == ["object", "+ camera"]
    difference = panels["MOVE minus static"]
    drawn = dict(zip((label.get_text() for label in difference.get_yticklabels()),
                     difference.containers[0][0].get_xdata(), strict=True))
    assert drawn == {"object": 0.0, "+ camera": 0.23}


def test_table_6_has_timesteps_left_and_generation_rates_right_each_with_the_papers():
    costs = pd.DataFrame([{"task": task, "method": method, "expert": "phase", "mean_steps": 100.0 + 10 * place,
                           "generation_rate": 0.9 - 0.1 * place}
                          for task in PAPER_TASKS for place, method in enumerate(PAPER_METHODS)])
    paper = pd.DataFrame({"method": PAPER_METHODS, "paper_mean_steps": [83.8, 90.0, 107.4],
                          "paper_generation_rate": [0.933, 0.9, 0.897]})
    panels = titled(figures.table6_collection(costs, paper))
    assert heights(panels["length of a demonstration"])[COLOUR["move"]] == [120.0]
    assert heights(panels["generation rate"])[COLOUR["move"]] == [pytest.approx(0.7)]
    for title, expected in (("length of a demonstration", {83.8, 90.0, 107.4}),
                            ("generation rate", {0.933, 0.9, 0.897})):
        dotted = {float(line.get_ydata()[0]) for line in panels[title].get_lines() if line.get_linestyle() == ":"}
        assert dotted == expected


def test_keypoints_stand_between_floor_and_ceiling_beside_the_papers_images():
    printed = published("table2_main", task="pick-place").assign(timesteps=20_000)
    (ax,) = figures.keypoint_control(rates({(1250,): 0.2, (5000,): 0.6}, ("timesteps",), PAPER_METHODS),
                                     {"expert": 1.0, "goal-blind": 0.33}, printed).axes
    assert heights(ax)[COLOUR["adc"]] == [0.23, 0.63]
    assert sorted(line.get_ydata()[0] for line in ax.get_lines() if line.get_linestyle() == "--") == [0.33, 1.0]
    assert {line.get_ydata()[0] for line in ax.get_lines() if line.get_marker() == "D"} == set(printed.value)


def test_the_recipes_changes_stand_beside_their_gains_budget_by_budget():
    table = pd.DataFrame([{"timesteps": budget, "change": name, "value": level, "low": level - 0.1, "high": level + 0.1,
                           "gain": level - 0.9, "gain_low": -0.5, "gain_high": 0.5, "train_minutes": budget / 1000}
                          for budget, lower in ((7000, 0.0), (20_000, 0.2))
                          for name, level in (("chosen", 0.9 - lower), ("longer", 0.8 - lower))])
    axes = figures.table_recipe(table).axes
    assert [ax.get_title(loc="left").split("$   ")[-1] for ax in axes] == ["7k timesteps", "gain", "20k timesteps",
                                                                          "gain"]
    drawn = [[round(float(container[0].get_xdata()[0]), 4) for container in ax.containers] for ax in axes]
    assert drawn == [[0.9, 0.8], [0.0, -0.1], [0.7, 0.6], [-0.2, -0.3]]
    assert [text.get_text() for text in axes[3].texts] == ["20.0 min"] * 2


def test_policies_that_are_not_shown_are_named_and_strips_keep_their_titles():
    frames = np.zeros((3, 16, 16, 3), np.uint8)
    figure = figures.rollouts({"MOVE: success": (frames, [0, 5, 9]), "static: failure": (frames, [0, 7, 9])}, ["ADC"])
    panels = titled(figure)
    assert [text.get_text() for text in panels["MOVE: success"].texts] == ["0", "5", "9"]
    assert [text.get_text() for text in panels["static: failure"].texts] == ["0", "7", "9"]
    assert figure.get_supxlabel() == "not shown, for the policy is not shipped: ADC"


def test_claims_stand_with_their_numbers_and_factors_in_a_panel_of_their_own():
    shares, factors = figures.claims(claimed.numbers()).axes
    colours = plots.VERDICT_COLOURS
    drawn = {(round(float(each[0].get_xdata()[0]), 6), each[0].get_color()) for each in shares.containers}
    assert drawn == {(0.1, colours["reproduced, smaller"]), (0.2, colours["direction only"]),
                     (-0.2, colours["undecided"])}
    single = {float(line.get_xdata()[0]) for line in shares.get_lines() if line.get_alpha() == 0.6}
    assert single == {0.4, 0.0}
    diamonds = [float(line.get_xdata()[0]) for line in shares.get_lines() if line.get_marker() == "D"]
    assert 0.3 in diamonds and [label.get_text().split()[-1] for label in shares.get_yticklabels()] == ["1", "2", "9"]
    assert [float(each[0].get_xdata()[0]) for each in factors.containers] == [2.0]
    assert set(VERDICTS) >= set(colours)

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
from matplotlib.collections import QuadMesh  # noqa: E402
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


WHOLE = rates({("anywhere",): 0.4, ("one place",): 0.3}, ("hand",)).assign(paper=[0.295, 0.808] * 2)


def test_a_method_without_episodes_leaves_its_map_empty_and_says_so():
    panels = titled(figures.fig1_sparse(grid({"static": 0.25}), WHOLE))
    assert [text.get_text() for text in panels["MOVE"].texts] == ["missing"] and mapped(panels["static"]) == 0.25


def test_a_method_with_episodes_but_none_on_the_grid_leaves_its_map_empty_too():
    episodes = grid({"static": 0.25, "move": 0.75})
    episodes = episodes[(episodes.method == "static") | (episodes.group == "point")]
    for figure in (figures.fig1_sparse(episodes, WHOLE),
                   figures.fig3_dense(episodes, episodes, WHOLE, rates({(7000,): 0.4}, ("timesteps",)))):
        panels = titled(figure)
        assert [text.get_text() for text in panels["MOVE"].texts] == ["missing"] and mapped(panels["static"]) == 0.25
    none = titled(figures.fig1_sparse(episodes[episodes.group == "point"], WHOLE))
    assert [text.get_text() for name in ("static", "MOVE") for text in none[name].texts] == ["missing"] * 2


def test_the_rates_of_figure_1_stand_over_where_the_hand_starts():
    ax = titled(figures.fig1_sparse(grid({"static": 0.25, "move": 0.75}), WHOLE))["whole space, by the hand's start"]
    assert heights(ax) == {COLOUR["static"]: [0.4, 0.3], COLOUR["move"]: [0.46, 0.36]}
    assert [label.get_text() for label in ax.get_xticklabels()] == ["any-\nwhere", "one\nplace"]


def test_figure_5_draws_its_circle_over_both_maps_and_the_papers_values_at_their_sides():
    table = rates({("inside", "anywhere"): 0.2, ("outside", "anywhere"): 0.6}, ("where", "hand")).assign(
        paper=[0.213, 0.437, 0.446, 0.674])
    panels = titled(figures.fig5_circle(grid({"static": 0.25, "move": 0.75}), table))
    for name in ("static", "MOVE"):
        (outline,) = panels[name].patches
        assert outline.get_radius() == pytest.approx(100 * CIRCLE.radius)
        assert outline.center == pytest.approx([100 * value for value in CIRCLE.centre[:2]])
    for where, level, theirs in (("inside", 0.2, [0.213, 0.437]), ("outside", 0.6, [0.446, 0.674])):
        ax = panels[where]
        assert heights(ax) == {COLOUR["static"]: [level], COLOUR["move"]: [round(level + 0.06, 4)]}
        dotted = sorted((float(np.mean(line.get_xdata())), line.get_ydata()[0]) for line in ax.get_lines()
                        if line.get_linestyle() == ":")
        assert [value for _, value in dotted] == theirs


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
